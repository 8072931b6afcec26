#pragma once
// The plan of a whole program: entry speed, motion, start and duration of each segment. Every
// command that reports a time, a feed or a place of the tool takes it from here.
#include <cstdint>
#include <functional>
#include <vector>

#include "feedmodel/lookahead.h"
#include "feedmodel/segment_motion.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// A segment in time.
struct SegmentTime {
  std::uint32_t move = 0;                    ///< that it ends in
  std::uint8_t mode = 0;                     ///< parameter set of the control: see mode_of
  bool rest = false;                         ///< a dwell or a stop; duration_s may be 0
  bool cutting = false;                      ///< of a feed move
  bool overlapped = false;                   ///< from rest to rest, in time with its neighbours (overlap.h)
  bool accelerates = false, brakes = false;  ///< a change of speed begins in it: what a jerk filter delays
  double start_s = 0, duration_s = 0;
  double wait_s = 0;  ///< after it, until the axes are in position

  double end_s() const { return start_s + duration_s + wait_s; }
};

/// A motion that begins at (almost) rest begins at a whole period of the control. A positioning may begin before the
/// one before it has ended (rapid_overlap_percent).
struct MotionPlan {
  std::vector<PlanRow> rows;       ///< one for each segment of build_segments, lookahead done
  std::vector<SegmentTime> times;  ///< the same
  std::size_t speed_changes = 0;   ///< along the path and of positionings

  double time_s() const { return times.empty() ? 0.0 : times.back().end_s(); }
};

/// Linear time; 88 bytes of memory a segment. Deterministic. Does not throw on valid input.
MotionPlan plan_motion(const nc::Interpretation& program, const machine::Machine& machine);

/// next_start_s: when the segment after it begins, which may be before this one ends.
using TakeMotion = std::function<void(const Segment& segment, const SegmentMotion& motion, const SegmentTime& time,
                                      double next_start_s)>;
/// The same plan, segment by segment in order, without keeping it: 24 bytes a segment while the speeds are planned, 8
/// while the segments are handed out.
void follow_motion(const nc::Interpretation& program, const machine::Machine& machine, const TakeMotion& take);

/// How segment i moves; `segment` is the i-th of build_segments.
SegmentMotion motion_of(const MotionPlan& plan, std::size_t i, const Segment& segment, const machine::Machine& machine);

/// Constant acceleration in row i (entry and exit speeds are those of the plan).
Trapezoid profile_of(const std::vector<PlanRow>& rows, std::size_t i);

}  // namespace camber::feedmodel
