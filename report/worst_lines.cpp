#include "report/page_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

namespace camber::report {
namespace {

constexpr std::size_t kShown = 10;
constexpr double kLeastArea = 1e-3;  // of the whole
constexpr std::size_t kLongestLine = 60;

struct LineError {
  double area_mm2 = 0, squares = 0, greatest_um = 0;
  double rms_um() const { return area_mm2 > 0 ? std::sqrt(squares / area_mm2) : 0; }
};

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    out.push_back(line.substr(0, kLongestLine));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  return out;
}

}  // namespace

TextTable worst_lines_table(const SurfaceSamples& surface, std::string_view program_text, bool after) {
  std::map<std::uint32_t, LineError> lines;
  double area_mm2 = 0;
  for (const SurfaceSample& s : surface.all()) {
    const std::uint32_t line = after ? s.block_after : s.block;
    if (line == 0 || s.area_mm2 <= 0) continue;
    const double error_um = after ? s.error_after_um : s.error_um;
    LineError& l = lines[line];
    l.area_mm2 += s.area_mm2;
    l.squares += s.area_mm2 * error_um * error_um;
    if (std::abs(error_um) > std::abs(l.greatest_um)) l.greatest_um = error_um;
    area_mm2 += s.area_mm2;
  }
  std::vector<std::pair<std::uint32_t, LineError>> worst(lines.begin(), lines.end());
  std::erase_if(worst, [&](const auto& l) { return l.second.area_mm2 < kLeastArea * area_mm2; });
  std::ranges::stable_sort(worst, std::greater(), [](const auto& l) { return l.second.rms_um(); });
  if (worst.size() > kShown) worst.resize(kShown);
  TextTable table{after ? "Worst lines of the emitted program" : "Worst lines",
                  {"line", "block", "rms, µm", "greatest, µm", "surface, mm²"},
                  {},
                  {}};
  const auto text = lines_of(program_text);
  for (const auto& [line, l] : worst)
    table.rows.push_back({std::to_string(line), line <= text.size() ? std::string(text[line - 1]) : std::string(),
                          number_text(l.rms_um(), 2), number_text(l.greatest_um, 2), number_text(l.area_mm2, 2)});
  return table;
}

}  // namespace camber::report
