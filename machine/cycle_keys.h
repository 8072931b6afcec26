#pragma once
// The keys of machine.toml that tell cycle time, for its reader and its writer.
#include <array>

#include "machine/cycle.h"
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

}  // namespace camber::machine
