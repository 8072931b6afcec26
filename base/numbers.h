#pragma once
// Numbers in text, without a locale.
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace camber {

/// A decimal number that fills the whole text: "1", "-.5", "+2.", "1e-3". Nothing else: no blanks, no
/// "inf", no "nan", no hexadecimal.
std::optional<double> parse_number(std::string_view text);

/// Fixed notation with at most `decimals` decimals and no trailing zeros; never "-0".
std::string format_trimmed(double value, int decimals);

/// Adds cells to a row of CSV: each value in fixed notation, rounded correctly to `decimals` decimals, and a comma.
void append_cells(std::string& row, int decimals, std::initializer_list<double> values);

}  // namespace camber
