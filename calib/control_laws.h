#pragma once
// Which laws a control may follow at corners: fit-feed tries each and keeps the one that predicts best.
#include <array>
#include <string>
#include <vector>

#include "calib/fit_limits.h"
#include "machine/machine.h"

namespace camber::calib {

/// A law that was tried, fitted to the same parts and judged on the same parts that were held out.
struct TriedLaw {
  std::string name;
  LimitFit fit;
  double held_out_percent = 0;  ///< mean error of the times of the parts held out
};

/// Accelerations of x, y, z in mm/s^2 and of a, b, c in degrees/s^2; 0: the axis rests.
using Accelerations = std::array<double, 6>;

/// What the commands of the traces show (traced_motion.h).
struct TracedAccelerations {
  Accelerations highest{};
  std::array<FittedValue, 6> held{};  ///< limits that ramps keep; 0: none
};

/// The machine with each corner law, that of `start` first: rounding within a tolerance (G64 P), speed difference by
/// axis, speed change by angle, radius of three points, exact stop. `start` gives everything else.
std::vector<std::pair<std::string, machine::Machine>> machines_of_each_law(const machine::Machine& start);

/// Fits `base` (its law stands) from values that the data give: accelerations as commanded at most
/// (`acceleration`), the law's own number and the block time by a scan of their ranges. Where blocks overlap,
/// accelerations that ramps hold stand, unless the times contradict them.
LimitFit fit_law(const std::vector<TimedLines>& data, const machine::Machine& base,
                 const TracedAccelerations& acceleration, int max_iterations);

/// Mean absolute error of the times of the parts that were held out, %.
double held_out_percent(const std::vector<TimedLines>& data, const machine::Machine& machine);

/// Tries every law; the first is that of `start`. Where blocks overlap, rounding alone, the law that such a control has
/// for them. Index of the best: the least held-out cost, but the law of `start` unless another is better by a
/// thousandth, and the exact stop, which has no number, unless another is better by 5 %; the speed difference where it
/// is better by 5 % with a limit for each axis. only_own: that of `start` alone.
std::vector<TriedLaw> try_laws(const std::vector<TimedLines>& data, const machine::Machine& start,
                               const TracedAccelerations& acceleration, int max_iterations, std::size_t& best,
                               bool only_own = false);

/// Tries ramps whose acceleration builds up (AccelerationLaw::bell), where the times leave room for them, under every
/// law that comes near to `standing`; then, under the law that was best, a permitted speed difference for each axis, a
/// stop at corners sharper than each wide gap between the corners of the programs, and corners under 5 degrees passed
/// as none, one after the other. Keeps what lowers the held-out cost by 5 %.
LimitFit try_details(const std::vector<TimedLines>& data, const LimitFit& standing,
                     const TracedAccelerations& acceleration, std::vector<TriedLaw>& tried, int max_iterations);

}  // namespace camber::calib
