#pragma once
// Spindle speeds at which all cuts of a tool are stable.
#include <span>

#include "machine/job_file.h"
#include "simulate/chatter_margins.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

struct SpeedBounds {
  double lowest_rpm = 0, highest_rpm = 0;
};
/// From half of a speed to twice, and to the spindle's limit.
SpeedBounds usual_speeds(const machine::Job& job, double speed_rpm);

struct StableSpeed {
  double rpm = 0;       ///< the nearest one to the programmed one; 0: none
  double best_rpm = 0;  ///< where the margin is least, as far as was looked
  double best_margin = 0;
};

/// The nearest speed within the bounds at which no tooth passing of the tool at `speed_rpm` has more than `margin`,
/// with the chips as they are: the feed changes with the speed. Speeds are tried in 150 steps, whole tens as a shop
/// sets them. The most severe kinds of cut count, kSevereCuts at most.
StableSpeed find_stable_speed(const machine::Job& job, const SimulatedProgram& program,
                              std::span<const StampLoad> loads, int tool, double speed_rpm, const SpeedBounds& bounds,
                              double margin = kAdvisedMargin);
constexpr std::size_t kSevereCuts = 24;

}  // namespace camber::simulate
