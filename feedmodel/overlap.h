#pragma once
// Blocks that run from rest to rest, each beginning while the one before it brakes (LinuxCNC's G64 where rotary axes
// turn): when the next one begins, and how long each lasts. Followed cycle by cycle: the control decides in whole
// periods, which counts in blocks of a few of them.
//
// The law is the one that the traces show (docs/feed-model.md). With a and v the acceleration and the speed limit of
// a block and v_r = min(v, sqrt(a L)), the next one begins as soon as the block brakes and is slower than
//     v_b = min(v_r, a t, 2 sqrt(a T / sin(turn / 2))),   t = min(min L / v_r, max v_r / a) over both blocks,
// T the tolerance of the corner and `turn` the angle between the directions in X Y Z.
#include "feedmodel/lookahead.h"

namespace camber::feedmodel {

/// Returns the speed limit of a corner that turns by this angle; infinite for none.
double overlap_corner_speed(double turn_rad, double acceleration_mm_per_s2, double tolerance_mm);

/// v_b without its last term. next_is_last: a rest follows the next block; the control then reckons v_r with half of
/// its length.
double overlap_speed(const PlanRow& row, const PlanRow& next, bool next_is_last);

struct OverlapTimes {
  double end_s = 0;
  double next_start_s = 0;  ///< end_s where the next block does not overlap
};

struct OverlapOptions {
  double start_s = 0;
  double alone_from_s = 0;  ///< the block before it ends here: the next one may not begin earlier
  double speed = 0;         ///< v_b; 0: the next block does not overlap
  double period_s = 0.001;
};

/// Returns the time from rest to rest. Requires a finite acceleration, and a speed limit and a length above zero.
OverlapTimes overlap_times(const PlanRow& row, const OverlapOptions& options);

}  // namespace camber::feedmodel
