#pragma once
// fit-feed from times alone: limits of a control from the durations of stretches of feed moves
// (machine logs, or a table of times).
#include <string>
#include <string_view>
#include <vector>

#include "calib/fit_feed_model.h"
#include "calib/stretch.h"
#include "machine/machine_model.h"

namespace camber::calib {

/// Which laws a control is described with.
struct StretchLaw {
  std::string name;
  machine::CornerLaw corner = machine::CornerLaw::angle;
  double stop_angle_rad = machine::kNoLimit;
  double threshold_rad = 0;        ///< corners that turn by less are none
  bool axis_acceleration = false;  ///< accelerations of the axes (x and y alike) instead of one along the path
  double block_time_s = 0;         ///< where the fit of it begins; 0: as the machine file has it, not fitted
};

/// Errors of stretch times, one for each geometry, in %.
struct StretchErrors {
  double mean = 0, p90 = 0, worst = 0;  ///< of the absolute errors
  double total = 0;                     ///< of the sum of the times
};

/// Worst is the largest, p90 the smallest error that nine tenths do not exceed.
StretchErrors stretch_errors(const std::vector<double>& time_s, const std::vector<double>& predicted_s);

/// Kinds of motion that a law may hold for or not: a stretch is of the first kind that it has enough of.
enum class MotionKind { helices, facets, arcs, lines };
std::string_view name_of(MotionKind kind);

/// Helices: a tenth of the length; facets: lines whose median is under 1 mm; arcs: a tenth of the length; lines.
MotionKind kind_of(const FeedStretch& stretch, const nc::Interpretation& program);

struct JudgedStretch {
  TimedStretch timed;
  std::string program_name;
  double fitted_s = 0;    ///< with the numbers of the whole fit
  double held_out_s = 0;  ///< with numbers that were fitted without this fold
  MotionKind kind = MotionKind::lines;
  double kind_held_out_s = 0;     ///< with numbers that were fitted without this kind of motion
  double constant_feed_s = 0;     ///< baseline: length / programmed feed
  double stop_every_block_s = 0;  ///< baseline: the fitted acceleration, rest at the end of every block
};

struct JudgedLaw {
  StretchLaw law;
  StretchErrors fitted, held_out;
  StretchErrors kind_held_out;  ///< each kind of motion predicted by a fit on the others
  double score = 0;             ///< mean held-out error in units of what each time is known to: what laws are chosen by
};

struct StretchFit {
  machine::Machine machine;
  std::vector<FitParameter> parameters;  ///< errors: jackknife over the folds
  std::vector<JudgedLaw> laws;           ///< all that were tried
  std::size_t chosen = 0;                ///< index into laws
  std::vector<JudgedStretch> stretches;  ///< one for each geometry
  StretchErrors fitted, held_out, constant_feed, stop_every_block;
  std::optional<TimePromise> promise;                     ///< from each kind of motion predicted by a fit on the others
  std::vector<std::array<double, 2>> unseen_corners_rad;  ///< gaps wider than 5 degrees between corner angles
  int folds = 0;
  bool converged = false;
  std::string message;
};

struct FitStretchesOptions {
  int max_iterations = 30;
  std::vector<StretchLaw> laws;  ///< to choose from; empty: candidate_laws
};

/// Speed difference by axis and along the path and the radius of three points, each without and with a stop at corners
/// sharper than the middle of each wide gap between the angles that the stretches hold; the best of them with no corner
/// under 5 degrees, and with axis accelerations, as well. Where the stretch with the shortest blocks is far slower than
/// programmed, each law without a stop is tried with a block time, too.
std::vector<StretchLaw> candidate_laws(const std::vector<StretchRun>& runs);

/// Acceleration, corner step, time of a stop, arc limit and the wait between rapid and feed, fitted (Cauchy loss) to
/// one time for each geometry. Each fold keeps back all stretches of one tool (of one geometry in five, where there
/// are fewer than three tools), so that no copy of what is tested was fitted on. Beside that each kind of motion is
/// predicted by a fit on the others. The law with the least mean held-out error of both, each in units of what its time
/// is known to, is taken (a law with a number more only where it lowers it by 5 %). Deterministic.
StretchFit fit_stretches(const std::vector<StretchRun>& runs, const machine::Machine& start,
                         const FitStretchesOptions& options);

}  // namespace camber::calib
