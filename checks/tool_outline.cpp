#include "checks/tool_outline.h"

#include <algorithm>
#include <cmath>

namespace camber::checks {
namespace {

using Part = OutlineRing::Part;

class Outline {
 public:
  Outline(double step_mm, double top_mm) : step_mm_(step_mm), top_mm_(top_mm) {}

  void add(Part part, double radius, double height) {
    if (height <= top_mm_ && radius >= 0) rings.push_back({part, radius, height});
  }
  /// A line of the profile; its ends are met.
  void line(Part part, double r0, double z0, double r1, double z1) {
    if (z0 > top_mm_) return;
    const int n = std::max(1, static_cast<int>(std::ceil(std::hypot(r1 - r0, z1 - z0) / step_mm_)));
    for (int i = 0; i <= n; ++i) add(part, r0 + (r1 - r0) * i / n, z0 + (z1 - z0) * i / n);
  }
  std::vector<OutlineRing> rings;

 private:
  double step_mm_, top_mm_;
};

}  // namespace

double cutter_end_mm(const machine::Tool& tool) { return tool.flute_length_mm.value_or(tool.overhang_mm); }

std::vector<OutlineRing> tool_outline(const machine::Tool& tool, double step, double top) {
  Outline out(step, top);
  const removal::Profile profile(machine::parameters_of(tool));
  const double end = cutter_end_mm(tool);
  const double length = profile.length_to_height_mm(std::min(end, top));
  const int n = std::max(1, static_cast<int>(std::ceil(length / step)));
  for (int i = 0; i <= n; ++i) {
    const auto p = profile.at(length * i / n);
    out.add(Part::cutter, p.radius_mm, p.height_mm);
  }
  double radius = profile.at(profile.length_to_height_mm(end)).radius_mm, height = end;
  const auto cylinder = [&](Part part, double lower, double upper, double to) {
    if (to <= height + 1e-9) return;
    // The face between the part below and this one; a narrower part has none that could touch.
    if (lower > radius) out.line(part, radius, height, lower, height);
    out.line(part, lower, height, upper, to);
    radius = upper;
    height = to;
  };
  if (tool.neck_length_mm > 0)
    cylinder(Part::shank, tool.neck_diameter_mm / 2, tool.neck_diameter_mm / 2, end + tool.neck_length_mm);
  const double shank = (tool.shank_diameter_mm > 0 ? tool.shank_diameter_mm : tool.diameter_mm) / 2;
  cylinder(Part::shank, shank, shank, tool.overhang_mm);
  for (const auto& h : tool.holder)
    cylinder(Part::holder, h.lower_diameter_mm / 2, h.upper_diameter_mm / 2, height + h.length_mm);
  return std::move(out.rings);
}

std::size_t level_stretch_end(const machine::Tool& tool, const removal::StampPath& path, const removal::ToolRun& run,
                              std::size_t from) {
  constexpr std::size_t kMax = 10000;
  const double range = 0.5 * cutter_end_mm(tool);
  double lo = path.stamps[from].pose.tip_mm.z(), hi = lo;
  std::size_t to = from + 1;
  for (; to < std::min(run.from + run.count, from + kMax); ++to) {
    lo = std::min(lo, path.stamps[to].pose.tip_mm.z());
    hi = std::max(hi, path.stamps[to].pose.tip_mm.z());
    if (hi - lo > range) break;
  }
  return to;
}

}  // namespace camber::checks
