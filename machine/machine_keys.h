#pragma once
// The keys of machine.toml, for its reader and its writer.
#include <array>

#include "machine/cycle_keys.h"
#include "machine/machine.h"
#include "machine/number_key.h"

namespace camber::machine {

inline constexpr std::array<std::string_view, 5> kCornerLawWords{"speed_difference", "angle", "blend", "exact_stop",
                                                                 "radius"};
inline constexpr std::array<std::string_view, 2> kRotaryFeedWords{"linear", "joints"};
inline constexpr std::array<std::string_view, 2> kWholeNumberWords{"units", "increments"};
inline constexpr std::array<std::string_view, 3> kAxisNames{"x", "y", "z"};

inline constexpr NumberRange kFraction{.min = 0, .max = 1, .above_min = true};
inline constexpr NumberRange kArcFraction{.min = 0, .max = 100, .above_min = true};
inline constexpr NumberRange kPeriodMs{.min = 0, .max = 1000, .above_min = true};
inline constexpr NumberRange kPercent{.min = 0, .max = 100};
inline constexpr NumberRange kMinIncrementMm{.min = 1e-6, .max = 0.1};
inline constexpr NumberRange kG60Mm{.min = -1000, .max = 1000};
inline constexpr NumberRange kBlockCount{.min = 0, .max = 1e6, .whole = true};

/// Parameter sets of a control, by what selects them; the first that a program's codes select counts.
/// high_speed_contouring: any of the first three, where it has no set for itself.
inline constexpr std::array<std::string_view, 42> kModeNames{
    "g05_1_q1", "g05_p10000", "g08_p1", "cycle832_finish", "cycle832_semifin", "cycle832_rough", "cycle832",
    "cycle32_finish", "cycle32_rough", "cycle32", "high_speed_contouring", "m120",
    // words of Sinumerik programs
    "dynfinish", "dynprec", "dynsemifin", "dynrough", "dynpos", "dynnorm", "compcad", "compsurf", "compcurv",
    "comppath", "compon", "brisk", "soft", "drive", "ffwof", "ffwon", "g601", "g602", "g603", "g641", "g642", "g643",
    "g644", "g645", "g646",
    //
    "g61", "g61_1", "g62", "g63", "g64"};

/// Keys of a parameter set beside those of [control]: its own acceleration law.
inline constexpr std::array kModeLawKeys{
    NumberKey<AccelerationTimes>{"time_constant_1_ms", &AccelerationTimes::time_constant_1_s, kNotNegative,
                                 kMilliseconds},
    NumberKey<AccelerationTimes>{"time_constant_2_ms", &AccelerationTimes::time_constant_2_s, kNotNegative,
                                 kMilliseconds},
    NumberKey<AccelerationTimes>{"bell_time_ms", &AccelerationTimes::bell_time_s, kNotNegative, kMilliseconds},
};

inline constexpr std::array kControlKeys{
    NumberKey<Control>{"period_ms", &Control::period_s, kPeriodMs, kMilliseconds},
    NumberKey<Control>{"block_time_ms", &Control::block_time_s, kNotNegative, kMilliseconds},
    NumberKey<Control>{"merge_tolerance_mm", &Control::merge_tolerance_mm, kNotNegative},
    NumberKey<Control>{"arc_normal_share", &Control::arc_normal_fraction, kArcFraction},
    NumberKey<Control>{"arc_tangential_share", &Control::arc_tangential_fraction, kFraction},
    NumberKey<Control>{"rest_latency_ms", &Control::rest_latency_s, kNotNegative, kMilliseconds},
    NumberKey<Control>{"stop_acceleration_share", &Control::stop_acceleration_fraction, kFraction},
    NumberKey<Control>{"path_acceleration_mm_per_s2", &Control::path_acceleration_mm_per_s2, kPositiveOrInf},
    NumberKey<Control>{"rapid_change_ms", &Control::rapid_change_s, kNotNegative, kMilliseconds},
    NumberKey<Control>{"in_position_mm", &Control::in_position_mm, kPositiveOrInf},
};

inline constexpr std::array kCornerKeys{
    NumberKey<Corner>{"tolerance_mm", &Corner::tolerance_mm, kNotNegativeOrInf},
    NumberKey<Corner>{"speed_difference_mm_per_min", &Corner::speed_difference_mm_per_s, kPositiveOrInf, kPerMinute},
    NumberKey<Corner>{"time_ms", &Corner::time_s, kNotNegative, kMilliseconds},
    NumberKey<Corner>{"acceleration_mm_per_s2", &Corner::acceleration_mm_per_s2, kPositiveOrInf},
    NumberKey<Corner>{"threshold_degrees", &Corner::threshold_rad, kNotNegative, kDegrees},
    NumberKey<Corner>{"step_share", &Corner::step_fraction, kNotNegative},
    NumberKey<Corner>{"short_line_time_ms", &Corner::short_line_time_s, kNotNegative, kMilliseconds},
    NumberKey<Corner>{"stop_angle_degrees", &Corner::stop_angle_rad, kPositiveOrInf, kDegrees},
    NumberKey<Corner>{"stop_time_ms", &Corner::stop_time_s, kNotNegative, kMilliseconds},
};

/// The number that each corner law cannot do without, in the order of kCornerLawWords; empty: none.
inline constexpr std::array<std::string_view, 5> kCornerLawKeys{"speed_difference_mm_per_min", "time_ms",
                                                                "tolerance_mm", "", "acceleration_mm_per_s2"};

inline constexpr std::array kAxisKeys{
    NumberKey<Axis>{"max_velocity_mm_per_min", &Axis::max_velocity_mm_per_s, kPositiveOrInf, kPerMinute},
    NumberKey<Axis>{"acceleration_mm_per_s2", &Axis::acceleration_mm_per_s2, kPositiveOrInf},
    NumberKey<Axis>{"jerk_mm_per_s3", &Axis::jerk_mm_per_s3, kPositiveOrInf},
    NumberKey<Axis>{"filter_ms", &Axis::filter_s, kNotNegative, kMilliseconds},
    NumberKey<Axis>{"exponential_1_ms", &Axis::exponential_1_s, kNotNegative, kMilliseconds},
    NumberKey<Axis>{"exponential_2_ms", &Axis::exponential_2_s, kNotNegative, kMilliseconds},
    NumberKey<Axis>{"position_gain_per_s", &Axis::position_gain_per_s, kPositiveOrInf},
    NumberKey<Axis>{"velocity_lag_ms", &Axis::velocity_lag_s, kNotNegative, kMilliseconds},
    NumberKey<Axis>{"feed_forward_percent", &Axis::feed_forward_percent, kPercent},
    NumberKey<Axis>{"acceleration_feed_forward_ms", &Axis::acceleration_feed_forward_s, kNotNegative, kMilliseconds},
    NumberKey<Axis>{"dead_time_ms", &Axis::dead_time_s, kDeadTimeMs, kMilliseconds},
    NumberKey<Axis>{"backlash_mm", &Axis::backlash_mm, kNotNegative},
    NumberKey<Axis>{"speed_difference_mm_per_min", &Axis::speed_difference_mm_per_s, kPositiveOrInf, kPerMinute},
    NumberKey<Axis>{"stiffness_N_per_um", &Axis::stiffness_N_per_mm, kPositiveOrInf, kNewtonsPerMicrometre},
    NumberKey<Axis>{"rapid_mm_per_min", &Axis::rapid_mm_per_s, kPositiveOrInf, kPerMinute},
    NumberKey<Axis>{"rapid_acceleration_mm_per_s2", &Axis::rapid_acceleration_mm_per_s2, kPositiveOrInf},
    NumberKey<Axis>{"g60_mm", &Axis::g60_mm, kG60Mm},
    NumberKey<Axis>{"max_feed_mm_per_min", &Axis::max_feed_mm_per_s, kPositiveOrInf, kPerMinute},
};

inline constexpr std::array kSpindleKeys{
    NumberKey<Spindle>{"max_rpm", &Spindle::max_rpm, kPositiveOrInf},
    NumberKey<Spindle>{"gd2_kgf_m2", &Spindle::gd2_kgf_m2, kNotNegative},
    NumberKey<Spindle>{"power_W", &Spindle::power_W, kPositiveOrInf},
    NumberKey<Spindle>{"constant_torque_rpm", &Spindle::constant_torque_rpm, kPositiveOrInf},
    NumberKey<Spindle>{"constant_power_rpm", &Spindle::constant_power_rpm, kPositiveOrInf},
    NumberKey<Spindle>{"start_time_s", &Spindle::start_time_s, kNotNegative},
    NumberKey<Spindle>{"orient_s", &Spindle::orient_s, kNotNegative},
};

}  // namespace camber::machine
