#include "machine/quantity.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/numbers.h"
#include "base/units.h"

namespace camber::machine {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};
constexpr std::array kLengths{Unit{"mm", 1},
                              Unit{"cm", 10},
                              Unit{"dm", 100},
                              Unit{"m", 1000},
                              Unit{"um", 1e-3},
                              Unit{"\u00b5m", 1e-3},
                              Unit{"\u03bcm", 1e-3},
                              Unit{"nm", 1e-6},
                              Unit{"in", kMmPerInch},
                              Unit{"\"", kMmPerInch},
                              Unit{"\u2033", kMmPerInch},
                              Unit{"inch", kMmPerInch},
                              Unit{"ft", 12 * kMmPerInch},
                              Unit{"'", 12 * kMmPerInch},
                              Unit{"thou", kMmPerInch / 1000},
                              Unit{"mil", kMmPerInch / 1000}};
constexpr std::array kAngles{Unit{"\u00b0", 1.0}, Unit{"deg", 1.0}, Unit{"rad", 180 / kPi}};

void skip_blanks(std::string_view& text) {
  for (;;) {
    if (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
      text.remove_prefix(1);
    else if (text.starts_with("\u00a0") || text.starts_with("\u202f"))  // no-break spaces
      text.remove_prefix(text.front() == '\xc2' ? 2 : 3);
    else
      return;
  }
}

/// The decimal sign is the last of the points and commas; others stand between thousands.
std::optional<double> number_of(std::string_view word) {
  const std::size_t sign = word.find_last_of(".,");
  std::string plain;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (i == sign)
      plain += '.';
    else if (word[i] != '.' && word[i] != ',')
      plain += word[i];
  return parse_number(plain);
}

/// "5.0", "-1e-3", "1/4".
std::optional<double> take_number(std::string_view& text) {
  const auto digits = [&] { return std::min(text.find_first_not_of("0123456789.,"), text.size()); };
  std::size_t end = 0;
  if (!text.empty() && (text.front() == '+' || text.front() == '-')) ++end;
  end = std::min(text.find_first_not_of("0123456789.,", end), text.size());
  if (end + 1 < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t exponent = text.find_first_not_of("0123456789", end + 2);
    if (text[end + 1] == '-' || text[end + 1] == '+' || (text[end + 1] >= '0' && text[end + 1] <= '9'))
      end = std::min(exponent, text.size());
  }
  const auto value = number_of(text.substr(0, end));
  text.remove_prefix(end);
  if (!value || !text.starts_with('/')) return value;
  text.remove_prefix(1);
  const auto below = number_of(text.substr(0, digits()));
  text.remove_prefix(digits());
  return below && *below != 0 ? std::optional(*value / *below) : std::nullopt;
}

template <class Units>
std::optional<double> take_unit(std::string_view& text, const Units& units) {
  const Unit* best = nullptr;
  for (const Unit& unit : units)
    if (text.starts_with(unit.name) && (!best || unit.name.size() > best->name.size())) best = &unit;
  if (!best) return std::nullopt;
  text.remove_prefix(best->name.size());
  return best->factor;
}

/// The sum of numbers with their units: 1' 2 1/2" has three numbers and two units.
template <class Units>
std::optional<double> quantity(std::string_view text, const Units& units) {
  double sum = 0, waiting = 0;  // waiting: numbers before their unit
  bool any = false, unit_due = false, unit_seen = false;
  for (skip_blanks(text); !text.empty(); skip_blanks(text)) {
    if (any && text.starts_with('+')) text.remove_prefix(1), skip_blanks(text);
    if (const auto factor = take_unit(text, units)) {
      if (!unit_due) return std::nullopt;
      sum += waiting * *factor;
      waiting = 0;
      unit_due = false;
      unit_seen = true;
      continue;
    }
    const std::string_view before = text;
    const auto value = take_number(text);
    if (!value || text.size() == before.size()) return std::nullopt;
    waiting += *value;
    any = unit_due = true;
  }
  if (!any || (unit_due && unit_seen)) return std::nullopt;
  return sum + waiting;
}

}  // namespace

std::optional<double> length_mm_of(std::string_view text) { return quantity(text, kLengths); }

std::optional<double> angle_deg_of(std::string_view text) { return quantity(text, kAngles); }

}  // namespace camber::machine
