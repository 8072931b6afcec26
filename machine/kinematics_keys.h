#pragma once
// The keys of [axis.a], [axis.b] and [axis.c], for their reader and their writer.
#include <array>

#include "machine/cycle_keys.h"
#include "machine/kinematics.h"
#include "machine/number_key.h"

namespace camber::machine {

inline constexpr std::array<std::string_view, 3> kRotaryAxisNames{"a", "b", "c"};
inline constexpr std::array<std::string_view, 2> kPositiveTurnWords{"tool", "table"};

inline constexpr NumberRange kFeedForwardPercent{.min = 0, .max = 100};
inline constexpr NumberRange kMCode{.min = 1, .max = 999, .whole = true};

inline constexpr std::array kRotaryAxisKeys{
    NumberKey<RotaryAxis>{"max_velocity_deg_per_min", &RotaryAxis::max_velocity_rad_per_s, kPositiveOrInf,
                          kDegreesPerMinute},
    NumberKey<RotaryAxis>{"max_feed_deg_per_min", &RotaryAxis::max_feed_rad_per_s, kPositiveOrInf, kDegreesPerMinute},
    NumberKey<RotaryAxis>{"rapid_deg_per_min", &RotaryAxis::rapid_rad_per_s, kPositiveOrInf, kDegreesPerMinute},
    NumberKey<RotaryAxis>{"acceleration_deg_per_s2", &RotaryAxis::acceleration_rad_per_s2, kPositiveOrInf, kDegrees},
    NumberKey<RotaryAxis>{"jerk_deg_per_s3", &RotaryAxis::jerk_rad_per_s3, kPositiveOrInf, kDegrees},
    NumberKey<RotaryAxis>{"filter_ms", &RotaryAxis::filter_s, kNotNegative, kMilliseconds},
    NumberKey<RotaryAxis>{"exponential_1_ms", &RotaryAxis::exponential_1_s, kNotNegative, kMilliseconds},
    NumberKey<RotaryAxis>{"exponential_2_ms", &RotaryAxis::exponential_2_s, kNotNegative, kMilliseconds},
    NumberKey<RotaryAxis>{"position_gain_per_s", &RotaryAxis::position_gain_per_s, kPositiveOrInf},
    NumberKey<RotaryAxis>{"velocity_lag_ms", &RotaryAxis::velocity_lag_s, kNotNegative, kMilliseconds},
    NumberKey<RotaryAxis>{"feed_forward_percent", &RotaryAxis::feed_forward_percent, kFeedForwardPercent},
    NumberKey<RotaryAxis>{"acceleration_feed_forward_ms", &RotaryAxis::acceleration_feed_forward_s, kNotNegative,
                          kMilliseconds},
    NumberKey<RotaryAxis>{"dead_time_ms", &RotaryAxis::dead_time_s, kDeadTimeMs, kMilliseconds},
    NumberKey<RotaryAxis>{"backlash_deg", &RotaryAxis::backlash_rad, kNotNegative, kDegrees},
    NumberKey<RotaryAxis>{"speed_difference_deg_per_min", &RotaryAxis::speed_difference_rad_per_s, kPositiveOrInf,
                          kDegreesPerMinute},
    NumberKey<RotaryAxis>{"clamp_s", &RotaryAxis::clamp_s, kNotNegative},
};

}  // namespace camber::machine
