#pragma once
// The compensation loop: predict, shift each point against its error, predict the emitted program again.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compensate/error_split.h"
#include "compensate/finishing.h"
#include "compensate/measured.h"
#include "compensate/path_quality.h"
#include "compensate/recheck.h"
#include "compensate/safety.h"
#include "compensate/surface_steps.h"
#include "compensate/trial.h"
#include "compensate/uncertainty.h"
#include "compensate/verdict.h"
#include "machine/job.h"
#include "removal/stock.h"
#include "simulate/setup.h"

namespace camber::compensate {

/// Judged on the emitted text. tolerance: it is within tolerance and depth limit; depth_limit: the depth limit keeps
/// the error over the tolerance; stalled: the rms no longer falls, or nothing is left that a shift can correct.
enum class Stop { tolerance, stalled, rounds, depth_limit };
std::string to_string(Stop stop);

struct Round {
  removal::ErrorFigures error_um;  ///< judged, of the program that this round emitted: see PlainFigures
  ErrorSplit split;
  double largest_shift_mm = 0;
  std::size_t limited_points = 0;     ///< cut to max_shift_mm
  double gain = 1;                    ///< mean sensitivity of the error to the shift, by which the step was divided
  double step_fraction = 1;           ///< of the step that was taken; less than 1 after an over-correction
  double overcorrected_fraction = 0;  ///< of the area: the error changed its sign and is still over the tolerance
  double deepest_um = 0;  ///< into the part, where compensated moves cut, but for a thousandth of the surface
  bool guard = false;     ///< a round of the guard against gouging
  double free_angle_growth_rad = 0;  ///< of angles between blocks and rows, before max_angle_growth_deg held them back
  double machine_time_s = 0;
  std::size_t slowed = 0;    ///< changes of feed: stretches of the path with a feed of their own, and their ends
  std::size_t repeated = 0;  ///< runs of cuts between rapids that are cut twice
  int static_rounds = 0;
  std::size_t unsettled = 0;
};

/// Machine time against error: the best program that was found for a time.
struct TimePoint {
  double allowed_percent = 0;  ///< extra time; 0: only the path is shifted
  std::size_t round = 0;       ///< index into CompensationResult::rounds
};

/// Lines of the given program that are cut twice.
struct RepeatedRun {
  std::size_t first_line = 0, last_line = 0;
};

struct CompensationResult {
  std::string text;                          ///< the emitted program of the best round
  std::vector<std::uint32_t> block_of_line;  ///< of `text`, as nc::Emission has it; empty: the given program
  std::vector<LineRole> lines;               ///< of the given program, one per line
  machine::Operations operations;            ///< the job's, as lines of the given program
  bool own_target = true;                    ///< the given program is the target
  bool better = true;  ///< that round is better than the given program, or that is good, and within the limits
  machine::Reference reference = machine::Reference::commanded;
  removal::ErrorFigures before_um, after_um;  ///< judged: rounds[0] and rounds[best]
  PlainFigures plain_before, plain_after;
  bool within_tolerance = false;  ///< the emitted program
  double depth_limit_um = 0;      ///< the job's, or default_depth_limit_um
  bool own_depth_limit = false;   ///< the job gives one
  double unseen_mm2 = 0;          ///< area of the nominal surface without a point
  /// Left out of the surface: see simulate::SurfaceRegion.
  double border_mm2 = 0, not_judged_mm2 = 0;
  bool between = false;
  std::vector<CauseFigure> causes;   ///< of what is left, where it is over the tolerance
  std::vector<BindingLimit> limits;  ///< that kept the path from the shifts that its error asks for
  ErrorSplit split_before, split_after;
  std::vector<Round> rounds;             ///< rounds[0]: the given program
  std::size_t best = 0;                  ///< index into rounds
  std::vector<TimePoint> time_points{};  ///< with a lever that takes time; ascending
  std::vector<RepeatedRun> repeated{};   ///< of the emitted program
  double pass_allowance_mm = 0;          ///< what the first of two cuts leaves; 0: none is repeated
  std::string repeated_text{};           ///< the program whose path was shifted, where runs are cut twice; else empty
  Stop stop = Stop::rounds;
  std::size_t blocks_before = 0, blocks_after = 0, blocks_changed = 0;
  double max_shift_mm = 0;
  std::vector<removal::SurfacePoint> surface_before, surface_after;  ///< the same points, in the same order
  std::vector<simulate::StampLoad> loads_before, loads_after;        ///< of the given and of the emitted program
  removal::StockShape stock;                                         ///< what the target program leaves, for a picture
  feedmodel::FeedSummary feed_before, feed_after;
  bool settled = true;  ///< every static solution of the first and the best round did
  Finishing finishing;
  PathQuality quality;  ///< of the emitted program
  RowSteps row_steps;
  SurfaceSteps surface_steps;
  double row_turn_rad = 0;          ///< between neighbouring rows of one sense, held like the angles between blocks
  Depth depth_before, depth_after;  ///< into the part, compensated moves
  Depth depth_others;               ///< of moves that are not compensated
  Depth depth_without_bending;      ///< of the emitted program
  bool within_part = true;          ///< depth_after is within the depth limit
  std::vector<Recheck> rechecks;    ///< one per voxel asked for
  std::optional<Band> band;
  std::vector<std::string> unknown_parameters;  ///< with a standard error, but not of this job
  std::optional<MeasuredFit> measured;
  /// Reasons why the figures of the given or the emitted program are not reliable (simulate/verdict.h); empty: none.
  std::vector<std::string> doubts;
};

/// Thrown where the given program lies beyond the model: there is nothing to compensate by. what() says why.
using camber::BeyondModel;

struct CompensateOptions {
  simulate::Progress progress;
  std::size_t max_stock_crossings = 0;  ///< of Compensation::stock; 0: none
  bool keep_anyway = false;  ///< emit the round with the smallest error even if none is better than the given program
  /// Of feeds and passes: the least error for so much more machine time. Not given: as much as the tolerance takes.
  std::optional<double> time_budget_percent{};
  std::vector<double> recheck_voxels_mm{};    ///< predict both programs on these grids as well
  std::vector<ParameterGroup> uncertainty{};  ///< for Compensation::band
  /// Comment lines for the emitted program, asked for when all else is known; empty: none.
  std::function<std::string(const CompensationResult&)> header{};
};

/// Throws InputError and BeyondModel. The program's text is not written anywhere.
CompensationResult compensate(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options);

}  // namespace camber::compensate
