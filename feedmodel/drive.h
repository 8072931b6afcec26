#pragma once
// Drive of one axis, linear or rotary: filter, exponential lags, dead time, position loop and backlash in series.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/geometry.h"
#include "machine/machine_model.h"

namespace camber::feedmodel {

/// Mean of the last `window` commands of one axis (a step of speed becomes a linear ramp of window x period).
/// Source: KAKEN report, eqs. 4-5 (a ramp of 64 ms). window 0 or 1: nothing is changed.
class AxisFilter {
 public:
  AxisFilter(std::size_t window, double start_mm) : ring_(window, start_mm), mean_mm_(start_mm) {}

  double operator()(double command_mm) {
    if (ring_.size() < 2) return command_mm;
    mean_mm_ += (command_mm - ring_[at_]) / static_cast<double>(ring_.size());
    ring_[at_] = command_mm;
    if (++at_ == ring_.size()) {
      at_ = 0;
      double sum = 0;  // summed anew once a turn, so that rounding does not gather
      for (double v : ring_) sum += v;
      mean_mm_ = sum / static_cast<double>(ring_.size());
    }
    return mean_mm_;
  }

 private:
  std::vector<double> ring_;
  std::size_t at_ = 0;
  double mean_mm_;
};

/// Commands `periods` periods ago, which need not be whole: between two of them the command runs straight.
class DeadTime {
 public:
  DeadTime(double periods, double start)
      : whole_(static_cast<std::size_t>(periods)),
        fraction_(periods - std::floor(periods)),
        ring_(periods > 0 ? whole_ + 2 : 0, start) {}

  double operator()(double command) {
    if (ring_.empty()) return command;
    ring_[at_] = command;
    const std::size_t n = ring_.size(), later = (at_ + n - whole_) % n, earlier = (later + n - 1) % n;
    at_ = (at_ + 1) % n;
    return (1 - fraction_) * ring_[later] + fraction_ * ring_[earlier];
  }

 private:
  std::size_t whole_;
  double fraction_;
  std::vector<double> ring_;
  std::size_t at_ = 0;
};

struct PositionLoopOptions {
  double gain_per_s = 0;                   ///< Kp; infinite: the axis is where it is commanded
  double velocity_lag_s = 0;               ///< Tv, time constant of the velocity loop; 0: none
  double feed_forward_percent = 0;         ///< Kf
  double acceleration_feed_forward_s = 0;  ///< Ka
  double period_s = 0.001;
};

/// Tv x'' + x' = Kp (c - x) + Kf/100 c' + Ka c''
///
/// solved exactly for a command c that runs straight between two periods (its acceleration is a step of speed at each
/// of them). At a constant speed v the axis is
/// behind by v (1 - Kf/100) / Kp.
/// Source: Yan & Shirase 1997; Takata 1999 (Kp, Kf; docs/feed-model.md); Tv as the traces of real drives show it.
class PositionLoop {
 public:
  PositionLoop(const PositionLoopOptions& options, double start_mm);

  /// Advances by one period in which the command goes from the last one to `command_mm`; returns the position.
  double operator()(double command_mm);
  double position_mm() const { return position_mm_; }
  double velocity_mm_per_s() const { return velocity_mm_per_s_; }

 private:
  PositionLoopOptions options_;
  double command_mm_, position_mm_;
  double command_speed_mm_per_s_ = 0;
  double velocity_mm_per_s_ = 0;
  // Deviation from the steady following, advanced by one period: [z z'] <- [[a b] [c d]] [z z'].
  double a_ = 0, b_ = 0, c_ = 0, d_ = 0;
};

/// The load stays until the motor has taken up half the play on either side (play operator): at a reversal `width` of
/// the motion is lost. Begins in the middle. width 0: nothing is changed.
class Backlash {
 public:
  Backlash(double width, double start) : half_(width / 2), load_(start) {}

  double operator()(double motor) {
    if (half_ <= 0) return motor;
    return load_ = std::clamp(load_, motor - half_, motor + half_);
  }

 private:
  double half_, load_;
};

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
