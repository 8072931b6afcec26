#include "machine/cutter_parameters.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::machine {
namespace {

/// Rounding of input: a tangent may miss its arc by this.
constexpr double kTouch_mm = 1e-6;
constexpr double kAngle_rad = 1e-4;

double normal_angle(const CutterParameters& p, const Vec2& point) {
  return std::atan2(point.x() - p.corner_centre_r_mm, p.corner_centre_z_mm - point.y());
}

/// Where the line from `from` along the unit vector `along` meets the corner's circle: the first or the last of the two
/// points on its way; nothing where it misses it.
std::optional<Vec2> meet_circle(const CutterParameters& p, const Vec2& from, const Vec2& along, bool last) {
  const Vec2 centre(p.corner_centre_r_mm, p.corner_centre_z_mm);
  const double middle = (centre - from).dot(along);
  const double miss = std::abs(along.x() * (centre - from).y() - along.y() * (centre - from).x());
  if (miss > p.corner_radius_mm + kTouch_mm) return std::nullopt;
  // A tangent to within rounding is a tangent.
  if (miss > p.corner_radius_mm - kTouch_mm * 1e-3) return from + middle * along;
  const double half = std::sqrt(p.corner_radius_mm * p.corner_radius_mm - miss * miss);
  return from + (middle + (last ? half : -half)) * along;
}

std::optional<Vec2> meet_bottom(const CutterParameters& p) {
  return meet_circle(p, Vec2::Zero(), {std::cos(p.bottom_angle_rad), std::sin(p.bottom_angle_rad)}, true);
}
std::optional<Vec2> meet_wall(const CutterParameters& p) {
  const double u = p.diameter_mm / 2 * (1 - std::tan(p.bottom_angle_rad) * std::tan(p.taper_rad));
  return meet_circle(p, {u, 0}, {std::sin(p.taper_rad), std::cos(p.taper_rad)}, false);
}

CutterParameters cone(double tip_diameter, double diameter, double point_angle) {
  CutterParameters p;
  p.diameter_mm = tip_diameter;
  p.taper_rad = point_angle / 2;
  p.height_mm = (diameter - tip_diameter) / 2 / std::tan(point_angle / 2);
  return p;
}

}  // namespace

CutterParameters parameters_of(const Tool& tool) {
  CutterParameters p;
  p.diameter_mm = tool.diameter_mm;
  p.height_mm = tool.flute_length_mm.value_or(tool.overhang_mm);
  const double radius = tool.diameter_mm / 2;
  switch (tool.type) {
    case ToolType::flat:
      break;
    case ToolType::ball:
      p.corner_radius_mm = p.corner_centre_z_mm = radius;
      break;
    case ToolType::bull:
      p.corner_radius_mm = p.corner_centre_z_mm = tool.corner_radius_mm;
      p.corner_centre_r_mm = radius - tool.corner_radius_mm;
      break;
    case ToolType::tapered_ball:
      // The wall touches the ball: u = r (1 - sin b) / cos b.
      p.corner_radius_mm = p.corner_centre_z_mm = radius;
      p.taper_rad = tool.taper_rad;
      p.diameter_mm = tool.diameter_mm * (1 - std::sin(tool.taper_rad)) / std::cos(tool.taper_rad);
      break;
    case ToolType::chamfer:
      return cone(tool.tip_diameter_mm, tool.diameter_mm, tool.point_angle_rad);
    case ToolType::drill:
      return cone(0, tool.diameter_mm, tool.point_angle_rad);
    case ToolType::general:
      p.corner_radius_mm = tool.corner_radius_mm;
      p.corner_centre_r_mm = tool.corner_centre_r_mm;
      p.corner_centre_z_mm = tool.corner_centre_z_mm;
      p.bottom_angle_rad = tool.bottom_angle_rad;
      p.taper_rad = tool.taper_rad;
      break;
  }
  return p;
}

std::string profile_fault(const CutterParameters& p) {
  const double steepest = kPi / 2 - p.taper_rad;
  if (p.bottom_angle_rad > steepest + kAngle_rad)
    return fmt::format("the bottom rises more steeply ({:g} deg) than the wall ({:g} deg)",
                       deg_from_rad(p.bottom_angle_rad), deg_from_rad(steepest));
  double corner_top = p.diameter_mm / 2 * std::tan(p.bottom_angle_rad);
  if (p.corner_radius_mm > 0) {
    const auto m = meet_bottom(p), n = meet_wall(p);
    if (!m) return "the corner's arc does not reach the bottom";
    if (!n) return "the corner's arc does not reach the wall";
    if (m->x() < -kTouch_mm) return "the corner's arc meets the bottom behind the axis";
    const double k0 = normal_angle(p, *m), k1 = normal_angle(p, *n);
    if (k0 < p.bottom_angle_rad - kAngle_rad || k1 < k0 - kAngle_rad || k1 > steepest + kAngle_rad)
      return "bottom, corner and wall do not follow each other upwards, each steeper than the one before";
    corner_top = n->y();
  }
  if (p.taper_rad > 0 && p.height_mm < corner_top - kTouch_mm)
    return fmt::format("the flutes end {:g} mm above the tip, below the corner's upper end at {:.4g} mm", p.height_mm,
                       corner_top);
  return {};
}

CornerEnds corner_ends(const CutterParameters& p) {
  assert(profile_fault(p).empty());
  CornerEnds ends;
  if (p.corner_radius_mm > 0) {
    ends.bottom = meet_bottom(p).value().cwiseMax(0.0);
    ends.wall = meet_wall(p).value();
    ends.bottom_normal_rad = std::max(normal_angle(p, ends.bottom), p.bottom_angle_rad);
    ends.wall_normal_rad = std::min(normal_angle(p, ends.wall), kPi / 2 - p.taper_rad);
  } else {
    ends.bottom = ends.wall = {p.diameter_mm / 2, p.diameter_mm / 2 * std::tan(p.bottom_angle_rad)};
  }
  return ends;
}

}  // namespace camber::machine
