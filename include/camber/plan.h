#pragma once
// From a blank and a part to operations: primitives, tools, conditions and order.
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct PlanOptions {
  std::string operations{};   ///< file: an edited table of operations to go on from; empty: none
  bool programs = false;      ///< also the programs, by copy milling, and their times
  bool all_programs = false;  ///< makes the programs of all three plans; their times decide which one is taken
  bool learn = false;         ///< also PlanResult::learned
  bool page = false;          ///< also PlanResult::page
};

struct PlannedOperation {
  std::size_t setup = 0;      ///< from 0
  std::size_t primitive = 0;  ///< place in the order, from 1
  std::string feature{};      ///< "closed pocket"
  std::string kind{};         ///< "rough", "rest", "finish", "centre", "drill", "ream"
  int tool = 0;
  std::string mode{};   ///< "scanning-line", "contour-line", "drilling"
  bool joined = false;  ///< cut in one run with the operation before it
  double spindle_rpm = 0, feed_mm_per_min = 0, radial_mm = 0, axial_mm = 0;
  double nominal_time_s = 0;  ///< volume over removal rate
  double time_s = 0;          ///< time of its program, of a run with its first operation; 0: none was made
  std::string limit{};        ///< what bounds the conditions; "cases": nothing but them
  double force_N = 0, form_error_um = 0, power_W = 0;
  std::vector<std::string> notes{};
};

struct PlanAlternative {
  std::string division{};  ///< "yz", "zx", "largest"
  double nominal_time_s = 0;
  double time_s = 0;  ///< time of its program; 0: none was made
  int tool_changes = 0;
  double form_error_p95_um = 0;
  bool complete = true;
  bool taken = false;
};

/// The case base with the conditions of the operations as new cases; those that are there already are left out.
struct LearnedCases {
  std::string path{};  ///< its file
  std::string text{};
  std::size_t added = 0;
};

struct PlanResult {
  bool success = false;                         ///< everything is machined
  std::vector<std::string> unmachined{};        ///< what is not, and why
  std::vector<PlanAlternative> alternatives{};  ///< plans of the first set-up
  std::vector<PlannedOperation> operations{};   ///< operations of the plans that are taken
  double removal_mm3 = 0;                       ///< blank minus part
  /// Files that `camber plan` writes to its folder, but for plan.json and report.html: names and contents.
  std::vector<std::pair<std::string, std::string>> files{};
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber plan --json` writes them
  std::string printed{};                  ///< the same, as `camber plan` prints them
  std::string page{};                     ///< the same, as report.html
  std::optional<LearnedCases> learned{};
  std::vector<std::string> translation{};  ///< how [source] of the machine file was read; see Machine::translation
};

/// Plans what a plan.toml describes. Writes no file. Throws InputError, Cancelled.
CAMBER_API PlanResult plan(const std::string& path, const PlanOptions& options = {}, const RunOptions& run = {});

/// How well the cases of a plan.toml's case base predict each other, as `camber plan --cases-error` prints it. Throws
/// InputError.
CAMBER_API std::string cases_error(const std::string& path, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
