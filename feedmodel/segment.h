#pragma once
// A segment of the path that the control commands, with its limits: a straight line, a circular arc (helix), a
// positioning whose axes move each on its own, or a rest.
#include <cstdint>
#include <memory>

#include "base/geometry.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/joint_map.h"
#include "machine/machine_model.h"

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

/// Requires segment.turn.
ProgramPose pose_at(const Segment& segment, double s);

inline kinematics::Joints joints_of(const kinematics::JointMap& map, const ProgramPose& pose, const Turn& turn) {
  return map.joints(pose.xyz_mm, pose.rotary_rad, turn.tip_control, turn.tool_length_mm);
}

struct Segment {
  Vec3 start_mm = Vec3::Zero();
  Vec3 along = Vec3::UnitX();  ///< line: unit direction; arc: unit vector from the centre to the start
  Vec3 across = Vec3::Zero();  ///< arc: unit tangent at the start, within the plane of the turn
  Vec3 rise = Vec3::Zero();    ///< arc: mm along the normal for each mm of path (helix)
  double radius_mm = 0;        ///< 0: a line
  double turn_rad_per_mm = 0;  ///< arc: angle turned for each mm of path
  /// Arc: mm by which the radius grows for each mm of path. Programs round the ends of an arc, so that its two radii
  /// differ: controls spread the difference along the arc, as nc::point_at does.
  double radius_growth = 0;
  double length_mm = 0;

  double speed_limit_mm_per_s = 0;
  double axis_limit_mm_per_s = machine::kNoLimit;  ///< limit of the maximum axis speeds along it
  double acceleration_mm_per_s2 = 0;               ///< along the path
  double planned_fraction = 1;                     ///< fraction of the acceleration that the lookahead counts on
  double entry_limit_mm_per_s = 0;                 ///< speed limit of the corner at its start
  double feed_command_mm_per_s = 0;                ///< programmed (rapid: top speed of the axes along it)
  double dwell_s = 0;                              ///< a rest instead of a motion: length 0, speed limit 0
  /// A positioning move from rest to rest, each axis on its own (dog-leg path): distance, speed and acceleration of the
  /// axes.
  bool axes_apart = false;
  Vec3 way_mm = Vec3::Zero(), axis_speed_mm_per_s = Vec3::Zero(), axis_acceleration_mm_per_s2 = Vec3::Zero();
  std::uint32_t move = 0;  ///< last of the moves that were merged in it
  std::uint8_t mode = 0;   ///< parameter set of the control: see mode_of
  bool cutting = false;
  bool joined = false;  ///< planned as one with the rounding that follows
  bool exact = false;   ///< the program asks for an exact stop at its end (G9, G61.1)
  bool gap = false;     ///< a rest after which the axis positions are unknown
  /// The next segment begins while this one brakes (ControlKind::turning_blocks_overlap), from this speed at most.
  bool overlaps = false;
  double overlap_speed_mm_per_s = machine::kNoLimit;
  std::shared_ptr<const Turn> turn{};  ///< rotary motion; null in programs without it

  /// Of an arc's motion, the fraction within the plane of the turn.
  double in_plane() const;
  Vec3 point_at(double s_mm) const;
  /// Unit, but for the radius' growth of a rounded arc, which turns no corner.
  Vec3 direction_at(double s_mm) const;
};

/// A straight line; length 0 for equal points.
Segment line_segment(const Vec3& from_mm, const Vec3& to_mm);

/// An arc that leaves `from_mm` and turns by sweep_rad about `normal` through `center_mm`; `rise_mm` along the normal
/// and `growth_mm` of its radius over the whole sweep.
Segment arc_segment(const Vec3& from_mm, const Vec3& center_mm, const Vec3& normal, double sweep_rad, double rise_mm,
                    double growth_mm = 0);

/// The part of a segment between two lengths along it; the limits stay.
Segment part_of(const Segment& segment, double from_s_mm, double to_s_mm);

}  // namespace camber::feedmodel
