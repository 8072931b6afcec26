#pragma once
// Forward and inverse kinematics of a machine: axis positions to tool pose and back.
//
// Every axis is a relative motion E_i(q_i) of the tool against the part, a translation along its direction or a
// rotation about its line; in the order from the part to the spindle
//     pose(q) = E_1(q_1) E_2(q_2) ... E_n(q_n) pose(0),        pose(0): tip = gauge point - length * tool axis.
// Whether the table or the head carries an axis makes no difference to it. The part's frame is the machine's at q = 0.
//
// Inverse: the rotary axes alone give the tool's direction (kinematics/rotary_solver.h); with their angles the tip is
// linear in x, y, z, wherever the linear axes are in the chain.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/tool_pose.h"
#include "kinematics/joints.h"
#include "machine/machine_model.h"

namespace camber::kinematics {

enum class Reach {
  reached,
  direction,  ///< no angles of the rotary axes give the tool this direction
  linear,     ///< at these angles two linear axes are parallel, so that they do not reach every point
  travel      ///< every solution is outside the travel of an axis
};

/// Every solution of a pose, each with the winding nearest to the given joints; travel is not looked at.
struct Branches {
  std::array<Joints, 2> joints{};
  std::size_t count = 0;  ///< 0 unless `reach` is reached
  Reach reach = Reach::reached;
  bool at_pole = false;          ///< the axis next to the part was kept where it is: its angle is free
  double pole_distance_rad = 0;  ///< angle between the tool and the axis next to the part, 0 to pi/2
};

struct Solution {
  Joints joints;
  Reach reach = Reach::reached;
  char axis = 0;  ///< reach travel: the axis that leaves its travel in the nearest solution; x y z a b c
  bool at_pole = false;
  double pole_distance_rad = 0;
};

class Chain {
 public:
  /// Requires machine.kinematics.given().
  explicit Chain(const machine::Machine& machine);

  /// Tip and axis of a tool of this length (gauge line to tip) in the part's frame, with the spindle's X carried along.
  ToolPose pose(const Joints& joints, double tool_length_mm) const;
  /// Where bodies stand in the part's frame: out[k] = E_1 ... E_k takes what is carried with k axes between the part
  /// and it (machine::Body::axes) from where it is with all axes at 0. One more than the chain has axes; out.back():
  /// the spindle.
  std::vector<Eigen::Isometry3d> placements(const Joints& joints) const;
  /// The tool's frame, origin at the tip and z along its axis, with all axes at 0.
  Eigen::Isometry3d tool_at_zero(double tool_length_mm) const;
  /// Positions of x, y, z that put the tip there at these angles; nothing where two linear axes are parallel.
  std::optional<Vec3> linear_mm(const Vec3& tip_mm, const Vec3& rotary_rad, double tool_length_mm) const;
  /// Inverse kinematics. pose.axis: unit. `near`: decides windings, and angles that are free.
  /// Round trip with pose(): 1e-9 mm for coordinates up to metres, 1e-9 in the axis (chain_test).
  Branches branches(const ToolPose& pose, double tool_length_mm, const Joints& near) const;
  /// Joints of a pose: of both branches and their windings within travel, the solution with the least sum of turns
  /// from `near`. Where none is within travel: the nearest, with the axis that leaves its travel.
  Solution solve(const ToolPose& pose, double tool_length_mm, const Joints& near) const;

  /// The same for a direction alone: the travel of x, y, z does not count.
  Solution solve_tool_axis(const Vec3& axis, const Joints& near) const;
  /// Rotation by the table: part_from_machine for directions, at these angles.
  Eigen::Matrix3d table_rotation(const Vec3& rotary_rad) const;

  /// The first axis, in the order x y z a b c, outside its travel by more than 1e-9 mm or rad; 0: none.
  char outside_travel(const Joints& joints) const;
  /// Letters of the rotary axes from the part to the spindle.
  const std::string& rotary_axes() const { return rotary_; }
  /// Angle between the tool and the axis next to the part that the rotary axes reach: [min, max], rad. Two axes only.
  std::array<double, 2> tilt_range_rad() const;

 private:
  struct Link {
    Vec3 direction = Vec3::Zero();  ///< unit; sense of the tool against the part for growing words
    Vec3 point_mm = Vec3::Zero();   ///< rotary
    bool rotary = false, table = false;
    Eigen::Index index = 0;  ///< in Joints::linear_mm or rotary_rad
  };

  std::optional<Joints> with_angles(const ToolPose& pose, double tool_length_mm, const std::array<double, 3>& angles,
                                    const Joints& near) const;
  bool wind_into_travel(Joints& joints, const Joints& near, bool rotary_alone) const;
  Solution best_of(const Branches& branches, const Joints& near, bool rotary_alone) const;

  std::vector<Link> links_;  ///< from the part to the spindle
  std::vector<Vec3> axes_;   ///< directions of the rotary links
  std::string rotary_;
  Vec3 gauge_mm_ = Vec3::Zero();
  Vec3 tool_axis_ = Vec3::UnitZ();
  std::array<std::array<double, 2>, 6> travel_{};  ///< x y z a b c; mm, rad
};

/// The angle that differs from `angle_rad` by whole turns and is nearest to `near_rad`; half a turn away: the greater
/// one.
double nearest_turn(double angle_rad, double near_rad);

}  // namespace camber::kinematics
