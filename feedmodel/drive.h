#pragma once
// Drive of one axis, linear or rotary: filter, exponential lags, dead time, position loop and backlash in series.
#include <cmath>

#include "feedmodel/axis_filter.h"
#include "feedmodel/backlash.h"
#include "feedmodel/dead_time.h"
#include "feedmodel/position_loop.h"
#include "machine/machine.h"

namespace camber::feedmodel {

/// Parameters that machine::Axis and machine::RotaryAxis share.
struct DriveOptions {
  double filter_s = 0;  ///< moving average
  double exponential_1_s = 0, exponential_2_s = 0;
  double gain_per_s = machine::kNoLimit, velocity_lag_s = 0, feed_forward_percent = 0;
  double acceleration_feed_forward_s = 0, dead_time_s = 0, backlash = 0;
  double period_s = 0.001;
};

inline double backlash_of(const machine::Axis& axis) { return axis.backlash_mm; }
inline double backlash_of(const machine::RotaryAxis& axis) { return axis.backlash_rad; }

template <class Axis>
DriveOptions drive_options(const Axis& axis, double filter_s, double period_s) {
  return {.filter_s = filter_s,
          .exponential_1_s = axis.exponential_1_s,
          .exponential_2_s = axis.exponential_2_s,
          .gain_per_s = axis.position_gain_per_s,
          .velocity_lag_s = axis.velocity_lag_s,
          .feed_forward_percent = axis.feed_forward_percent,
          .acceleration_feed_forward_s = axis.acceleration_feed_forward_s,
          .dead_time_s = axis.dead_time_s,
          .backlash = backlash_of(axis),
          .period_s = period_s};
}

class Drive {
 public:
  Drive(const DriveOptions& o, double start)
      : filter_(static_cast<std::size_t>(std::lround(o.filter_s / o.period_s)), start),
        exponential_1_(lag(o.exponential_1_s, o.period_s), start),
        exponential_2_(lag(o.exponential_2_s, o.period_s), start),
        dead_time_(o.dead_time_s / o.period_s, start),
        loop_({.gain_per_s = o.gain_per_s,
               .velocity_lag_s = o.velocity_lag_s,
               .feed_forward_percent = o.feed_forward_percent,
               .acceleration_feed_forward_s = o.acceleration_feed_forward_s,
               .period_s = o.period_s},
              start),
        backlash_(o.backlash, start) {}

  /// Advances by one period: takes the command at its end, returns the actual position at its end.
  double operator()(double command) {
    return backlash_(loop_(dead_time_(exponential_2_(exponential_1_(filter_(command))))));
  }
  /// Returns the position of the motor, without backlash.
  double velocity_per_s() const { return loop_.velocity_mm_per_s(); }

 private:
  /// A first-order lag is a loop with a gain of 1 / T.
  static PositionLoopOptions lag(double time_s, double period_s) {
    return {.gain_per_s = time_s > 0 ? 1.0 / time_s : machine::kNoLimit, .period_s = period_s};
  }

  AxisFilter filter_;
  PositionLoop exponential_1_, exponential_2_;
  DeadTime dead_time_;
  PositionLoop loop_;
  Backlash backlash_;
};

}  // namespace camber::feedmodel
