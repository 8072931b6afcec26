#pragma once
// fit-feed: feed model of a machine from programs and their servo traces.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/control_laws.h"
#include "calib/feed_accuracy.h"
#include "calib/fit_drive.h"
#include "calib/stretch.h"
#include "calib/trace.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::calib {

/// A program and the trace of its run.
struct FeedRun {
  std::string program_name;
  nc::Interpretation program;
  ServoTrace trace;
};

struct FitFeedOptions {
  int keep_back_every = 3;  ///< every n-th part is held out
  int max_iterations = 60;
  bool update = false;  ///< the corner law of the start file stands; its numbers change where the traces determine them
};

struct FitParameter {
  std::string name;  ///< key of the machine file, e.g. "axis.x.acceleration_mm_per_s2"
  double value = 0;
  std::string unit;
  std::optional<double> std_error;       ///< not given: not fitted, or the data does not determine it
  std::string note;                      ///< why it has no error, where the reason is worth a word
  bool written = true;                   ///< the value is written to the machine file
  int stretches = 0;                     ///< parts of the traces, moves or slices that determine it; 0: not counted
  std::optional<double> changed_from{};  ///< value of the start file; infinite: no limit
};

/// Range that the relative error of the time of a next program is in, in 19 of 20 cases, %.
struct TimePromise {
  double low_percent = 0, high_percent = 0;
};

/// Bootstrap over parts that were held out (fixed seed): five of them are drawn, with repetition, and their predicted
/// and true times added up. A next program has few kinds of motion: over all parts held out their errors would cancel
/// each other more than in it. Nothing for less than five parts.
std::optional<TimePromise> time_promise(const std::vector<double>& true_s, const std::vector<double>& predicted_s);

/// The model's error on parts of the traces.
struct FitError {
  std::size_t parts = 0;
  double part_time_percent = 0;                         ///< mean of the parts' absolute errors
  double speed_rms_percent = 0, speed_p95_percent = 0;  ///< path speed, in % of the programmed feed
};

struct RunAccuracy {
  std::string program_name;
  FeedAccuracy accuracy;
};

/// A corner law that was tried.
struct JudgedCornerLaw {
  std::string name;
  double held_out_percent = 0;  ///< mean error of the times of the parts held out
  double held_out_cost = 0;     ///< what laws are chosen by: mean robust cost of a part held out
};

/// A stretch that a log or a table has the time of.
struct LoggedTime {
  std::string program_name;
  TracePart part;
  bool kept_back = false;
  double time_s = 0, sigma_s = 0, model_s = 0;
};

/// Errors of logged times, %.
struct LoggedError {
  std::size_t stretches = 0;
  double mean = 0, worst = 0;  ///< of the absolute errors
};

struct FitFeedResult {
  machine::Machine machine;
  std::vector<JudgedCornerLaw> laws;  ///< all that were tried, that of the start file first
  std::string law;                    ///< the one that was taken
  std::vector<FitParameter> parameters;
  std::array<DriveFit, 3> drives;
  std::array<DriveFit, 3> rotary_drives{};  ///< a, b, c; their residuals are in degrees
  FitError fitted, held_out;
  std::optional<TimePromise> promise;
  std::vector<LoggedTime> logged;  ///< one for each geometry; with the fitted machine
  LoggedError logged_fitted, logged_held_out;
  std::vector<RunAccuracy> runs;  ///< all parts, with the fitted machine
  double residual_median_ms = 0;  ///< of the commanded times of the fitted parts
  bool converged = false;
  std::string message;  ///< one sentence: how the fit ended
};

/// Writes the result of the drive fit of an axis to the machine and the list.
void add_drive(machine::Machine& machine, std::vector<FitParameter>& parameters, int axis, const DriveFit& drive);

/// `start` gives the control's dialect, and the values of parameters that the traces do not determine; no fit starts
/// from them. Stage one fits each axis' servo (fit_drive). Stage two fits, under every corner law, accelerations, the
/// shares that arcs and stops take, the law's number and the block time to the commanded times of parts, every third
/// held out, and takes the law that predicts those best; under LinuxCNC's rounding it takes from a list of values the
/// lookahead and the short-line time that predict best. Velocity limits are read where a rapid shows a plateau, the
/// ramp after interpolation from the commanded starts. Deterministic.
FitFeedResult fit_feed(const std::vector<FeedRun>& runs, const machine::Machine& start, const FitFeedOptions& options);

/// Servo traces and logged times in one fit: every time is weighted by its uncertainty, so that each source determines
/// what it contains (traces: drives, ramps, block times; logs: axes, arcs and feeds that no trace has). A note at each
/// parameter names the source. The wait between feed and rapid that logged times hold (control.rapid_change_ms) is
/// fitted as well.
FitFeedResult fit_feed(const std::vector<FeedRun>& runs, const std::vector<StretchRun>& logs,
                       const machine::Machine& start, const FitFeedOptions& options);

}  // namespace camber::calib
