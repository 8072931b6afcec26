#pragma once
// Stage one of fit-feed: the servo of one axis, from its commanded and actual position.
#include <string>
#include <vector>

#include "calib/trace.h"
#include "machine/machine.h"

namespace camber::calib {

struct FittedValue {
  double value = 0;
  double std_error = 0;  ///< infinite: not determined by the data
};

struct DriveFit {
  bool moved = false;  ///< the axis moved in some trace that has both its columns
  bool converged = false;
  FittedValue gain_per_s, velocity_lag_s, feed_forward_percent, filter_s;
  double fitted_rms_mm = 0, held_out_rms_mm = 0;  ///< predicted against traced position, driven by the traced command
  std::string model;                              ///< which of the candidates was chosen
};

struct DriveFitOptions {
  double slice_s = 2.0;              ///< the traces are cut in slices of this length; every third is held out
  double better_by = 0.05;           ///< a richer model must lower the held-out error by this fraction
  double better_by_mm = 5e-5;        ///< and by this much (half of what traces are rounded to)
  std::size_t max_samples = 150000;  ///< of each trace, from its start
  double moved_mm = 0.5;             ///< range that an axis must have gone
};

/// Fits gain; gain and velocity lag; these and feed-forward; and, where a residual of more than a micrometre is
/// left, moving averages of 2 to 128 ms before each, the best of them to a period; chooses by held-out error. Standard
/// errors hold, beside that of least squares, how far the models differ whose held-out error is less than twice the
/// best.
DriveFit fit_drive(const std::vector<const ServoTrace*>& traces, int axis, const DriveFitOptions& options);

/// RMS of predicted minus traced position over the traces, all samples, mm.
double drive_rms_mm(const std::vector<const ServoTrace*>& traces, int axis, const machine::Axis& model);

}  // namespace camber::calib
