#include "base/numbers.h"

#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace camber {

std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) return std::nullopt;
  }
  bool digit = false;
  for (const char c : text) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit && c != '.' && c != '-' && c != '+' && c != 'e' && c != 'E') return std::nullopt;
    digit = digit || is_digit;
  }
  if (!digit) return std::nullopt;
  double value = 0;
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (ec != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string format_trimmed(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  if (out.find('.') != std::string::npos) {
    while (out.back() == '0') out.pop_back();
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

// std::to_chars takes half of fmt's time, and files have tens of millions of numbers.
void append_cells(std::string& row, int decimals, std::initializer_list<double> values) {
  char cell[400];  // the largest double has 309 digits
  for (const double value : values) {
    row.append(cell, std::to_chars(std::begin(cell), std::end(cell), value, std::chars_format::fixed, decimals).ptr);
    row += ',';
  }
}

}  // namespace camber
