#include "nc/emit/number_style.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace camber::nc {
namespace {

constexpr std::size_t kSample = 20000;  ///< coordinates looked at

bool is_coordinate(char letter) { return (letter >= 'X' && letter <= 'Z') || (letter >= 'I' && letter <= 'K'); }

std::string_view without_sign(std::string_view number) {
  if (!number.empty() && (number.front() == '-' || number.front() == '+')) number.remove_prefix(1);
  return number;
}

/// ".5", "0.5"; nothing where the number does not show it.
std::optional<bool> has_leading_zero(std::string_view number, double value) {
  if (std::abs(value) >= 1 || value == 0) return std::nullopt;
  return without_sign(number).front() == '0';
}

std::optional<WholeStyle> whole_style(std::string_view number, double value) {
  if (value != std::floor(value)) return std::nullopt;
  switch (decimals_of(number)) {
    case -1:
      return WholeStyle::plain;
    case 0:
      return WholeStyle::point;
    case 1:
      return WholeStyle::point_zero;
    default:
      return std::nullopt;
  }
}

/// Counts of what the coordinates look like.
struct StyleCounts {
  std::array<std::size_t, 3> whole{};
  std::array<std::size_t, 10> decimals{};
  std::size_t zero = 0, no_zero = 0, pointed = 0, trailing_zero = 0, blank = 0, no_blank = 0;

  void add(std::string_view number, double value) {
    if (const auto zero_first = has_leading_zero(number, value)) ++(*zero_first ? zero : no_zero);
    const auto style = whole_style(number, value);
    if (style && value != 0) ++whole[static_cast<std::size_t>(*style)];  // X0 stands beside X1. in many programs
    const int d = decimals_of(number);
    if (d < 0) return;
    ++pointed;
    ++decimals[static_cast<std::size_t>(std::min(d, 9))];
    trailing_zero += d > 0 && number.back() == '0';
  }

  void say_of_numbers(NumberStyle& style) const {
    if (zero + no_zero > 0) style.leading_zero = zero >= no_zero;
    const auto most = std::max_element(decimals.begin(), decimals.end());
    if (most != decimals.begin() && *most == pointed && trailing_zero > 0)
      style.padded_decimals = static_cast<int>(most - decimals.begin());
    const auto of_whole = std::max_element(whole.begin(), whole.end());
    if (*of_whole > 0) style.whole = static_cast<WholeStyle>(of_whole - whole.begin());
  }
};

std::string_view number_of(const Program& program, const Word& w) {
  return std::string_view(program.source.text())
      .substr(w.offset + w.value_at, static_cast<std::size_t>(w.length - w.value_at));
}

}  // namespace

int decimals_of(std::string_view number) {
  const std::size_t point = number.find_first_of(".,");
  if (point == std::string_view::npos) return -1;
  return static_cast<int>(std::count_if(number.begin() + static_cast<std::ptrdiff_t>(point), number.end(),
                                        [](char c) { return c >= '0' && c <= '9'; }));
}

NumberStyle style_of(const Program& program) {
  StyleCounts c;
  const std::string_view text = program.source.text();
  const std::size_t count = std::min(program.words.size(), kSample);
  for (std::size_t i = 0; i < count; ++i) {
    const Word& w = program.words[i];
    if (!is_coordinate(w.letter) || std::isnan(w.value)) continue;
    const bool first_of_line = w.offset == 0 || text[w.offset - 1] == program.source.line_end();
    if (!first_of_line) ++(text[w.offset - 1] == ' ' ? c.blank : c.no_blank);
    if (w.length > w.value_at) c.add(number_of(program, w), w.value);
  }
  NumberStyle style;
  style.blanks = c.blank > c.no_blank;
  c.say_of_numbers(style);
  return style;
}

NumberStyle feed_style_of(const Program& program) {
  StyleCounts c;
  for (const Word& w : program.words)
    if (w.letter == 'F' && !std::isnan(w.value) && w.length > w.value_at) c.add(number_of(program, w), w.value);
  NumberStyle style = style_of(program);
  style.padded_decimals = 0;
  c.say_of_numbers(style);
  return style;
}

namespace {

template <class Wanted>
int max_decimals(const Program& program, Wanted wanted) {
  int most = 0;
  for (const Word& w : program.words)
    if (wanted(w.letter) && !std::isnan(w.value)) most = std::max(most, decimals_of(number_of(program, w)));
  return most;
}

}  // namespace

int feed_decimals_of(const Program& program) {
  return max_decimals(program, [](char letter) { return letter == 'F'; });
}

int coordinate_decimals_of(const Program& program) {
  return max_decimals(program, [](char letter) { return letter >= 'X' && letter <= 'Z'; });
}

double rounded(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  double out = 0;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out == 0 ? 0 : out;
}

std::string format_number(double value, int decimals, const NumberStyle& style, std::string_view like) {
  const double r = rounded(value, decimals);
  std::string pointed(like);
  const bool comma = pointed.find(',') != std::string::npos || (style.comma && pointed.find('.') == std::string::npos);
  std::ranges::replace(pointed, ',', '.');
  like = pointed;
  std::string out = fmt::format("{:.{}f}", std::abs(r), decimals);
  if (out.find('.') == std::string::npos) out += '.';
  const std::size_t point = out.find('.');
  const std::size_t keep = point + 1 + static_cast<std::size_t>(style.padded_decimals);
  while (out.size() > keep && out.back() == '0') out.pop_back();
  if (out.size() < keep) out.append(keep - out.size(), '0');
  double old = 0;
  if (!like.empty()) std::from_chars(like.data() + (like.front() == '+'), like.data() + like.size(), old);
  if (out.back() == '.') {
    WholeStyle whole = style.whole;
    if (!like.empty() && (old != 0 || r == 0)) whole = whole_style(like, old).value_or(whole);
    if (whole == WholeStyle::plain) out.pop_back();
    if (whole == WholeStyle::point_zero) out += '0';
  }
  const bool zero = like.empty() ? style.leading_zero : has_leading_zero(like, old).value_or(style.leading_zero);
  if (!zero && r != 0 && std::abs(r) < 1) out.erase(0, 1);
  if (comma) std::ranges::replace(out, '.', ',');
  if (r < 0) return "-" + out;
  const bool plus = like.empty() || like.front() == '-' ? style.plus : like.front() == '+';
  return plus ? "+" + out : out;
}

}  // namespace camber::nc
