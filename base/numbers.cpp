#include "base/numbers.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
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

namespace {

constexpr std::array<double, 7> kPowersOfTen{1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6};

/// Writes a value before `end`, with as many decimals; where it begins, or null where a double cannot tell how its
/// last digit is rounded, or the value is too large.
char* write_backwards(double value, int decimals, char* end) {
  constexpr double kMax = 4e9, kSure = 1e-5;  // the product is off by less than 1e-6
  if (static_cast<std::size_t>(decimals) >= kPowersOfTen.size()) return nullptr;
  const double scaled = std::abs(value) * kPowersOfTen[static_cast<std::size_t>(decimals)];
  if (!(scaled < kMax)) return nullptr;
  auto digits = static_cast<std::uint64_t>(scaled);
  const double left = scaled - static_cast<double>(digits);
  if (std::abs(left - 0.5) < kSure) return nullptr;
  digits += left > 0.5 ? 1 : 0;
  for (int i = 0; i < decimals; ++i, digits /= 10) *--end = static_cast<char>('0' + digits % 10);
  if (decimals > 0) *--end = '.';
  do {
    *--end = static_cast<char>('0' + digits % 10);
    digits /= 10;
  } while (digits > 0);
  if (std::signbit(value)) *--end = '-';
  return end;
}

}  // namespace

// Files have tens of millions of numbers, and whole numbers are written several times as fast as std::to_chars does
// it, which is twice as fast as fmt.
void append_cells(std::string& row, int decimals, std::initializer_list<double> values) {
  char cell[400];  // the largest double has 309 digits
  for (const double value : values) {
    char* const end = std::begin(cell) + 32;
    if (const char* from = write_backwards(value, decimals, end))
      row.append(from, static_cast<std::size_t>(end - from));
    else
      row.append(cell, std::to_chars(std::begin(cell), std::end(cell), value, std::chars_format::fixed, decimals).ptr);
    row += ',';
  }
}

}  // namespace camber
