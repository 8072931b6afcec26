#pragma once
// Stage one of fit-feed: the servo of one axis, from its commanded and actual position.
#include <string>
#include <vector>

#include "calib/trace.h"
#include "machine/machine_model.h"

namespace camber::calib {

struct FittedValue {
  double value = 0;
  double std_error = 0;  ///< infinite: not determined by the data
};

/// Whether an error is small enough for the value to be worth more than a start value.
bool is_determined(const FittedValue& value);

struct DriveFit {
  bool moved = false;  ///< the axis moved in some trace that has both its columns
  bool converged = false;
  FittedValue gain_per_s, velocity_lag_s, feed_forward_percent, filter_s;
  FittedValue acceleration_feed_forward_s, dead_time_s, backlash;  ///< backlash in the unit of the trace
  double fitted_rms_mm = 0, held_out_rms_mm = 0;  ///< predicted against traced position, driven by the traced command
  std::string model;                              ///< which of the candidates was chosen
};

struct DriveFitOptions {
  double slice_s = 2.0;        ///< the motion of the axis is cut in slices of this length; every third is held out
  double better_by = 0.05;     ///< a richer model must lower the held-out error by this fraction
  double better_by_mm = 5e-5;  ///< and by this much (half of what traces are rounded to)
  std::size_t max_samples = 150000;  ///< of all traces, in slices spread evenly over the motion of the axis
  double moved_mm = 0.5;             ///< range that an axis must have gone
  double period_s = 0.001;           ///< of the control, which the samples need not have
};

/// Tv x'' + x' = Kp (c - x) + F c' + Ka c'', c delayed by a dead time, x behind a backlash.
///
/// A sampled control may apply the feed forward of a period at once: half a period earlier than this equation, which is
/// Ka = F period / 2. Models with feed forward are tried both ways.
///
/// Each model (which of the numbers differ from none) starts from two places and keeps the better end: from the least
/// squares of this equation in its numbers, which are linear in it (both sides low-passed alike, the dead time from a
/// list), and from the best model before it. The richer one stands where it lowers the held-out error. Where more than
/// a micrometre is left, moving averages of 2 to 128 ms before the loop are tried, the best of them to a period. Rests
/// are left out, and the first half second of a stretch of the trace where the axis is not seen to rest before it
/// moves.
///
/// A trace with fewer samples than the control has periods is fitted twice, the command between two samples straight
/// and on a cubic through four of them, in steps of the period; of the two fits the one with fewer numbers stands
/// unless the other's held-out error is clearly lower, of two with as many that of the cubic; how far they differ
/// counts as error.
///
/// Where the trace is explained as well with half of the speed fed forward, since the axis runs steadily all the time,
/// the feed forward is not determined (infinite error) and the gain is gain / (1 - feed forward).
///
/// Standard errors: sandwich over half seconds (n of them and p numbers: times n / (n - p)); beside it how far the
/// models differ whose held-out error is less than one and a half times the best and which determine the number, and
/// what a shift by a twentieth of the sample distance changes, for what happens between samples.
DriveFit fit_drive(const std::vector<const ServoTrace*>& traces, int axis, const DriveFitOptions& options);

/// RMS of predicted minus traced position over the traces, mm; of all samples but the first half second of a stretch
/// where the axis is not seen to rest before it moves.
double drive_rms_mm(const std::vector<const ServoTrace*>& traces, int axis, const machine::Axis& model);

}  // namespace camber::calib
