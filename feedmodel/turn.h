#pragma once
// Rotary motion along one segment.
#include "base/geometry.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/joint_map.h"

namespace camber::feedmodel {

struct Segment;

/// The coordinates that a program names: X Y Z as Move has them (the tip in the part's frame under tool-centre-point
/// control), and the angles of A, B, C.
struct ProgramPose {
  Vec3 xyz_mm = Vec3::Zero();
  Vec3 rotary_rad = Vec3::Zero();
};

/// Angles and places at the length s along the segment, in mm of X Y Z, or degrees where only rotary axes move:
///     angles = start + rate s + bend s^2,        X Y Z = Segment::point_at(s) + bend_mm s^2.
/// `bend` and `bend_mm` are those of a rounded corner, else zero.
struct Turn {
  Vec3 start_rad = Vec3::Zero(), rate = Vec3::Zero(), bend = Vec3::Zero();
  Vec3 bend_mm = Vec3::Zero();
  bool tip_control = false;
  double tool_length_mm = 0;
  kinematics::FeedMeaning feed = kinematics::FeedMeaning::linear;

  bool turns() const { return !rate.isZero(0) || !bend.isZero(0); }
  bool bent() const { return !bend.isZero(0) || !bend_mm.isZero(0); }
};

inline kinematics::Joints joints_of(const kinematics::JointMap& map, const ProgramPose& pose, const Turn& turn) {
  return map.joints(pose.xyz_mm, pose.rotary_rad, turn.tip_control, turn.tool_length_mm);
}

/// Requires segment.turn.
ProgramPose pose_at(const Segment& segment, double s);

}  // namespace camber::feedmodel
