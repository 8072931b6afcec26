#pragma once
// Straight rows of stamps and simple tools, for tests that need no program.
#include <vector>

#include "machine/tool.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::testing {

inline machine::Tool make_tool(machine::ToolType type, double diameter_mm, int flutes, double helix_deg) {
  machine::Tool tool;
  tool.number = 1;
  tool.type = type;
  tool.diameter_mm = diameter_mm;
  tool.flutes = flutes;
  tool.helix_rad = helix_deg * kPi / 180;
  tool.overhang_mm = 40;
  return tool;
}

/// Appends stamps from one point to another, feed_mm apart.
inline void add_row(std::vector<removal::Stamp>& stamps, const Vec3& from, const Vec3& to, double feed_mm) {
  const Vec3 step = (to - from).normalized() * feed_mm;
  const int n = static_cast<int>((to - from).norm() / feed_mm);
  for (int i = 0; i <= n; ++i) {
    removal::Stamp s;
    s.pose.tip_mm = from + i * step;
    s.feed_per_tooth_mm = step;
    s.first = i == 0;
    stamps.push_back(s);
  }
}

inline removal::Stock make_box(const Vec3& lo, const Vec3& hi, double voxel_mm) {
  return {[=](const Vec3& p) { return removal::box_distance_mm(p, lo, hi); }, lo, hi, voxel_mm, 4};
}

}  // namespace camber::testing
