#include "nc/frames.h"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace camber::nc {
namespace {

constexpr double kSameScale = 1e-9;  ///< scales are written with five decimals or so

/// The arc under the linear map; nothing where it does not stay a circle. The normal keeps to the positive axis where
/// it lies along one.
std::optional<Arc> mapped(const Eigen::Matrix3d& linear, const Vec3& centre_mm, const Arc& arc) {
  const Vec3 u = arc.normal.unitOrthogonal(), v = arc.normal.cross(u);
  const Vec3 a = linear * u, b = linear * v, n = a.cross(b).normalized();
  if (std::abs(a.norm() - b.norm()) > kSameScale || std::abs(a.dot(b)) > kSameScale) return std::nullopt;
  if ((linear * arc.normal).normalized().cross(n).norm() > kSameScale) return std::nullopt;
  Arc out = arc;
  out.center_mm = centre_mm;
  Eigen::Index axis = 0;
  n.cwiseAbs().maxCoeff(&axis);
  const double sign = n[axis] < 0 ? -1.0 : 1.0;
  out.normal = sign * n;
  if (1 - std::abs(n[axis]) < 1e-14) out.normal = Vec3::Unit(axis);
  out.sweep_rad = sign * arc.sweep_rad;
  return out;
}

}  // namespace

Eigen::Matrix3d rotation_in(Plane plane, double angle_rad) {
  const PlaneAxes axes = axes_of(plane);
  // Quarter turns exactly, as programs mostly have them.
  const double quarters = angle_rad / (kPi / 2), whole = std::round(quarters);
  double c = std::cos(angle_rad), s = std::sin(angle_rad);
  if (std::abs(quarters - whole) < 1e-12) {
    const int q = (static_cast<int>(std::fmod(whole, 4)) + 4) % 4;  // a program may write any angle
    c = q == 0 ? 1 : q == 2 ? -1 : 0;
    s = q == 1 ? 1 : q == 3 ? -1 : 0;
  }
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  m(axes.first, axes.first) = m(axes.second, axes.second) = c;
  m(axes.first, axes.second) = -s;
  m(axes.second, axes.first) = s;
  return m;
}

Eigen::Matrix3d euler_zxz(const Vec3& angles_rad) {
  return rotation_in(Plane::xy, angles_rad.x()) * rotation_in(Plane::yz, angles_rad.y()) *
         rotation_in(Plane::xy, angles_rad.z());
}

Vec3 Frames::in_work_mm(const Vec3& programmed_mm) const {
  Vec3 p = programmed_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (const auto& at = mirror_at_mm[static_cast<std::size_t>(axis)]) p[axis] = 2 * *at - p[axis];
  p = scale_centre_mm + scale.cwiseProduct(p - scale_centre_mm);
  if (rotated) p = rotation_centre_mm + rotation_in(rotation_plane, rotation_rad) * (p - rotation_centre_mm);
  return p;
}

Eigen::Matrix3d Frames::offset_rotation(int work_offset) const {
  const double angle = offsets.rotation_rad(work_offset);
  return angle == 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : rotation_in(Plane::xy, angle);
}

Frame Frames::frame(int work_offset, bool first) {
  Eigen::Matrix3d in_work = Eigen::Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis)
    if (mirror_at_mm[static_cast<std::size_t>(axis)]) in_work(axis, axis) = -1;
  in_work = scale.asDiagonal() * in_work;
  if (rotated) in_work = rotation_in(rotation_plane, rotation_rad) * in_work;
  const Eigen::Matrix3d turn = offset_rotation(work_offset);
  Vec3 zero_mm = in_work_mm(Vec3::Zero());
  if (tilt) {
    in_work = tilt->rotation * in_work;
    zero_mm = tilt->rotation * zero_mm + tilt->origin_mm;
  }
  Frame frame;
  frame.linear = turn * in_work;
  frame.origin_mm = offsets.origin_mm(work_offset, first);
  frame.shift_mm = frame.origin_mm + turn * (zero_mm + g52_mm + g92_mm);
  frame.polar = polar;
  frame.shift_only = frame.linear == Eigen::Matrix3d::Identity();
  frame.plain = frame.shift_only && frame.shift_mm == Vec3::Zero();
  if (!frame.shift_only) frame.inverse = frame.linear.inverse();
  return frame;
}

std::optional<Arc> from_program(const Frame& frame, const Arc& arc) {
  if (frame.shift_only) {
    Arc out = arc;
    out.center_mm += frame.shift_mm;
    return out;
  }
  return mapped(frame.linear, frame.from_program(arc.center_mm), arc);
}

Arc to_program(const Frame& frame, const Arc& arc) {
  return mapped(frame.inverse, frame.to_program(arc.center_mm), arc).value_or(arc);
}

}  // namespace camber::nc
