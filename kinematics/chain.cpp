#include "kinematics/chain.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "kinematics/rotary_solver.h"

namespace camber::kinematics {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kTravelTolerance = 1e-9;  ///< mm, rad
/// Determinant of the directions of x, y, z below which two of them count as parallel.
constexpr double kMinDeterminant = 1e-9;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

bool within(double value, const std::array<double, 2>& travel) {
  return value >= travel[0] - kTravelTolerance && value <= travel[1] + kTravelTolerance;
}

/// Turns `angle` by whole turns to the winding within travel that is nearest to `near`; false where there is none.
bool wind(double& angle, double near, const std::array<double, 2>& travel) {
  const double nearest = nearest_turn(angle, near);
  if (within(nearest, travel)) {
    angle = nearest;
    return true;
  }
  const bool above = nearest > travel[1];
  const double turns = above ? std::ceil((nearest - travel[1] - kTravelTolerance) / kTurn)
                             : std::ceil((travel[0] - nearest - kTravelTolerance) / kTurn);
  const double inside = nearest + (above ? -turns : turns) * kTurn;
  angle = within(inside, travel) ? inside : nearest;
  return within(inside, travel);
}

double turn_sum(const Joints& a, const Joints& b) { return (a.rotary_rad - b.rotary_rad).lpNorm<1>(); }

}  // namespace

double nearest_turn(double angle_rad, double near_rad) {
  return angle_rad + kTurn * std::floor((near_rad - angle_rad) / kTurn + 0.5);
}

Chain::Chain(const machine::Machine& machine) {
  const machine::Kinematics& k = machine.kinematics;
  assert(k.given());
  gauge_mm_ = k.gauge_point_mm;
  tool_axis_ = k.tool_axis.normalized();
  rotary_ = k.rotary_axes();
  for (const char letter : k.chain) {
    Link link;
    link.table = links_.size() < k.table_axes;
    link.rotary = letter < 'x';
    link.index = letter - (link.rotary ? 'a' : 'x');
    if (link.rotary) {
      const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(link.index)];
      const double sense = axis.positive == machine::PositiveTurn::tool ? 1 : -1;
      link.direction = sense * axis.direction.normalized();
      link.point_mm = axis.point_mm;
      axes_.push_back(link.direction);
    } else {
      link.direction = Vec3::Unit(link.index);
    }
    links_.push_back(link);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    travel_[i] = machine.axis[i].travel_mm;
    travel_[3 + i] = machine.rotary[i].travel_rad;
  }
}

ToolPose Chain::pose(const Joints& joints, double tool_length_mm) const {
  ToolPose pose{gauge_mm_ - tool_length_mm * tool_axis_, tool_axis_};
  Vec3 spindle_x = tool_frame(pose).col(0);
  for (auto link = links_.rbegin(); link != links_.rend(); ++link) {
    if (link->rotary) {
      const double angle = joints.rotary_rad[link->index];
      pose.tip_mm = link->point_mm + turned(pose.tip_mm - link->point_mm, link->direction, angle);
      pose.axis = turned(pose.axis, link->direction, angle);
      spindle_x = turned(spindle_x, link->direction, angle);
    } else {
      pose.tip_mm += joints.linear_mm[link->index] * link->direction;
    }
  }
  return pose_of_frame(pose.tip_mm, pose.axis, spindle_x);
}

std::vector<Eigen::Isometry3d> Chain::placements(const Joints& joints) const {
  std::vector<Eigen::Isometry3d> out{Eigen::Isometry3d::Identity()};
  for (const Link& link : links_) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    if (link.rotary)
      motion = Eigen::Translation3d(link.point_mm) * Eigen::AngleAxisd(joints.rotary_rad[link.index], link.direction) *
               Eigen::Translation3d(-link.point_mm);
    else
      motion.translation() = joints.linear_mm[link.index] * link.direction;
    out.push_back(out.back() * motion);
  }
  return out;
}

Eigen::Isometry3d Chain::tool_at_zero(double tool_length_mm) const {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = tool_frame({Vec3::Zero(), tool_axis_, 0});
  out.translation() = gauge_mm_ - tool_length_mm * tool_axis_;
  return out;
}

std::optional<Vec3> Chain::linear_mm(const Vec3& tip_mm, const Vec3& rotary_rad, double tool_length_mm) const {
  // tip = start + columns * (x, y, z): both are carried through the rotary axes on the way to the part.
  Vec3 start = gauge_mm_ - tool_length_mm * tool_axis_;
  Eigen::Matrix3d columns = Eigen::Matrix3d::Zero();
  for (auto link = links_.rbegin(); link != links_.rend(); ++link) {
    if (!link->rotary) {
      columns.col(link->index) = link->direction;
      continue;
    }
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(rotary_rad[link->index], link->direction).toRotationMatrix();
    start = link->point_mm + turn * (start - link->point_mm);
    columns = turn * columns;
  }
  if (std::abs(columns.determinant()) < kMinDeterminant) return std::nullopt;
  return columns.inverse() * (tip_mm - start);
}

std::optional<Joints> Chain::with_angles(const ToolPose& pose, double tool_length_mm,
                                         const std::array<double, 3>& angles, const Joints& near) const {
  Joints joints;
  for (std::size_t i = 0; i < rotary_.size(); ++i) {
    const Eigen::Index index = rotary_[i] - 'a';
    joints.rotary_rad[index] = nearest_turn(angles[i], near.rotary_rad[index]);
  }
  const auto linear = linear_mm(pose.tip_mm, joints.rotary_rad, tool_length_mm);
  if (!linear) return std::nullopt;
  joints.linear_mm = *linear;
  return joints;
}

Branches Chain::branches(const ToolPose& pose, double tool_length_mm, const Joints& near) const {
  std::array<double, 3> near_angles{};
  for (std::size_t i = 0; i < rotary_.size(); ++i) near_angles[i] = near.rotary_rad[rotary_[i] - 'a'];
  const RotarySolutions rotary = solve_direction(axes_, tool_axis_, pose.axis, near_angles);
  Branches out;
  out.at_pole = rotary.at_pole;
  out.pole_distance_rad = rotary.pole_distance_rad;
  if (rotary.count == 0) out.reach = Reach::direction;
  for (std::size_t i = 0; i < rotary.count; ++i)
    if (const auto joints = with_angles(pose, tool_length_mm, rotary.angles[i], near))
      out.joints[out.count++] = *joints;
  if (rotary.count > 0 && out.count == 0) out.reach = Reach::linear;
  return out;
}

bool Chain::wind_into_travel(Joints& joints, const Joints& near, bool rotary_alone) const {
  bool inside = true;
  for (const char letter : rotary_) {
    const Eigen::Index index = letter - 'a';
    const auto& travel = travel_[static_cast<std::size_t>(3 + index)];
    inside = wind(joints.rotary_rad[index], near.rotary_rad[index], travel) && inside;
  }
  return rotary_alone ? inside : outside_travel(joints) == 0;
}

Solution Chain::solve(const ToolPose& pose, double tool_length_mm, const Joints& near) const {
  return best_of(branches(pose, tool_length_mm, near), near, false);
}

Solution Chain::solve_tool_axis(const Vec3& axis, const Joints& near) const {
  return best_of(branches({Vec3::Zero(), axis}, 0, near), near, true);
}

Eigen::Matrix3d Chain::table_rotation(const Vec3& rotary_rad) const {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (const Link& link : links_)
    if (link.table && link.rotary)
      turn = turn * Eigen::AngleAxisd(rotary_rad[link.index], link.direction).toRotationMatrix();
  return turn;
}

Solution Chain::best_of(const Branches& branches, const Joints& near, bool rotary_alone) const {
  Solution best;
  best.reach = branches.reach;
  best.at_pole = branches.at_pole;
  best.pole_distance_rad = branches.pole_distance_rad;
  double least = 0;
  for (std::size_t i = 0; i < branches.count; ++i) {
    Joints joints = branches.joints[i];
    const bool inside = wind_into_travel(joints, near, rotary_alone);
    const double sum = turn_sum(joints, near);
    const bool better = i == 0 || (inside == (best.reach == Reach::reached) ? sum < least : inside);
    if (!better) continue;
    best.joints = joints;
    best.reach = inside ? Reach::reached : Reach::travel;
    best.axis = outside_travel(joints);
    least = sum;
  }
  return best;
}

char Chain::outside_travel(const Joints& joints) const {
  for (std::size_t i = 0; i < travel_.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i % 3);
    const double value = i < 3 ? joints.linear_mm[index] : joints.rotary_rad[index];
    if (!within(value, travel_[i])) return "xyzabc"[i];
  }
  return 0;
}

std::array<double, 2> Chain::tilt_range_rad() const {
  assert(axes_.size() == 2);
  const double b = angle_between(axes_[0], axes_[1]), c = angle_between(axes_[1], tool_axis_);
  return {std::abs(b - c), std::min(b + c, 2 * kPi - b - c)};
}

}  // namespace camber::kinematics
