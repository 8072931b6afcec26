#pragma once
// Times of the moves of a program by the motion of the axes alone, without tools, spindle and codes.
#include <cstdint>
#include <vector>

#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

struct MotionTimes {
  std::vector<double> move_s;        ///< one per move; merged lines count at the last of them
  std::vector<float> acceleration;   ///< along the path of each cutting move's last segment, mm/s^2; 0: none
  std::size_t speed_changes = 0;     ///< along the path and of positionings
  std::size_t below_full_rapid = 0;  ///< positionings
  std::size_t unplaced_moves = 0;    ///< see CycleTime
};

/// The times of plan_motion, move by move: their sum is the time that predict_feed takes.
MotionTimes motion_times(const nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::feedmodel
