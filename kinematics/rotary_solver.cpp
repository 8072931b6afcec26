#include "kinematics/rotary_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace camber::kinematics {
namespace {

constexpr double kSettledRad = 1e-14;  ///< Newton
constexpr int kMaxSteps = 60;
constexpr double kMaxStepRad = 0.5;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// The turn about `axis` from the half plane of `from` to that of `to`.
double turn_between(const Vec3& axis, const Vec3& from, const Vec3& to) {
  const Vec3 across = axis.cross(from);
  return std::atan2(across.dot(to), across.dot(axis.cross(to)));
}

double pole_distance(const Vec3& axis, const Vec3& direction) {
  const double angle = angle_between(axis, direction);
  return std::min(angle, kPi - angle);
}

/// q_1 for v = R(w_2, q_2) t; the given angle at the pole.
double first_angle(const Vec3& axis, const Vec3& from, const Vec3& wanted, bool at_pole, double near) {
  return at_pole ? near : turn_between(axis, from, wanted);
}

RotarySolutions solve_one(const Vec3& axis, const Vec3& tool, const Vec3& wanted, double near) {
  RotarySolutions s;
  s.pole_distance_rad = pole_distance(axis, tool);
  if (std::abs(angle_between(axis, tool) - angle_between(axis, wanted)) > kReachRad) return s;
  s.at_pole = s.pole_distance_rad < kPoleRad;
  s.angles[0][0] = first_angle(axis, tool, wanted, s.at_pole, near);
  s.count = 1;
  return s;
}

RotarySolutions solve_two(const Vec3& first, const Vec3& second, const Vec3& tool, const Vec3& wanted, double near) {
  RotarySolutions s;
  s.pole_distance_rad = pole_distance(first, wanted);
  s.at_pole = s.pole_distance_rad < kPoleRad;
  const double b = angle_between(first, second), c = angle_between(second, tool);
  const double rho = angle_between(first, wanted);
  const double beyond = std::max(std::abs(b - c) - rho, rho - std::min(b + c, 2 * kPi - b - c));
  if (beyond > kReachRad) return s;
  // tan^2(phi / 2) = sin(s - b) sin(s - c) / (sin s sin(s - rho)), s half the sum of the sides
  const double above = std::sin((rho + c - b) / 2) * std::sin((rho + b - c) / 2);
  const double below = std::sin((b + c + rho) / 2) * std::sin((b + c - rho) / 2);
  const double phi = 2 * std::atan2(std::sqrt(std::max(above, 0.0)), std::sqrt(std::max(below, 0.0)));
  const double towards_first = turn_between(second, tool, first);
  for (const double side : {1.0, -1.0}) {
    const double angle = towards_first + side * phi;
    s.angles[s.count++] = {first_angle(first, turned(tool, second, angle), wanted, s.at_pole, near), angle, 0};
  }
  return s;
}

/// The step of least norm that turns `tool` towards `wanted`; its columns are the speeds of the tool's direction.
Vec3 newton_step(std::span<const Vec3> axes, const std::array<double, 3>& q, const Vec3& tool, const Vec3& wanted,
                 double& error_rad) {
  Vec3 at = tool;
  std::array<Vec3, 3> speeds;
  for (std::size_t i = axes.size(); i-- > 0;) {
    at = turned(at, axes[i], q[i]);
    speeds[i] = axes[i].cross(at);
    for (std::size_t k = i + 1; k < axes.size(); ++k) speeds[k] = turned(speeds[k], axes[i], q[i]);
  }
  error_rad = angle_between(at, wanted);
  const Vec3 e1 = at.unitOrthogonal(), e2 = at.cross(e1);
  Eigen::Matrix<double, 2, 3> jacobian;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vec3& speed = speeds[static_cast<std::size_t>(i)];
    jacobian.col(i) << e1.dot(speed), e2.dot(speed);
  }
  Vec2 to(e1.dot(wanted), e2.dot(wanted));
  if (to.norm() > 0) to *= error_rad / to.norm();
  const Eigen::Matrix2d square = jacobian * jacobian.transpose() + 1e-9 * error_rad * Eigen::Matrix2d::Identity();
  return jacobian.transpose() * square.inverse() * to;
}

bool newton(std::span<const Vec3> axes, const Vec3& tool, const Vec3& wanted, std::array<double, 3>& q) {
  double error_rad = kPi;
  for (int step = 0; step < kMaxSteps; ++step) {
    Vec3 d = newton_step(axes, q, tool, wanted, error_rad);
    if (error_rad < kSettledRad) return true;
    if (!d.allFinite()) return false;
    if (d.norm() > kMaxStepRad) d *= kMaxStepRad / d.norm();
    for (std::size_t i = 0; i < 3; ++i) q[i] += d[static_cast<Eigen::Index>(i)];
  }
  return error_rad < kReachRad;
}

RotarySolutions solve_three(std::span<const Vec3> axes, const Vec3& tool, const Vec3& wanted,
                            const std::array<double, 3>& near) {
  RotarySolutions s;
  s.pole_distance_rad = pole_distance(axes[0], wanted);
  // A start at which the step is stuck (all axes at right angles to it) is left by the others.
  constexpr std::array<std::array<double, 3>, 5> kStarts{
      {{0, 0, 0}, {0.3, -0.4, 0.5}, {-0.9, 0.8, -0.7}, {1.9, 1.4, -1.3}, {-1.2, -2.2, 2.4}}};
  for (const auto& start : kStarts) {
    std::array<double, 3> q = near;
    for (std::size_t i = 0; i < 3; ++i) q[i] += start[i];
    if (!newton(axes, tool, wanted, q)) continue;
    s.angles[0] = q;
    s.count = 1;
    return s;
  }
  return s;
}

}  // namespace

Vec3 turned(const Vec3& v, const Vec3& axis, double angle_rad) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  return c * v + s * axis.cross(v) + (1 - c) * axis.dot(v) * axis;
}

RotarySolutions solve_direction(std::span<const Vec3> axes, const Vec3& tool, const Vec3& wanted,
                                const std::array<double, 3>& near) {
  assert(axes.size() <= 3);
  if (axes.size() == 3) return solve_three(axes, tool, wanted, near);
  if (axes.size() == 2) return solve_two(axes[0], axes[1], tool, wanted, near[0]);
  if (axes.size() == 1) return solve_one(axes[0], tool, wanted, near[0]);
  RotarySolutions s;
  s.count = angle_between(tool, wanted) > kReachRad ? 0 : 1;
  s.pole_distance_rad = std::numeric_limits<double>::infinity();
  return s;
}

}  // namespace camber::kinematics
