#include "repath/raster_text.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

namespace camber::repath {
namespace {

constexpr double kLeadInFraction = 1.0 / 3;  ///< of the feed

/// With a point always: 12. and not 12, which some controls take for increments; the zeros behind are left out.
std::string number(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  while (out.back() == '0') out.pop_back();
  return out == "-0." ? "0." : out;
}

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

std::string header(const RasterProgram& p) {
  std::string out = "%\n";
  if (p.dialect.has_program_number) out += "O0001 (FINISHING RASTER)\n";
  out += "G21 G17 G90 G94 G40 G49 G80\n";
  out += fmt::format("T{} M6 ({} D{:g}", p.tool.number, type_word(p.tool.type), p.tool.diameter_mm);
  if (p.tool.type == machine::ToolType::bull) out += fmt::format(" R{:g}", p.tool.corner_radius_mm);
  out += fmt::format(")\nG54 S{:.0f} M3\n", p.spindle_rpm);
  out += fmt::format("G43 H{} G0 Z{}\n", p.tool.number, number(p.clearance_mm, p.decimals));
  return out;
}

}  // namespace

std::string raster_text(const RasterProgram& p, std::span<const std::vector<Vec3>> chains) {
  assert(std::ranges::all_of(chains, [](const auto& chain) { return chain.size() >= 2; }));
  std::string out = header(p);
  const std::string feed = number(p.feed_mm_per_min, 1), slow = number(kLeadInFraction * p.feed_mm_per_min, 1);
  const auto word = [&](char axis, double value) { return axis + number(value, p.decimals); };
  for (const auto& chain : chains) {
    const Vec3& start = chain.front();
    out += fmt::format("G0 {} {}\n", word('X', start.x()), word('Y', start.y()));
    const double from = std::min(p.clearance_mm, std::max(start.z() + p.lead_in_mm, p.lead_in_from_mm));
    if (from < p.clearance_mm) out += word('Z', from) + "\n";
    out += fmt::format("G1 {} F{}\n", word('Z', start.z()), slow);
    for (std::size_t k = 1; k < chain.size(); ++k) {
      std::string block;
      for (int a = 0; a < 3; ++a) {
        const std::string now = word("XYZ"[a], chain[k][a]);
        if (now == word("XYZ"[a], chain[k - 1][a])) continue;
        block += (block.empty() ? "" : " ") + now;
      }
      if (block.empty()) continue;
      out += block + (k == 1 ? " F" + feed : "") + "\n";
    }
    out += fmt::format("G0 {}\n", word('Z', p.clearance_mm));
  }
  return out + "M5\nM30\n%\n";
}

}  // namespace camber::repath
