#pragma once
// Numbered and lettered twist drills.
#include <optional>
#include <string_view>

namespace camber::machine {

/// Diameter of a wire gauge drill, number 1 to 80. Source: ASME B94.11M, Twist Drills.
std::optional<double> number_drill_mm(int number);

/// Diameter of a letter drill, A to Z. Source: the same.
std::optional<double> letter_drill_mm(char letter);

}  // namespace camber::machine
