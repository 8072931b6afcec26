#pragma once
// Unit conversions for reading and writing. Internal units are mm, s, N, MPa and rad.
#include "base/geometry.h"

namespace camber {
inline constexpr double kMmPerInch = 25.4;
constexpr double mm_per_s_from_mm_per_min(double v) { return v / 60.0; }
constexpr double mm_per_min_from_mm_per_s(double v) { return v * 60.0; }
constexpr double rad_from_deg(double v) { return v * kPi / 180.0; }
constexpr double deg_from_rad(double v) { return v * 180.0 / kPi; }
constexpr double um_from_mm(double v) { return v * 1000.0; }
constexpr double mm_from_um(double v) { return v / 1000.0; }
constexpr double MPa_from_GPa(double v) { return v * 1000.0; }
constexpr double N_per_mm_from_N_per_um(double v) { return v * 1000.0; }
}  // namespace camber
