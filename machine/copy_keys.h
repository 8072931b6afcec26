#pragma once
// The keys of [[copy]], for its reader and its writer.
#include <array>

#include "machine/copy_operations.h"
#include "machine/number_key.h"

namespace camber::machine {

inline constexpr std::array<std::string_view, 3> kModeWords{"scanning-line", "contour-line", "drilling"};
inline constexpr std::array<std::string_view, 3> kSenseWords{"climb", "conventional", "both"};
inline constexpr std::array<std::string_view, 3> kCycleWords{"centre", "peck", "ream"};
inline constexpr std::array<std::string_view, 3> kSlottingWords{"by-load", "full-width", "trochoidal"};
inline constexpr NumberRange kRampDeg{.min = 0, .max = 45, .above_min = true};
inline constexpr NumberRange kAngleDeg{.min = -360, .max = 360};

/// Numbers that an operation has anyway. Spindle speed and feed must be given.
inline constexpr std::array kCopyKeys{
    NumberKey<CopyOperation>{"spindle_rpm", &CopyOperation::spindle_rpm, kPositive},
    NumberKey<CopyOperation>{"feed_mm_per_min", &CopyOperation::feed_mm_per_s, kPositive, kPerMinute},
    NumberKey<CopyOperation>{"radial_depth_mm", &CopyOperation::radial_depth_mm, kPositive},
    NumberKey<CopyOperation>{"axial_depth_mm", &CopyOperation::axial_depth_mm, kPositive},
    NumberKey<CopyOperation>{"allowance_mm", &CopyOperation::allowance_mm, kNotNegative},
    NumberKey<CopyOperation>{"scallop_mm", &CopyOperation::scallop_mm, kPositive},
    NumberKey<CopyOperation>{"angle_deg", &CopyOperation::angle_rad, kAngleDeg, kDegrees},
    NumberKey<CopyOperation>{"ramp_deg", &CopyOperation::ramp_rad, kRampDeg, kDegrees},
};

}  // namespace camber::machine
