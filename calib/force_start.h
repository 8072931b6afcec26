#pragma once
// Where fit-force begins: coefficients and phases without run-out, then the run-out and which tooth is which.
#include <vector>

#include "calib/force_residuals.h"

namespace camber::calib {

/// Coefficients by linear least squares (with another law than the linear one: the law through the linear one's force
/// and slope at the mean chip of the first cut), each waveform turned to the phase within a pitch at which it fits
/// best. Run-out zero.
Eigen::VectorXd start_without_run_out(const ForceProblem& problem);

/// Starts with run-out, the most promising first: offsets of a quarter of the feed per tooth in several directions, the
/// teeth of each cut numbered as fits best. Empty where nothing has run-out to fit.
std::vector<Eigen::VectorXd> starts_with_run_out(const ForceProblem& problem, const Eigen::VectorXd& without);

}  // namespace camber::calib
