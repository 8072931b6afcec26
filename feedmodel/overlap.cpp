#include "feedmodel/overlap.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "machine/machine_model.h"

namespace camber::feedmodel {
namespace {

constexpr double kLeastSine = 1e-3;
constexpr double kNoSpeed = 1e-8;  // mm/s
constexpr double kAtEnd_mm = 1e-9;
constexpr double kTop = 1 - 1e-12;    // rounding
constexpr double kMaxCycles = 3.6e7;  // a block of ten hours at 1 ms

double reachable(const PlanRow& row, double length_mm) {
  return std::min(std::sqrt(row.acceleration_mm_per_s2 * length_mm), row.speed_limit_mm_per_s);
}

/// A block under way, from rest to rest, in steps of the period.
class Block {
 public:
  Block(const PlanRow& row, double period_s)
      : length_(row.length_mm), limit_(row.speed_limit_mm_per_s), a_(row.acceleration_mm_per_s2), t_(period_s) {}

  /// Advances one period at the speed from which the block can still stop at its end.
  void step() {
    const double gain = a_ * t_, half = gain / 2;
    const double reach = half * half + a_ * (2 * (length_ - way_) - speed_ * t_);
    const double can_stop = reach > half * half ? std::sqrt(reach) - half : -half;
    const double change = std::clamp(std::min(can_stop, limit_) - speed_, -gain, gain);
    const double speed = std::max(0.0, speed_ + change);
    way_ = speed > 0 ? std::min(length_, way_ + (speed + speed_) * t_ / 2) : length_;
    speed_ = speed;
    braking_ = change < 0 && std::abs(can_stop - speed_) < kNoSpeed;
  }

  /// The whole periods of constant acceleration from rest at once; returns their number.
  double start() {
    const double gain = a_ * t_;
    const double n = std::floor(std::min(limit_ / gain - 1, std::sqrt(a_ * length_) / gain - 4));
    if (n <= 0) return 0;
    way_ = n * n * gain * t_ / 2;
    speed_ = n * gain;
    return n;
  }

  /// Does the same at the highest speed, until the block must brake.
  double cruise() {
    if (speed_ < kTop * limit_) return 0;
    const double way = limit_ * t_, n = std::floor((length_ - way_ - limit_ * limit_ / (2 * a_)) / way) - 2;
    if (n <= 0) return 0;
    way_ += n * way;
    return n;
  }

  bool over() const { return way_ >= length_ - kAtEnd_mm; }
  bool braking() const { return braking_; }
  double speed() const { return speed_; }

 private:
  double length_, limit_, a_, t_;
  double way_ = 0, speed_ = 0;
  bool braking_ = false;
};

}  // namespace

double overlap_corner_speed(double turn_rad, double acceleration_mm_per_s2, double tolerance_mm) {
  const double sine = std::sin(turn_rad / 2);
  if (sine < kLeastSine || tolerance_mm <= 0) return machine::kNoLimit;
  return 2 * std::sqrt(acceleration_mm_per_s2 * tolerance_mm / sine);
}

double overlap_speed(const PlanRow& row, const PlanRow& next, bool next_is_last) {
  const double v = reachable(row, row.length_mm),
               v_next = reachable(next, next_is_last ? next.length_mm / 2 : next.length_mm);
  if (v <= 0 || v_next <= 0) return 0;
  const double longest_s = std::min(row.length_mm / v, next.length_mm / v_next);
  const double wanted_s = std::max(v / row.acceleration_mm_per_s2, v_next / next.acceleration_mm_per_s2);
  return std::min(v, std::min(longest_s, wanted_s) * row.acceleration_mm_per_s2);
}

OverlapTimes overlap_times(const PlanRow& row, const OverlapOptions& o) {
  assert(row.length_mm > 0 && row.speed_limit_mm_per_s > 0 && std::isfinite(row.acceleration_mm_per_s2));
  Block block(row, o.period_s);
  OverlapTimes out;
  bool begun = false;
  double cycle = block.start();
  for (; !block.over() && cycle < kMaxCycles; ++cycle) {
    cycle += block.cruise();
    block.step();
    const double now_s = o.start_s + cycle * o.period_s;
    if (begun || o.speed <= 0 || now_s < o.alone_from_s - 1e-9 || !block.braking() || block.speed() >= o.speed)
      continue;
    begun = true;
    out.next_start_s = now_s;
  }
  out.end_s = o.start_s + cycle * o.period_s;
  if (!begun) out.next_start_s = out.end_s;
  return out;
}

}  // namespace camber::feedmodel
