#pragma once
// Maps what a program names (tip or axis positions, angles) to the joints of the machine and to the tool's pose in the
// part's frame, and back.
#include <optional>

#include "base/tool_pose.h"
#include "kinematics/chain.h"
#include "kinematics/joints.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::kinematics {

/// Returns whether the program turns rotary axes of the machine's chain.
bool has_rotary_motion(const nc::Interpretation& program, const machine::Machine& machine);

/// If the work offset is not known, the program's zero is the machine's.
class JointMap {
 public:
  /// Requires machine.kinematics.given().
  JointMap(const machine::Machine& machine, const nc::Interpretation& program);

  /// Machine coordinates for the programmed point p where X, Y and Z belong to one linear axis each:
  ///     p - machine origin + length * tool axis - gauge point.
  Vec3 linear_of_axes_mm(const Vec3& named_mm, double tool_length_mm) const {
    return named_mm - origin_mm_ + tool_length_mm * tool_axis_ - gauge_mm_;
  }
  /// The reverse.
  Vec3 named_mm(const Vec3& linear_mm, double tool_length_mm) const {
    return linear_mm - tool_length_mm * tool_axis_ + gauge_mm_ + origin_mm_;
  }
  /// Machine coordinates that put the tip there in the part's frame. Nothing where two linear axes are parallel.
  std::optional<Vec3> linear_of_tip_mm(const Vec3& tip_mm, const Vec3& rotary_rad, double tool_length_mm) const {
    return chain_.linear_mm(tip_mm - origin_mm_, rotary_rad, tool_length_mm);
  }
  /// tip_control: the point is the tip in the part's frame. X, Y and Z are 0 where two linear axes are parallel.
  Joints joints(const Vec3& named_mm, const Vec3& rotary_rad, bool tip_control, double tool_length_mm) const;
  /// Tip and axis in the frame of the program's X Y Z.
  ToolPose tool(const Joints& joints, double tool_length_mm) const;

  const Chain& chain() const { return chain_; }
  const Vec3& origin_mm() const { return origin_mm_; }

 private:
  Chain chain_;
  Vec3 tool_axis_, gauge_mm_, origin_mm_;
};

}  // namespace camber::kinematics
