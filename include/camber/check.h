#pragma once
// Statistics of a program, and whether a machine or a job can run it.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct Box {
  std::array<double, 3> min_mm{}, max_mm{};
};

struct ToolUse {
  int tool = 0;          ///< 0: before any M6
  std::size_t line = 0;  ///< line of its first M6; without one, of its first move
  std::size_t calls = 0, cutting_moves = 0;
  double cutting_length_mm = 0, rapid_length_mm = 0;
  std::optional<Box> cutting{};  ///< extents of its cutting moves
};

/// Files that are written beside the figures; empty: none.
struct CheckOptions {
  std::string page{};     ///< file: page with a picture of the path; also where an axis of a machine leaves its travel
  std::string path{};     ///< file: the path's points as arrays for pictures; of a job the first program's
  std::string meshes{};   ///< check_job: part and blank as STL files of this name and "-part.stl", "-blank.stl", where
                          ///< the program has them; a blank that is a box has none
  bool sheet = false;     ///< also CheckedJob::sheet
  std::string program{};  ///< check_job: instead of the job's programs
};

struct CheckResult {
  std::size_t blocks = 0, blocks_with_words = 0;
  std::size_t rapids = 0, lines = 0, arcs = 0, dwells = 0;
  std::size_t rotary_moves = 0;  ///< number of these that turn rotary axes
  double cutting_length_mm = 0, rapid_length_mm = 0, dwell_s = 0;
  std::optional<Box> cutting{}, rapid{};
  std::vector<ToolUse> tools{};           ///< in the order of their first use
  std::optional<double> memory_GB{};      ///< that predict() of the job needs, about; of a job alone
  std::vector<Diagnostic> diagnostics{};  ///< warnings, in the order of the file
  std::string json{};                     ///< all figures, as `camber check --json` writes them
  std::string printed{};                  ///< the same, as `camber check` prints them
};

/// All programs of a job.
struct CheckedJob {
  std::vector<CheckResult> programs{};
  std::string sheet{};                    ///< set-up sheet, as `camber check --sheet` writes it
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber check --json` writes them
  std::string printed{};                  ///< the same, as `camber check` prints them
};

/// Throws InputError when the program cannot be read or run.
CAMBER_API CheckResult check(const Program& program, const RunOptions& run = {});
/// Also checks axes, feeds and spindle speeds against the machine.
CAMBER_API CheckResult check(const Program& program, const Machine& machine, const RunOptions& run = {});
/// Also checks the job's tools, stock and part.
CAMBER_API CheckResult check(const Program& program, const Job& job, const RunOptions& run = {});

CAMBER_API CheckResult check(const Program& program, const CheckOptions& options, const RunOptions& run);
CAMBER_API CheckResult check(const Program& program, const Machine& machine, const CheckOptions& options,
                             const RunOptions& run);
/// The programs of a job one after the other, each on what the undeflected tools of those before it leave.
CAMBER_API CheckedJob check_job(const std::string& job_path, const ReadOptions& read = {},
                                const CheckOptions& options = {}, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
