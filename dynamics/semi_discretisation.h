#pragma once
// Stability of milling by the multipliers of one period: exact in the limit, so also with helix, unequal pitches and
// short cuts, where the zero-order solution is not.
//
// The period is divided into intervals. In each the matrix of the chip has its exact mean, over the interval and the
// lag along the helix; the present and the delayed vibration go straight from knot to knot, and the modes follow that
// force exactly. Sources: Insperger, Stepan, Updated semi-discretization method for periodic delay-differential
// equations with discrete delay, Int. J. Numer. Meth. Engng 61 (2004) 117-141; the present vibration is taken straight
// as well, as in Ding, Zhu, Zhang, Ding, A full-discretization method for prediction of milling stability, Int. J.
// Mach. Tools Manuf. 50 (2010) 502-509. The multiplier of largest modulus is found by Arnoldi's iteration on the map of
// one period: it never becomes a matrix.
#include <complex>
#include <span>
#include <string_view>

#include "dynamics/vibrating_cut.h"
#include "dynamics/zero_order.h"

namespace camber::dynamics {

struct SemiOptions {
  double points_per_period = 60;  ///< time steps per period of the highest mode; depths are right to about 0.2 %
  int min_intervals = 0;          ///< a lower bound for the period, for checks of convergence
  double scan_step = 0.19;        ///< step as a fraction of the lowest zero-order depth: thinner islands can be missed
  double deepest = 20;            ///< times the lowest zero-order depth: where the search ends
};

/// The multiplier of largest modulus over a period: a tooth's with equal pitches, else a revolution. Below 1: stable.
std::complex<double> dominant_multiplier(std::span<const Mode> modes, const Cut& cut, double speed_rpm, double depth_mm,
                                         const SemiOptions& options = {});

enum class StabilityBorder {
  none,
  hopf,  ///< two complex multipliers: a vibration beside the tooth passings
  flip,  ///< -1: every second tooth alike
  fold   ///< 1
};

struct SemiBorder {
  CriticalDepth critical;
  StabilityBorder border = StabilityBorder::none;
  std::complex<double> multiplier;  ///< at the border
};

/// The smallest depth at which a multiplier passes 1: all smaller ones are stable, but for islands (scan_step).
SemiBorder semi_border(std::span<const Mode> modes, const Cut& cut, double speed_rpm, const SemiOptions& options = {});

std::string_view name_of(StabilityBorder border);

}  // namespace camber::dynamics
