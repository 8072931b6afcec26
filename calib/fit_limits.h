#pragma once
// Stage two of fit-feed: the limits that the control plans with, from the times of blocks that it commanded.
#include <string>
#include <utility>
#include <vector>

#include "calib/feed_accuracy.h"
#include "calib/fit_drive.h"
#include "feedmodel/motion_plan.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::calib {

/// A stretch of lines whose commanded time is known.
struct TimedLines {
  const nc::Interpretation* program = nullptr;
  std::vector<TracePart> parts;
  std::vector<double> time_s;   ///< of each part; 0: not in the trace
  std::vector<char> kept_back;  ///< of each part
  std::vector<int> group;       ///< of each part: what lies within one part of the program errs together
  /// Standard error of each part's time. Empty: that of a servo trace, about a period. A log gives it; its times end
  /// when the rapid behind the part begins, so that they hold the wait before it.
  std::vector<double> sigma_s{};
  /// The moves [first, end) of each logged part; a program of stretches may have their lines elsewhere again.
  std::vector<std::pair<std::size_t, std::size_t>> moves{};
  std::vector<std::pair<double, double>> fractions{};  ///< FeedStretch::first_u, last_u of each logged part
  std::vector<Vec3> turns{};                           ///< TimedStretch::turn of each logged part
  std::vector<char> ends_in_motion{};                  ///< of each logged part: no wait at its end
  double step_s = 0;                                   ///< between the samples of a servo trace
  bool logged() const { return !sigma_s.empty(); }
};

bool any_logged(const std::vector<TimedLines>& data);
/// Whether the times of some parts are those of lagging axes.
bool any_lags(const std::vector<TimedLines>& data);

/// Whether the plan of some program has blocks that last whole periods (feedmodel/overlap.h).
bool blocks_overlap(const std::vector<TimedLines>& data, const machine::Machine& machine);

/// Mean robust cost of a part, and of one that is held out.
struct LimitCost {
  double fitted = 0, held_out = 0;
};
LimitCost cost_of(const std::vector<TimedLines>& data, const machine::Machine& machine);

/// Whether the parts have the same times on both machines.
bool same_times(const std::vector<TimedLines>& data, const machine::Machine& a, const machine::Machine& b);

/// A number of the machine that the fit may change.
struct LimitParameter {
  std::string name, unit;
  double (*get)(const machine::Machine&);
  void (*set)(machine::Machine&, double);
  double least = 0, most = 0, start = 0;
  double usual = 0;  ///< of a share: what controls have
  FittedValue fitted;
  bool determined = false;  ///< determined by the data
  bool poor = false;        ///< but hardly: the error is of the size of the value
  /// `fitted` was read in the commands of the traces (traced_motion.h) and stays.
  bool from_ramps = false;
  bool acts = false;     ///< it changes some time
  bool assumed = false;  ///< kept at `usual`, since the times tell it only together with others
  /// Fraction of its squared derivatives that comes from logged times.
  double logged_fraction = 0;
  int stretches = 0;  ///< groups of parts whose times it changes
};

/// Those that act under the machine's corner law, with start values that suit most controls (never the machine's own:
/// a fit that begins at a wrong value may stay there). The block time is the last one. `logged`: with the wait between
/// feed and rapid, which logged times hold. `lags`: with the position gains.
std::vector<LimitParameter> limit_parameters(const machine::Machine& machine, bool logged = false, bool lags = false);

struct LimitFit {
  machine::Machine machine;  ///< with the values that the data tell
  machine::Machine whole;    ///< with all fitted values
  std::vector<LimitParameter> parameters;
  double fitted_cost = 0, held_out_cost = 0;  ///< mean robust cost of a part
  double residual_median_ms = 0;
  bool converged = false;
};

/// Least squares (Cauchy loss: a trace may hold pauses that no plan explains) over the times of the parts, each in
/// units of what it is known to, whether a servo trace or a log has it. Standard errors: the sandwich (J'J)^-1 sum(s
/// s') (J'J)^-1 over groups, s = J'r of a group, and beside it what a common shift of all traced times by half a period
/// does, since a trace tells times to a period. far_away: the start values may be wrong by much; a wide loss leads
/// first. Where blocks overlap, a compass search instead. Shares of accelerations that the times tell only together
/// with the accelerations are assumed at their usual values.
LimitFit fit_limits(const std::vector<TimedLines>& data, const machine::Machine& start,
                    std::vector<LimitParameter> parameters, int max_iterations, bool far_away);

/// Sets the start value of one parameter to the best of values spread evenly (in the logarithm) over its range,
/// the others at their start: for those that change nothing over most of their range, such as a block time. Returns
/// the mean robust cost there.
double scan_start(const std::vector<TimedLines>& data, const machine::Machine& base,
                  std::vector<LimitParameter>& parameters, std::size_t index, int steps = 48);

/// Seconds that the plan takes for each part: from the start of its first to the end of its last segment (of logged
/// parts, with the wait before the rapid).
/// `plan`: of the whole program, plan_motion(*data.program, machine).
std::vector<double> planned_times_s(const TimedLines& data, const machine::Machine& machine,
                                    const feedmodel::MotionPlan& plan);

/// Seconds that the plan takes on a move for what is not between two fractions of its length; `segment`: any of it.
double time_outside_s(const feedmodel::MotionPlan& plan, std::size_t segment, double from_u, double to_u);

}  // namespace camber::calib
