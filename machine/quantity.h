#pragma once
// Lengths and angles as FreeCAD writes them: text with a unit.
#include <optional>
#include <string_view>

namespace camber::machine {

/// "5.0000 mm", "1.063 \"", "6,0 mm", "25,0 µm" (U+00B5 or U+03BC), "1/4 in", "1' 2 1/2\"", or a number alone, which is
/// in mm. Of points and commas in one number the last is the decimal sign. Nothing for other text or another unit.
std::optional<double> length_mm_of(std::string_view text);

/// "60.0000 °", "60 deg", "1.05 rad", or a number alone, which is in degrees.
std::optional<double> angle_deg_of(std::string_view text);

}  // namespace camber::machine
