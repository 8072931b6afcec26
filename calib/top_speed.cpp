#include "calib/top_speed.h"

#include <algorithm>
#include <cmath>

namespace camber::calib {
namespace {

constexpr double kSameFraction = 2e-3;      // of a limit: the axis is at it
constexpr double kBelowFraction = 5e-3;     // of a limit: the axis is not at it
constexpr double kAskedMore = 1.01;         // times the speed
constexpr double kResolvedFraction = 1e-4;  // of a speed
constexpr double kStill = 1e-2;             // mm/s or degrees/s

bool at_limit(const HeldSpeed& held, std::size_t axis, const JointSpeeds& highest) {
  const double speed = held.speed[axis];
  if (speed < kStill || speed < (1 - kSameFraction) * highest[axis]) return false;
  if (held.asked.per_s[axis] < kAskedMore * speed) return false;
  if (held.asked.axes_apart) return true;
  for (std::size_t i = 0; i < kJoints; ++i)
    if (i != axis && held.speed[i] > kStill && held.speed[i] > (1 - kBelowFraction) * highest[i]) return false;
  return true;
}

}  // namespace

std::array<TopSpeed, kJoints> top_speeds(const std::vector<HeldSpeed>& all) {
  JointSpeeds highest{};
  for (const HeldSpeed& held : all)
    for (std::size_t i = 0; i < kJoints; ++i) highest[i] = std::max(highest[i], held.speed[i]);
  std::array<TopSpeed, kJoints> tops{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    TopSpeed& top = tops[i];
    top.highest = highest[i];
    double longest_s = 0;
    for (const HeldSpeed& held : all) {
      if (!at_limit(held, i, highest)) continue;
      ++top.moves;
      if (held.duration_s <= longest_s) continue;
      longest_s = held.duration_s;
      top.limit = {held.speed[i], std::hypot(2 * kTraceRounding / longest_s, kResolvedFraction * held.speed[i])};
    }
  }
  return tops;
}

}  // namespace camber::calib
