#pragma once
// In-position wait: the time that a control waits at a stop until its axes are there.
#include "feedmodel/segment_motion.h"
#include "kinematics/joint_map.h"
#include "machine/machine.h"

namespace camber::feedmodel {

/// Time from the end of a segment's command until every axis is within control.in_position_mm of it, a multiple of the
/// control's period: the axes are driven along the end of the segment, from at most twelve of their time constants
/// before it. With `map`, of a program with rotary motion, the joints, of which rotary ones have the same number of
/// degrees. 0 where the control does not wait or the axes have no lag.
double in_position_wait_s(const machine::Machine& machine, const Segment& segment, const SegmentMotion& motion,
                          const kinematics::JointMap* map = nullptr);

}  // namespace camber::feedmodel
