#pragma once
// The vibration of the tool over one period of the cut, as a linear map of its state: modes and past positions.
#include <array>
#include <span>
#include <vector>

#include "dynamics/vibrating_cut.h"

namespace camber::dynamics {

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
  Eigen::Matrix2d tooth_mean(double angle_from, double angle_to, double depth_mm) const;
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
