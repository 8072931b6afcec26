#pragma once
// Maps what a program names (tip or axis positions, angles) to the joints of the machine and to the tool's pose in the
// part's frame.
#include "base/tool_pose.h"
#include "feedmodel/segment.h"
#include "kinematics/chain.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Returns whether the program turns rotary axes of the machine's chain; only then does Segment have a turn.
bool has_rotary_motion(const nc::Interpretation& program, const machine::Machine& machine);

/// If the work offset or the tool length is not known, the program's zero is the machine's, and tools
/// have the length 0.
class JointMap {
 public:
  /// Requires machine.kinematics.given().
  JointMap(const machine::Machine& machine, const nc::Interpretation& program);

  /// Machine coordinates. X, Y and Z are 0 where two linear axes are parallel.
  kinematics::Joints joints(const ProgramPose& pose, const Turn& turn) const;
  /// Tip and axis in the frame of the program's X Y Z.
  ToolPose tool(const kinematics::Joints& joints, const Turn& turn) const;

 private:
  kinematics::Chain chain_;
  Vec3 tool_axis_, gauge_mm_, origin_mm_;
};

}  // namespace camber::feedmodel
