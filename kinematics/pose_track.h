#pragma once
// A program as the machine runs it: joints and tool poses along the path.
#include <cstddef>
#include <vector>

#include "base/tool_pose.h"
#include "kinematics/joints.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::kinematics {

struct PoseSample {
  double time_s = 0;  ///< ascending
  int line = 0;       ///< 1-based line of the program; 0: none
  /// In the part's frame: the machine frame with every axis at 0, carried along by the table. With the length that the
  /// program gives the tool anywhere, where G43 is not active too.
  ToolPose pose;
  Joints joints;
};

struct PoseTrackOptions {
  double max_step_rad = 2 * kPi / 180;  ///< between samples, for each rotary axis
  double max_step_mm = 10;              ///< between samples, for each linear axis; arcs have at least 24 samples a turn
  std::size_t max_steps_per_move = 2000;
  double rapid_mm_per_s = 200;  ///< rapid speed of linear axes without max_velocity_mm_per_min
  double rapid_rad_per_s = 1;   ///< rapid speed of rotary axes without max_velocity_deg_per_min
};

struct PoseTrack {
  std::vector<PoseSample> samples;
  std::size_t unknown_moves = 0;  ///< left out, as the positions of X, Y and Z at their end are not known
};

/// Positions along the programmed path, ends of moves included. Time is that of programmed feeds and of rapids at the
/// speed of the slowest axis, without acceleration; moves that are left out take no time. Requires
/// machine.kinematics.given().
PoseTrack programmed_track(const machine::Machine& machine, const nc::Interpretation& moves,
                           const PoseTrackOptions& options = {});

}  // namespace camber::kinematics
