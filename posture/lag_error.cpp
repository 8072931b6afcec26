#include "posture/choose.h"

#include <algorithm>
#include <cmath>

namespace camber::posture {
namespace {

constexpr double kStep = 1e-5;   ///< mm, rad: of difference quotients
constexpr double kSameS = 1e-7;  ///< delays that differ by less are the same
constexpr double kShortest = 1e-9;

template <class Axis>
double delay_s(const Axis& axis) {
  const double loop =
      std::isinf(axis.position_gain_per_s) ? 0 : (1 - axis.feed_forward_percent / 100) / axis.position_gain_per_s;
  return axis.filter_s / 2 + axis.exponential_1_s + axis.exponential_2_s + loop;
}

}  // namespace

LagError::LagError(const machine::Machine& machine, const Vec3& origin_mm, double tool_length_mm, double pivot_mm)
    : chain_(machine), origin_mm_(origin_mm), tool_length_mm_(tool_length_mm), pivot_mm_(pivot_mm) {
  for (std::size_t i = 0; i < 3; ++i) {
    linear_tau_s_[static_cast<Eigen::Index>(i)] = delay_s(machine.axis[i]);
    rotary_tau_s_[static_cast<Eigen::Index>(i)] = delay_s(machine.rotary[i]);
  }
  const double first = linear_tau_s_[0];
  any_ = (linear_tau_s_.array() - first).abs().maxCoeff() > kSameS;
  for (const char letter : chain_.rotary_axes()) any_ = any_ || std::abs(rotary_tau_s_[letter - 'a'] - first) > kSameS;
}

/// Returns the centre of the rounding: the tip of a tool that is shorter by its height.
Vec3 LagError::centre_mm(const kinematics::Joints& joints) const {
  return chain_.pose(joints, tool_length_mm_ - pivot_mm_).tip_mm;
}

LagError::Place LagError::place(const PathPoint& point, const Vec3& axis, const Vec3& rotary_rad) const {
  Place out;
  out.joints.rotary_rad = rotary_rad;
  const auto linear = chain_.linear_mm(point.tip_mm(axis) - origin_mm_, rotary_rad, tool_length_mm_);
  if (!linear) return out;
  out.joints.linear_mm = *linear;
  if (!point.contact) return out;
  const Vec3 here = centre_mm(out.joints);
  for (Eigen::Index i = 0; i < 3; ++i) {
    kinematics::Joints next = out.joints;
    next.linear_mm[i] += kStep;
    out.linear[i] = point.normal.dot(centre_mm(next) - here) / kStep * linear_tau_s_[i];
  }
  for (const char letter : chain_.rotary_axes()) {
    kinematics::Joints next = out.joints;
    next.rotary_rad[letter - 'a'] += kStep;
    out.rotary[letter - 'a'] = point.normal.dot(centre_mm(next) - here) / kStep * rotary_tau_s_[letter - 'a'];
  }
  return out;
}

double LagError::error_mm(const Place& from, const Place& to, double time_s) {
  if (time_s < kShortest) return 0;
  Vec3 turn = to.joints.rotary_rad - from.joints.rotary_rad;
  for (double& angle : turn) angle = std::remainder(angle, 2 * kPi);
  return (to.linear.dot(to.joints.linear_mm - from.joints.linear_mm) + to.rotary.dot(turn)) / time_s;
}

std::vector<double> LagError::along(std::span<const PathPoint> points, const Vec3& axis, const Vec3& rotary_rad) const {
  // The axes are straight, so that the centre is off by the same matrix times its speed everywhere.
  Mat3 columns;
  kinematics::Joints zero;
  zero.rotary_rad = rotary_rad;
  const Vec3 here = centre_mm(zero);
  for (Eigen::Index i = 0; i < 3; ++i) {
    kinematics::Joints next = zero;
    next.linear_mm[i] += 1;
    columns.col(i) = centre_mm(next) - here;
  }
  const Mat3 delayed = columns * linear_tau_s_.asDiagonal() * columns.inverse();
  std::vector<double> out(points.size(), 0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const PathPoint &p = points[i], &before = points[i - 1];
    if (p.contact && p.time_s > kShortest)
      out[i] = p.normal.dot(delayed * (p.tip_mm(axis) - before.tip_mm(axis))) / p.time_s;
  }
  return out;
}

}  // namespace camber::posture
