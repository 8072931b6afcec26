#include "feedmodel/segment_motion.h"

#include <algorithm>
#include <cmath>

namespace camber::feedmodel {
namespace {

/// Beyond this fraction of its time a delay would reverse the motion; the whole phase is slowed instead.
constexpr double kMaxDelay = 2.0 / 3.0;

double distance_along(const SegmentMotion& m, double t_s) {
  const Trapezoid& p = m.along;
  const double accelerate_s = p.accelerate_s + m.accelerate_extra_s, brake_s = p.brake_s + m.brake_extra_s;
  if (t_s < accelerate_s) return p.distance_at(planned_time(t_s, p.accelerate_s, m.accelerate_extra_s));
  if (t_s < accelerate_s + p.cruise_s) return p.distance_at(t_s - m.accelerate_extra_s);
  const double into_brake = std::min(t_s, m.duration_s) - (m.duration_s - brake_s);
  return p.distance_at(p.accelerate_s + p.cruise_s + planned_time(into_brake, p.brake_s, m.brake_extra_s));
}

/// The ramp as it is; where the segment ends in a stop, its last T1 + T2 (all of it, if it is shorter) are run ever
/// slower, so that the stop takes the T1 + T2 more that eqs. 4-5 have for it.
double distance_exponential(const SegmentMotion& m, double t_s, double length_mm) {
  if (t_s >= m.duration_s) return length_mm;
  const double extra_s = m.duration_s - m.ramp_s, slowed_s = std::min(m.ramp_s, extra_s);
  const double before_s = m.ramp_s - slowed_s;
  if (t_s <= before_s || slowed_s <= 0) return std::min(length_mm, m.ramp.distance_at(std::min(t_s, m.ramp_s)));
  const double left = 1.0 - (t_s - before_s) / (slowed_s + extra_s);
  const double t = before_s + slowed_s * (1.0 - std::pow(left, (slowed_s + extra_s) / slowed_s));
  return std::min(length_mm, m.ramp.distance_at(t));
}

}  // namespace

double planned_time(double t_s, double plain_s, double extra_s) {
  if (t_s <= 0) return 0;
  const double whole_s = plain_s + extra_s;
  if (t_s >= whole_s) return plain_s;
  const double x = t_s / whole_s, fraction = extra_s / whole_s;
  if (fraction > kMaxDelay) return plain_s * x;
  return whole_s * (x - fraction * x * x * (3 - 2 * x));
}

double SegmentMotion::distance_at(const Segment& segment, double t_s) const {
  switch (kind) {
    case Kind::along_path:
      return t_s >= duration_s ? segment.length_mm : distance_along(*this, std::max(0.0, t_s));
    case Kind::overlapping:
      return t_s >= duration_s ? segment.length_mm : along.distance_at(std::max(0.0, t_s) * time_scale);
    case Kind::exponential:
      return distance_exponential(*this, std::max(0.0, t_s), segment.length_mm);
    case Kind::axes_apart:
    case Kind::rest:
      break;
  }
  return 0;
}

Vec3 SegmentMotion::point_at(const Segment& segment, double t_s) const {
  switch (kind) {
    case Kind::along_path:
    case Kind::overlapping:
    case Kind::exponential:
      return segment.point_at(distance_at(segment, t_s));
    case Kind::axes_apart: {
      const double t = planned_time(t_s, axes_s, duration_s - axes_s);
      Vec3 point = segment.start_mm;
      for (int i = 0; i < 3; ++i) point[i] += std::copysign(axes[i].distance_at(t), segment.way_mm[i]);
      return t_s >= duration_s ? Vec3(segment.start_mm + segment.way_mm) : point;
    }
    case Kind::rest:
      break;
  }
  return segment.start_mm;
}

ProgramPose SegmentMotion::pose_at(const Segment& segment, double t_s) const {
  if (kind == Kind::axes_apart) return {point_at(segment, t_s), segment.turn->start_rad};
  return feedmodel::pose_at(segment, distance_at(segment, t_s));
}

SegmentMotion positioning_motion(const Segment& segment, double extra_s) {
  SegmentMotion m;
  m.kind = SegmentMotion::Kind::axes_apart;
  for (int i = 0; i < 3; ++i) {
    m.axes[i] = make_trapezoid(std::abs(segment.way_mm[i]), 0, 0, segment.axis_speed_mm_per_s[i],
                               segment.axis_acceleration_mm_per_s2[i]);
    m.axes_s = std::max(m.axes_s, m.axes[i].duration_s());
  }
  m.duration_s = m.axes_s + extra_s;
  return m;
}

}  // namespace camber::feedmodel
