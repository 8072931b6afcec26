#include "repath/raster/raster.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "nc/write/program_writer.h"

namespace camber::repath {
namespace {

constexpr double kLeadInFraction = 1.0 / 3;  ///< of the feed

std::string_view type_word(machine::ToolType type) {
  switch (type) {
    case machine::ToolType::ball:
      return "BALL";
    case machine::ToolType::flat:
      return "FLAT";
    default:
      return "BULL NOSE";
  }
}

std::string tool_text(const machine::Tool& tool) {
  std::string out = fmt::format("{} D{:g}", type_word(tool.type), tool.diameter_mm);
  if (tool.type == machine::ToolType::bull) out += fmt::format(" R{:g}", tool.corner_radius_mm);
  return out;
}

}  // namespace

std::string raster_text(const RasterProgram& p, std::span<const std::vector<Vec3>> chains) {
  assert(std::ranges::all_of(chains, [](const auto& chain) { return chain.size() >= 2; }));
  const auto writer = nc::program_writer(p.dialect, {.title = "FINISHING RASTER", .decimals = p.decimals});
  writer->begin();
  writer->change_tool({.number = p.tool.number,
                       .comment = tool_text(p.tool),
                       .spindle_rpm = p.spindle_rpm,
                       .safe_z_mm = p.clearance_mm});
  const auto at_height = [](const Vec3& place, double z) { return Vec3(place.x(), place.y(), z); };
  for (const auto& chain : chains) {
    const Vec3& start = chain.front();
    writer->rapid(at_height(start, p.clearance_mm));
    writer->rapid(at_height(start, std::min(p.clearance_mm, std::max(start.z() + p.lead_in_mm, p.lead_in_from_mm))));
    writer->line(start, kLeadInFraction * p.feed_mm_per_min);
    for (std::size_t k = 1; k < chain.size(); ++k) writer->line(chain[k], p.feed_mm_per_min);
    writer->rapid(at_height(chain.back(), p.clearance_mm));
  }
  return nc::text_of(p.dialect, writer->finish());
}

}  // namespace camber::repath
