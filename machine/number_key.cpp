#include "machine/number_key.h"

#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"

namespace camber::machine {

std::string toml_number(double inside, const FileUnit& unit) {
  if (std::isinf(inside)) return inside > 0 ? "inf" : "-inf";
  const double value = unit.file_from_inside(inside);
  for (int digits = 1; digits <= 17; ++digits) {
    const std::string text = fmt::format("{:.{}g}", value, digits);
    const auto back = parse_number(text);
    if (back && unit.inside_from_file(*back) == inside) return fmt::format("{}", *back);
  }
  return fmt::format("{:.15g}", value);
}

std::string toml_line(std::string_view key, double inside, const FileUnit& unit) {
  return fmt::format("{} = {}\n", key, toml_number(inside, unit));
}

std::string toml_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04X}", static_cast<int>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string toml_line(std::string_view key, std::string_view text) {
  return fmt::format("{} = {}\n", key, toml_text(text));
}

}  // namespace camber::machine
