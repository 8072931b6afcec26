#include "simulate/force_regions.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/diagnostics.h"
#include "base/numbers.h"

namespace camber::simulate {

bool ForceRegions::meet(const Vec3& min_mm, const Vec3& max_mm) const {
  return std::ranges::any_of(regions_, [&](const ForceRegion& r) {
    return (r.min_mm.array() <= max_mm.array()).all() && (r.max_mm.array() >= min_mm.array()).all();
  });
}

double ForceRegions::factor_at(const Vec3& p) const {
  for (auto r = regions_.rbegin(); r != regions_.rend(); ++r)
    if ((r->min_mm.array() <= p.array()).all() && (r->max_mm.array() >= p.array()).all()) return r->factor;
  return 1;
}

namespace {

constexpr std::array<std::string_view, 7> kRegionColumns{"x_min", "y_min", "z_min", "x_max",
                                                         "y_max", "z_max", "factor"};
constexpr std::string_view kRegionHeader = "x_min,y_min,z_min,x_max,y_max,z_max,factor";

struct RegionCell {
  std::string_view text;
  std::size_t column;  ///< 1-based, of the line
};

std::vector<RegionCell> region_cells(std::string_view line) {
  std::vector<RegionCell> out;
  constexpr std::string_view kBlank = " \t\r";
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t end = std::min(line.find(',', from), line.size());
    const std::string_view cell = line.substr(from, end - from);
    const std::size_t begin = std::min(cell.find_first_not_of(kBlank), cell.size());
    const std::size_t last = cell.find_last_not_of(kBlank);
    out.push_back(
        {last == std::string_view::npos ? cell.substr(0, 0) : cell.substr(begin, last + 1 - begin), from + begin + 1});
    from = end + 1;
  }
  return out;
}

class RegionReader {
 public:
  explicit RegionReader(const std::string& path) : source_(SourceText::read(path)) {}

  ForceRegions read() {
    read_header();
    std::vector<ForceRegion> out;
    for (std::size_t line = 2; line <= source_.line_count(); ++line) {
      const auto cells = region_cells(source_.line(line));
      if (cells.size() == 1 && cells[0].text.empty()) continue;
      if (const auto region = read_row(line, cells)) out.push_back(*region);
    }
    diagnostics_.throw_if_errors();
    if (out.empty()) fail_on_file(source_.name(), "has no row below its header; a box was expected", "regions-empty");
    return ForceRegions(std::move(out));
  }

 private:
  void error(std::size_t line, std::size_t column, std::string message, const char* check) {
    diagnostics_.add(
        {Severity::error, {source_.name(), line, column}, std::move(message), check, std::string(source_.line(line))});
  }

  void read_header() {
    const auto names = region_cells(source_.line_count() > 0 ? source_.line(1) : std::string_view());
    for (std::size_t c = 0; c < kRegionColumns.size(); ++c)
      if (c >= names.size() || names[c].text != kRegionColumns[c]) {
        error(1, c < names.size() ? names[c].column : 1, fmt::format("the header {} was expected", kRegionHeader),
              "regions-column");
        break;
      }
    diagnostics_.throw_if_errors();
  }

  std::optional<ForceRegion> read_row(std::size_t line, const std::vector<RegionCell>& cells) {
    if (cells.size() != kRegionColumns.size()) {
      error(line, 1, fmt::format("the row has {} columns; {} were expected", cells.size(), kRegionColumns.size()),
            "regions-column");
      return std::nullopt;
    }
    std::array<double, kRegionColumns.size()> v{};
    for (std::size_t c = 0; c < v.size(); ++c) {
      const auto number = parse_number(cells[c].text);
      if (!number) {
        error(line, cells[c].column,
              fmt::format("{} is \"{}\"; a number was expected", kRegionColumns[c], cells[c].text), "regions-number");
        return std::nullopt;
      }
      v[c] = *number;
    }
    for (std::size_t a = 0; a < 3; ++a)
      if (!(v[a] < v[a + 3]))
        error(line, cells[a + 3].column,
              fmt::format("{} is {}, {} is {}; the second must be greater", kRegionColumns[a], cells[a].text,
                          kRegionColumns[a + 3], cells[a + 3].text),
              "regions-box");
    if (v[6] < ForceRegions::kLeastFactor || v[6] > ForceRegions::kGreatestFactor)
      error(line, cells[6].column,
            fmt::format("factor is {}; {} to {} was expected", cells[6].text, ForceRegions::kLeastFactor,
                        ForceRegions::kGreatestFactor),
            "regions-factor");
    return ForceRegion{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]};
  }

  SourceText source_;
  Diagnostics diagnostics_;
};

}  // namespace

ForceRegions read_force_regions(const std::string& path) { return RegionReader(path).read(); }

}  // namespace camber::simulate
