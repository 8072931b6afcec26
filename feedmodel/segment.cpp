#include "feedmodel/segment.h"

#include <cmath>

#include <Eigen/Geometry>

namespace camber::feedmodel {

ProgramPose pose_at(const Segment& segment, double s) {
  const Turn& turn = *segment.turn;
  return {segment.point_at(s) + turn.bend_mm * (s * s), turn.start_rad + turn.rate * s + turn.bend * (s * s)};
}

double Segment::in_plane() const {
  return radius_growth == 0 ? radius_mm * turn_rad_per_mm : std::sqrt(1 - rise.squaredNorm());
}

Vec3 Segment::point_at(double s_mm) const {
  if (radius_mm == 0) return start_mm + along * s_mm;
  const double phi = turn_rad_per_mm * s_mm;
  const Vec3 turned = (std::cos(phi) - 1.0) * along + std::sin(phi) * across;
  return start_mm + radius_mm * turned + radius_growth * s_mm * (turned + along) + rise * s_mm;
}

Vec3 Segment::direction_at(double s_mm) const {
  if (radius_mm == 0) return along;
  const double phi = turn_rad_per_mm * s_mm;
  return in_plane() * (std::cos(phi) * across - std::sin(phi) * along) + rise;
}

Segment line_segment(const Vec3& from_mm, const Vec3& to_mm) {
  Segment s;
  s.start_mm = from_mm;
  s.length_mm = (to_mm - from_mm).norm();
  if (s.length_mm > 0) s.along = (to_mm - from_mm) / s.length_mm;
  return s;
}

Segment arc_segment(const Vec3& from_mm, const Vec3& center_mm, const Vec3& normal, double sweep_rad, double rise_mm,
                    double growth_mm) {
  constexpr double kNoGrowth_mm = 1e-9;
  if (std::abs(growth_mm) < kNoGrowth_mm) growth_mm = 0;
  Segment s;
  s.start_mm = from_mm;
  Vec3 spoke = from_mm - center_mm;
  spoke -= normal * normal.dot(spoke);
  s.radius_mm = spoke.norm();
  s.length_mm = std::hypot((s.radius_mm + growth_mm / 2) * sweep_rad, rise_mm);
  if (s.length_mm == 0) return s;
  s.radius_growth = growth_mm / s.length_mm;
  s.along = spoke / s.radius_mm;
  s.across = normal.cross(s.along) * (sweep_rad < 0 ? -1.0 : 1.0);
  s.turn_rad_per_mm = std::abs(sweep_rad) / s.length_mm;
  s.rise = normal * (rise_mm / s.length_mm);
  return s;
}

Segment part_of(const Segment& segment, double from_s_mm, double to_s_mm) {
  Segment part = segment;
  part.start_mm = segment.point_at(from_s_mm);
  part.length_mm = to_s_mm - from_s_mm;
  if (segment.radius_mm > 0) {
    const double phi = segment.turn_rad_per_mm * from_s_mm;
    part.along = std::cos(phi) * segment.along + std::sin(phi) * segment.across;
    part.across = std::cos(phi) * segment.across - std::sin(phi) * segment.along;
    part.radius_mm += segment.radius_growth * from_s_mm;
  }
  if (segment.turn) {
    Turn turn = *segment.turn;
    part.start_mm = pose_at(segment, from_s_mm).xyz_mm;
    turn.start_rad = pose_at(segment, from_s_mm).rotary_rad;
    turn.rate += 2 * from_s_mm * turn.bend;
    if (segment.radius_mm == 0) part.along += 2 * from_s_mm * turn.bend_mm;
    part.turn = std::make_shared<const Turn>(turn);
  }
  return part;
}

}  // namespace camber::feedmodel
