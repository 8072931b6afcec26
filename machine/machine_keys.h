#pragma once
// The keys of machine.toml, for its reader and its writer.
#include <array>

#include "machine/cycle.h"
#include "machine/kinematics.h"
#include "machine/machine_model.h"
#include "machine/number_key.h"

namespace camber::machine {

inline constexpr NumberRange kDeadTimeMs{.min = 0, .max = 1000};  // of an axis
inline constexpr std::array<std::string_view, 2> kRapidPathWords{"dogleg", "linear"};
inline constexpr std::array<std::string_view, 3> kAccelerationLawWords{"linear", "exponential", "bell"};
inline constexpr std::array<std::string_view, 2> kCodeOrderWords{"sequential", "simultaneous"};

inline constexpr NumberRange kOverridePercent{.min = 0, .max = 1000, .above_min = true};
inline constexpr NumberRange kOverlapPercent{.min = 0, .max = 100};
inline constexpr FileUnit kDegreesPerMinute{[](double v) { return rad_from_deg(v) / 60.0; },
                                            [](double v) { return deg_from_rad(v) * 60.0; }};

inline constexpr std::array kCycleKeys{
    NumberKey<Cycle>{"time_constant_1_ms", &Cycle::time_constant_1_s, kNotNegative, kMilliseconds},
    NumberKey<Cycle>{"time_constant_2_ms", &Cycle::time_constant_2_s, kNotNegative, kMilliseconds},
    NumberKey<Cycle>{"bell_time_ms", &Cycle::bell_time_s, kNotNegative, kMilliseconds},
    NumberKey<Cycle>{"rapid_override_percent", &Cycle::rapid_override_percent, kOverridePercent},
    NumberKey<Cycle>{"feed_override_percent", &Cycle::feed_override_percent, kOverridePercent},
    NumberKey<Cycle>{"rapid_overlap_percent", &Cycle::rapid_overlap_percent, kOverlapPercent},
    NumberKey<Cycle>{"linear_acceleration_mm_per_s2", &Cycle::linear_acceleration_mm_per_s2, kPositiveOrInf},
    NumberKey<Cycle>{"arc_acceleration_mm_per_s2", &Cycle::arc_acceleration_mm_per_s2, kPositiveOrInf},
    NumberKey<Cycle>{"arc_tolerance_mm", &Cycle::arc_tolerance_mm, kPositiveOrInf},
    NumberKey<Cycle>{"arc_loop_factor", &Cycle::arc_loop_factor, kPositive},
    NumberKey<Cycle>{"jerk_filter_ms", &Cycle::jerk_filter_s, kNotNegative, kMilliseconds},
    NumberKey<Cycle>{"m_code_s", &Cycle::m_code_s, kNotNegative},
    NumberKey<Cycle>{"s_code_s", &Cycle::s_code_s, kNotNegative},
    NumberKey<Cycle>{"t_code_s", &Cycle::t_code_s, kNotNegative},
    NumberKey<Cycle>{"histogram_step_mm", &Cycle::histogram_step_mm, kNotNegative},
    NumberKey<Cycle>{"pallet_change_s", &Cycle::pallet_change_s, kNotNegative},
    NumberKey<Cycle>{"creep_feed_mm_per_min", &Cycle::creep_feed_mm_per_s, kPositiveOrInf, kPerMinute},
};

inline constexpr std::array kToolChangeKeys{
    NumberKey<ToolChange>{"chip_to_chip_s", &ToolChange::chip_to_chip_s, kNotNegative},
    NumberKey<ToolChange>{"tool_to_tool_s", &ToolChange::tool_to_tool_s, kNotNegative},
    NumberKey<ToolChange>{"x_mm", &ToolChange::x_mm, kAnyNumberOrInf},
    NumberKey<ToolChange>{"y_mm", &ToolChange::y_mm, kAnyNumberOrInf},
    NumberKey<ToolChange>{"z_mm", &ToolChange::z_mm, kAnyNumberOrInf},
};

inline constexpr std::array<std::string_view, 3> kReferencePointNames{"2", "3", "4"};

inline constexpr std::array kReferencePointKeys{
    NumberKey<ReferencePoint>{"x_mm", &ReferencePoint::x_mm, kAnyNumberOrInf},
    NumberKey<ReferencePoint>{"y_mm", &ReferencePoint::y_mm, kAnyNumberOrInf},
    NumberKey<ReferencePoint>{"z_mm", &ReferencePoint::z_mm, kAnyNumberOrInf},
};

inline constexpr std::array kIndexKeys{
    NumberKey<IndexTable>{"max_velocity_deg_per_min", &IndexTable::max_velocity_rad_per_s, kPositiveOrInf,
                          kDegreesPerMinute},
    NumberKey<IndexTable>{"acceleration_deg_per_s2", &IndexTable::acceleration_rad_per_s2, kPositiveOrInf, kDegrees},
    NumberKey<IndexTable>{"clamp_s", &IndexTable::clamp_s, kNotNegative},
};

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
