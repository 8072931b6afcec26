#pragma once
// Compensation: the program of a job with its path shifted against the form error.
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camber/predict.h"

namespace camber {
inline namespace v0 {

struct CompensateOptions {
  std::vector<std::string> uncertainty{};  ///< files written by fit-force or fit-feed, or percentages ("10")
  std::string measured{};                  ///< points measured on a part, CSV; empty: none
  std::string measured_program{};          ///< program that the measured part was cut with; empty: the job's program
  std::vector<double> check_voxels_mm{};   ///< predict both programs again on these grids
  /// Levers in place of [compensation] levers: "shift" and of "feed", "passes" and "allowance" those wanted; empty:
  /// the job's.
  std::vector<std::string> levers{};
  /// Limit of the levers feed and passes ([compensation] levers): the least error within so much more machine time,
  /// in percent; not given: as much as the tolerance takes.
  std::optional<double> time_budget_percent{};
  bool keep_anyway = false;  ///< emit the round with the smallest error even if none is better than the given program
  bool header = false, header_hash = false;  ///< write comment lines at the head of the program
  /// File for the emitted program; the record by which verify() judges it, and features.csv where the job has
  /// [[feature]], are written beside it. As on the command line,
  /// nothing is written where no round is better than the given program, unless keep_anyway is set. Empty: no files.
  std::string output{};
  bool dry_run = false;            ///< write no files; `output` is only the name of the program on the page
  bool throw_if_unwritten = true;  ///< else CompensateResult::unwritten says what could not be written
  bool page = false;               ///< also CompensateResult::page
  /// Gets the steps of the loop and the fraction of each that is done; empty: RunOptions::progress gets them.
  std::function<void(const std::string& step, double fraction)> step{};
  /// Gets a sentence on what shifts are expected to leave, once the given program is measured; may be empty.
  std::function<void(const std::string& sentence)> outlook{};
};

struct CompensationRound {
  ErrorFigures error_um{};
  double largest_shift_mm = 0;
  double machine_time_s = 0;
  std::size_t repeated_runs = 0;  ///< runs of cuts between rapids that are cut twice
};

/// The best program for a machine time: a round's index, and the extra time that was allowed for it, in percent.
struct TimePoint {
  double allowed_percent = 0;
  std::size_t round = 0;
};

/// Lines of the given program, both included, whose cuts the emitted program makes twice.
struct RepeatedLines {
  std::size_t first = 0, last = 0;
};

/// The same point of the surface, cut by the given and by the emitted program.
struct CompensatedPoint {
  double x_mm = 0, y_mm = 0, z_mm = 0, nx = 0, ny = 0, nz = 0;
  double before_um = 0, after_um = 0;  ///< error_um of predict
  double area_mm2 = 0;
};

struct CompensateResult {
  std::string program{};  ///< text of the emitted program: that of the best round
  bool better = false;    ///< better than the given program and within the limits; otherwise do not run it
  bool success = false;   ///< within the tolerance and the limits, with reliable figures
  std::string headline{};
  std::vector<std::string> reasons{};  ///< reasons why it is not, worst first
  ErrorFigures before_um{}, after_um{};
  std::vector<CompensationRound> rounds{};  ///< rounds[0]: the given program
  std::size_t best_round = 0;
  std::vector<TimePoint> time_points{};  ///< with the levers feed or passes: machine time against error
  std::vector<RepeatedLines> repeated{};
  double pass_allowance_mm = 0;  ///< what the first of two cuts leaves; 0: none is repeated
  std::string stop{};            ///< tolerance, stalled, rounds or depth_limit
  std::size_t blocks_before = 0, blocks_after = 0, blocks_changed = 0;
  double max_shift_mm = 0;
  std::vector<CompensatedPoint> surface{};
  std::vector<Diagnostic> diagnostics{};          ///< warnings
  std::string json{};                             ///< all figures, as `camber compensate --json` writes them
  std::string printed{};                          ///< the same, as `camber compensate` prints them
  std::string page{};                             ///< the same, as `camber compensate --report` writes them
  bool written = false;                           ///< there is an output, and the program is in it
  std::vector<Diagnostic> unwritten{};            ///< see CompensateOptions::throw_if_unwritten
  std::vector<std::string> unknown_parameters{};  ///< names in CompensateOptions::uncertainty that are ignored
  /// Allowance that the passes before leave, as given and as emitted; 0: they are as given (lever "allowance").
  double given_allowance_mm = 0, allowance_mm = 0;
};

/// Throws InputError, BeyondModel, Cancelled.
CAMBER_API CompensateResult compensate(const Job& job, const CompensateOptions& options = {},
                                       const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
