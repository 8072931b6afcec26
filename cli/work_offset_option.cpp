#include "cli/work_offset_option.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/numbers.h"
#include "base/units.h"
#include "nc/offsets.h"

namespace camber::cli {
namespace {

struct GivenOffset {
  int number = 54;
  Vec3 linear_mm = Vec3::Zero(), rotary_deg = Vec3::Zero();
};

/// G54=100,50,-300 or G54=100,50,-300,0,0,90.
std::optional<GivenOffset> parse_work_offset(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos) return std::nullopt;
  const auto number = nc::work_offset_number(text.substr(0, at));
  std::vector<double> values;
  for (std::size_t from = at + 1; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const auto value = parse_number(text.substr(from, to - from));
    if (!value) return std::nullopt;
    values.push_back(*value);
    from = to + 1;
  }
  if (!number || (values.size() != 3 && values.size() != 6)) return std::nullopt;
  GivenOffset out{.number = *number, .linear_mm = {values[0], values[1], values[2]}};
  if (values.size() == 6) out.rotary_deg = {values[3], values[4], values[5]};
  return out;
}

}  // namespace

void add_work_offsets(CLI::App& command, nc::InterpreterOptions& interpreter) {
  command
      .add_option_function<std::vector<std::string>>(
          "--work-offset",
          [&interpreter](const std::vector<std::string>& given) {
            for (const std::string& text : given)
              if (const auto offset = parse_work_offset(text)) {
                interpreter.work_offsets_mm[offset->number] = offset->linear_mm;
                interpreter.rotary_offsets_rad[offset->number] = offset->rotary_deg * rad_from_deg(1);
              }
          },
          "machine coordinates of a work offset, mm and degrees; for the positions of the axes")
      ->check(CLI::Validator(
          [](std::string& text) {
            return parse_work_offset(text) ? std::string()
                                           : text +
                                                 ": a work offset and its machine coordinates were expected, such "
                                                 "as G54=100,50,-300 (A,B,C in degrees may follow)";
          },
          ""))
      ->expected(1)
      ->take_all()
      ->type_name("G54=X,Y,Z[,A,B,C]");
}

}  // namespace camber::cli
