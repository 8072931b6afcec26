#include "feedmodel/limits.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/units.h"
#include "feedmodel/rapid.h"

namespace camber::feedmodel {
namespace {

[[maybe_unused]] constexpr double kUnitVector = 1e-6;  ///< rounding of its squared length

}  // namespace

double limit_along(const Vec3& direction, const Vec3& limits) {
  assert(direction.squaredNorm() <= 1 + kUnitVector && (limits.array() > 0).all());
  double slowest = 0;
  for (int i = 0; i < 3; ++i) slowest = std::max(slowest, std::abs(direction[i]) / limits[i]);
  return slowest > 0 ? 1.0 / slowest : machine::kNoLimit;
}

double limit_in_plane(const Vec3& normal, const Vec3& limits) {
  assert(std::abs(normal.squaredNorm() - 1) <= kUnitVector && (limits.array() > 0).all());
  double least = machine::kNoLimit;
  for (int i = 0; i < 3; ++i) {
    const double in_plane = std::sqrt(std::max(0.0, 1.0 - normal[i] * normal[i]));
    if (in_plane > 1e-6) least = std::min(least, limits[i] / in_plane);
  }
  return least;
}

Vec3 velocity_limits_mm_per_s(const machine::Machine& m) {
  Vec3 limits;
  for (int i = 0; i < 3; ++i) limits[i] = std::min(m.axis[i].max_velocity_mm_per_s, m.axis[i].max_feed_mm_per_s);
  return limits;
}

Vec3 acceleration_limits_mm_per_s2(const machine::Machine& m) {
  return {m.axis[0].acceleration_mm_per_s2, m.axis[1].acceleration_mm_per_s2, m.axis[2].acceleration_mm_per_s2};
}

double block_time_speed(double length_mm, double block_time_s) {
  return block_time_s > 0 ? length_mm / block_time_s : machine::kNoLimit;
}

double arc_speed(double radius_mm, double acceleration_mm_per_s2, double normal_fraction) {
  return std::sqrt(normal_fraction * acceleration_mm_per_s2 * radius_mm);
}

double arc_servo_speed(double radius_mm, double radius_error_mm, double gain_per_s, double feed_forward_percent,
                       double m) {
  const double kf = feed_forward_percent / 100.0;
  const double left = 1.0 - kf * kf;
  if (left <= 0 || std::isinf(gain_per_s)) return machine::kNoLimit;
  return gain_per_s * std::sqrt(m * radius_mm * radius_error_mm / left);
}

double helix_curvature_radius(double radius_mm, double rise_per_rad_mm) {
  const double slope = rise_per_rad_mm / radius_mm;
  return radius_mm * (1.0 + slope * slope);
}

namespace {

/// Fraction of a joint's acceleration that the curvature of its path may take.
constexpr double kTurningFraction = 0.75;
constexpr double kPieceRad = kPi / 180, kArcPieceRad = kPi / 36;
constexpr int kMaxPieces = 720;
/// Differences of joints over less than this (mm or degrees of path) lose their digits.
constexpr double kLeastStep = 1e-3;

AxisValues operator-(const AxisValues& a, const AxisValues& b) { return {a.linear - b.linear, a.rotary - b.rotary}; }
AxisValues operator*(const AxisValues& a, double f) { return {a.linear * f, a.rotary * f}; }

template <class Use>
void for_each_axis(const Use& use) {
  for (int i = 0; i < 3; ++i) {
    use([i](const AxisValues& v) { return v.linear[i]; });
    use([i](const AxisValues& v) { return v.rotary[i]; });
  }
}

AxisValues joints_at(const Segment& segment, double s, const kinematics::JointMap& map) {
  const kinematics::Joints q = joints_of(map, pose_at(segment, s), *segment.turn);
  return {q.linear_mm, q.rotary_rad};
}

/// First and second derivative of the joints over a piece.
struct Derivatives {
  AxisValues middle, second;
  double half = 0;
};

Derivatives derivatives(const Segment& segment, double from_s, double to_s, const kinematics::JointMap& map) {
  const double s = (from_s + to_s) / 2, h = std::max((to_s - from_s) / 2, kLeastStep);
  const AxisValues before = joints_at(segment, s - h, map), at = joints_at(segment, s, map),
                   after = joints_at(segment, s + h, map);
  return {(after - before) * (0.5 / h), ((after - at) - (at - before)) * (1 / (h * h)), (to_s - from_s) / 2};
}

void set_limits(Segment& piece, const Derivatives& d, const JointLimits& limits) {
  double speed = machine::kNoLimit;
  for_each_axis([&](const auto& of) {
    const double rate = std::abs(of(d.middle)) + d.half * std::abs(of(d.second)), bend = std::abs(of(d.second));
    if (rate > 0) speed = std::min(speed, of(limits.speed) / rate);
    if (bend > 0) speed = std::min(speed, std::sqrt(kTurningFraction * of(limits.acceleration) / bend));
  });
  piece.axis_limit_mm_per_s = speed;
  if (!piece.cutting) piece.feed_command_mm_per_s = std::min(piece.feed_command_mm_per_s, speed);
  piece.speed_limit_mm_per_s = std::min(piece.speed_limit_mm_per_s, speed);
  const double v = piece.speed_limit_mm_per_s;
  for_each_axis([&](const auto& of) {
    const double rate = std::abs(of(d.middle)) + d.half * std::abs(of(d.second)), bend = std::abs(of(d.second));
    const double limit = of(limits.acceleration);
    if (rate <= 0 || std::isinf(limit)) return;
    piece.acceleration_mm_per_s2 = std::min(piece.acceleration_mm_per_s2, (limit - bend * v * v) / rate);
  });
}

int pieces_of(const Segment& segment) {
  const Turn& turn = *segment.turn;
  const double length = segment.length_mm;
  const double turned = ((turn.rate.cwiseAbs() + length * turn.bend.cwiseAbs()) * length).maxCoeff();
  const double arc = segment.radius_mm > 0 ? segment.turn_rad_per_mm * length / kArcPieceRad : 0.0;
  return static_cast<int>(std::clamp(std::ceil(std::max(turned / kPieceRad, arc)), 1.0, double{kMaxPieces}));
}

}  // namespace

JointLimits feed_limits(const machine::Machine& machine) {
  JointLimits out;
  out.speed.linear = velocity_limits_mm_per_s(machine);
  out.acceleration.linear = acceleration_limits_mm_per_s2(machine);
  for (int i = 0; i < 3; ++i) {
    const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(i)];
    out.speed.rotary[i] = std::min(axis.max_velocity_rad_per_s, axis.max_feed_rad_per_s);
    out.acceleration.rotary[i] = axis.acceleration_rad_per_s2;
  }
  return out;
}

JointLimits rapid_limits(const machine::Machine& machine) {
  JointLimits out;
  out.speed.linear = rapid_speeds_mm_per_s(machine);
  out.acceleration.linear = rapid_accelerations_mm_per_s2(machine);
  const double override_fraction = machine.cycle.rapid_override_percent / 100.0;
  for (int i = 0; i < 3; ++i) {
    const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(i)];
    out.speed.rotary[i] = override_fraction * std::min(axis.max_velocity_rad_per_s, axis.rapid_rad_per_s);
    out.acceleration.rotary[i] = axis.acceleration_rad_per_s2;
  }
  return out;
}

double limit_along_joints(const AxisValues& rate, const AxisValues& limits) {
  double slowest = 0;
  for_each_axis([&](const auto& of) { slowest = std::max(slowest, std::abs(of(rate)) / of(limits)); });
  return slowest > 0 ? 1.0 / slowest : machine::kNoLimit;
}

AxisValues joint_rates(const Segment& segment, double s, const kinematics::JointMap& map) {
  return (joints_at(segment, s + kLeastStep, map) - joints_at(segment, s - kLeastStep, map)) * (0.5 / kLeastStep);
}

void hand_out_within_limits(const Segment& segment, const kinematics::JointMap& map, const JointLimits& limits,
                            const std::function<void(const Segment&)>& sink) {
  const int pieces = pieces_of(segment);
  for (int i = 0; i < pieces; ++i) {
    const double from_s = segment.length_mm * i / pieces, to_s = segment.length_mm * (i + 1) / pieces;
    Segment piece = pieces > 1 ? part_of(segment, from_s, to_s) : segment;
    set_limits(piece, derivatives(segment, from_s, to_s, map), limits);
    if (i > 0) piece.entry_limit_mm_per_s = machine::kNoLimit;
    piece.joined = segment.joined || i + 1 < pieces;
    piece.overlaps = segment.overlaps && i + 1 == pieces;
    sink(piece);
  }
}

namespace {

constexpr double kSameDirection = 1e-9;
/// Steps below this, in mm or rad per unit of path, are rounding of numbers.
constexpr double kNoStep = 1e-7;

}  // namespace

double corner_trim(const Segment& from, const Segment& to, const CornerRoom& room) {
  const double change = (to.direction_at(0) - from.direction_at(from.length_mm)).norm();
  return change > kSameDirection ? std::min(room.room, 4 * room.tolerance_mm / change) : room.room;
}

Segment rounded_corner(const Segment& from, double from_end_s, const Segment& to, double trim) {
  Segment corner = part_of(from, from_end_s, from_end_s + 2 * trim);
  Turn turn = *corner.turn;
  turn.bend = (to.turn->rate - from.turn->rate) / (4 * trim);
  turn.bend_mm = (to.along - from.along) / (4 * trim);
  corner.turn = std::make_shared<const Turn>(turn);
  corner.move = to.move;
  corner.cutting = from.cutting || to.cutting;
  corner.feed_command_mm_per_s = std::max(from.feed_command_mm_per_s, to.feed_command_mm_per_s);
  corner.speed_limit_mm_per_s = std::max(from.speed_limit_mm_per_s, to.speed_limit_mm_per_s);
  corner.acceleration_mm_per_s2 = std::min(from.acceleration_mm_per_s2, to.acceleration_mm_per_s2);
  corner.entry_limit_mm_per_s = machine::kNoLimit;
  return corner;
}

double joint_step_speed(const AxisValues& from, const AxisValues& to, const AxisValues& permitted) {
  AxisValues step{to.linear - from.linear, to.rotary - from.rotary};
  for (int i = 0; i < 3; ++i) {
    if (std::abs(step.linear[i]) < kNoStep) step.linear[i] = 0;
    if (std::abs(step.rotary[i]) < kNoStep) step.rotary[i] = 0;
  }
  return limit_along_joints(step, permitted);
}

}  // namespace camber::feedmodel
