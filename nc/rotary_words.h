#pragma once
// Handling of rotary words that all languages share.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/units.h"
#include "nc/rotary.h"

namespace camber::nc {

/// Commands that read rotary axes, on a machine with [kinematics]; for messages.
inline constexpr char kReadersOfRotaryAxes[] = "check, time, feed, fit-feed, predict, compensate and post";

/// Bit of A, B or C in RotaryTarget::given.
inline std::uint8_t bit_of_axis(char letter) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(letter - 'A'));
}

/// `angle` plus whole turns, at most half a turn from `from`, rad; half a turn is positive, whatever the rounding.
inline double shortest_way(double angle, double from) {
  return angle + 2 * kPi * std::floor((from - angle) / (2 * kPi) + 0.5 + 1e-9);
}

/// Null where the machine has no such axis.
inline const RotaryOption* rotary_axis_of(std::span<const RotaryOption> axes, char letter) {
  const auto at = std::ranges::find(axes, letter, &RotaryOption::letter);
  return at == axes.end() ? nullptr : &*at;
}

}  // namespace camber::nc
