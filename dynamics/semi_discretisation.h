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
#include <array>
#include <complex>
#include <span>
#include <string_view>
#include <vector>

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

// The vibration of the tool over one period of the cut, as a linear map of its state: modes and past positions.

/// The state is (position, velocity) of each mode and, before it, the tool's places at the knots of the longest delay.
class PeriodMap {
 public:
  /// At least `min_intervals` and `points_per_period` of the highest mode.
  PeriodMap(std::span<const Mode> modes, const Cut& cut, double speed_rpm, double points_per_period, int min_intervals);

  /// For a depth. Must be called before `apply`.
  void set_depth(double depth_mm);

  Eigen::Index size() const { return static_cast<Eigen::Index>(2 * modes_.size() + kept_.size()); }
  double period_s() const { return period_s_; }
  int intervals() const { return intervals_; }
  /// The state a period later.
  void apply(const Eigen::VectorXd& from, Eigen::VectorXd& to);

 private:
  struct ModeStep {
    Vec2 direction;
    Eigen::Matrix2d free;        ///< (q, q') of a knot to the next
    Eigen::Vector2d begin, end;  ///< (q, q') per force along the mode at the two knots
  };
  struct Interval {
    Eigen::Matrix2d now;     ///< force on the tool: -now u + sum of delayed
    Eigen::Matrix2d settle;  ///< (I + D1 now)^-1: the place at the end depends on the force there
  };
  /// Teeth with the same delay.
  struct Delay {
    double knots = 0;                   ///< length in intervals
    std::vector<Eigen::Matrix2d> chip;  ///< chip matrix of each interval, N/mm
  };

  ModeStep step_of(const Mode& mode) const;
  Vec2 delayed(std::size_t knot_from_start, double delay) const;
  /// Integrals of the chip's matrix of one slice, up to the angle of its lower and of its upper end.
  struct SliceIntegrals {
    Eigen::Matrix2d low, high;
  };
  void integrate_to(double angle_rad, double depth_mm, std::vector<SliceIntegrals>& out) const;
  Eigen::Matrix2d tooth_mean(const std::vector<SliceIntegrals>& from, const std::vector<SliceIntegrals>& to,
                             double turn_rad, double depth_mm) const;
  void keep_history_that_counts();

  std::vector<Mode> modes_;
  Cut cut_;
  double speed_rpm_;
  bool equal_;
  std::vector<DirectionalIntegral> integrals_;  ///< directional integrals of the slices
  double period_s_, dt_s_;
  int intervals_, history_;  ///< history_: knots before the period
  std::vector<ModeStep> steps_;
  Eigen::Matrix2d begin_, end_;  ///< place at an interval's end per force at its two ends
  std::vector<Delay> delays_;
  std::vector<Interval> interval_;
  std::vector<std::array<int, 2>> kept_;  ///< knot and component of the past that the state has
  std::vector<Vec2> place_;               ///< positions at the knots: history_, then the period
};

}  // namespace camber::dynamics
