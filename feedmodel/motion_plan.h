#pragma once
// The plan of a whole program in time: entry speed, motion, start and duration of each segment. Every command that
// reports a time, a feed or a place of the tool takes it from here. This is the door of feedmodel/.
//
// Overview
//
// A control turns moves into the motion of its axes in four steps, and so does this folder:
//
// 1. path_builder  moves become segments: short lines are merged, corners are rounded or get a speed limit (corner),
//                  positioning moves become their own axis motions (rapid), and each segment gets the limits of its
//                  axes and joints (limits), of the block time and of the parameter set that is active (modes). rests
//                  are places where the control waits.
// 2. lookahead     a backward and a forward pass find the entry speed of each segment, v_i^2 <= v_(i+1)^2 + 2 a L, over
//                  the whole path or a horizon of blocks.
// 3. segment_motion gives the speed over time within a segment (trapezoid or triangle; exponential; bell and jerk
//                  filter as longer ramps). axes adds their wait at stops.
// 4. axes          turn commands at each period of the control into actual positions: drive is one axis with its
//                  filter, dead time, position loop and backlash.
//
// plan_motion() does 1 to 3 and returns times; predict_feed() (timed_path.h) adds 4 and returns samples. Programs
// with rotary axes go through joint_map, move_turns and overlap as well; samples then carry tool poses (part_tracking).
// path_tracker finds the place of the lagging axes on the programmed path. cycle_time adds what is not motion.
//
// Units: mm, s, rad (degrees for rotary axes in joints). docs/feed-model.md has equations, sources and validation.
#include <cstdint>
#include <functional>
#include <vector>

#include "feedmodel/lookahead.h"
#include "feedmodel/segment_motion.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// A segment in time.
struct SegmentTime {
  std::uint32_t move = 0;                    ///< move in which it ends
  std::uint8_t mode = 0;                     ///< parameter set of the control: see mode_of
  bool rest = false;                         ///< a dwell or a stop; duration_s may be 0
  bool cutting = false;                      ///< belongs to a feed move
  bool overlapped = false;                   ///< runs from rest to rest and overlaps with its neighbours (overlap.h)
  bool accelerates = false, brakes = false;  ///< a change of speed begins in it, which a jerk filter delays
  double start_s = 0, duration_s = 0;
  double wait_s = 0;  ///< wait after it, until the axes are in position

  double end_s() const { return start_s + duration_s + wait_s; }
};

/// A motion that begins at (almost) rest begins at a whole period of the control; after the stop of another block only
/// where Control::starts_on_period says so. A positioning may begin before the
/// one before it has ended (rapid_overlap_percent).
struct MotionPlan {
  std::vector<PlanRow> rows;       ///< one for each segment of build_segments, lookahead done
  std::vector<SegmentTime> times;  ///< one for each row
  std::size_t speed_changes = 0;   ///< along the path and of positionings

  double time_s() const { return times.empty() ? 0.0 : times.back().end_s(); }
};

/// Linear time; 88 bytes of memory a segment. Deterministic. Does not throw on valid input.
MotionPlan plan_motion(const nc::Interpretation& program, const machine::Machine& machine);

/// next_start_s: when the segment after it begins, which may be before this one ends.
using TakeMotion = std::function<void(const Segment& segment, const SegmentMotion& motion, const SegmentTime& time,
                                      double next_start_s)>;
/// Calculates the same plan, segment by segment in order, without keeping it: 24 bytes a segment while the speeds are
/// planned, 8 while the segments are handed out.
void follow_motion(const nc::Interpretation& program, const machine::Machine& machine, const TakeMotion& take);

/// Returns the motion of segment i; `segment` is the i-th of build_segments.
SegmentMotion motion_of(const MotionPlan& plan, std::size_t i, const Segment& segment, const machine::Machine& machine);

/// Constant acceleration in row i (entry and exit speeds are those of the plan).
Trapezoid profile_of(const std::vector<PlanRow>& rows, std::size_t i);

}  // namespace camber::feedmodel
