#pragma once
// The path in time: where the axes really are at every period of the control.
#include <cstdint>
#include <functional>
#include <span>

#include "base/geometry.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

struct TimedSample {
  double t_s = 0;
  Vec3 command_mm = Vec3::Zero();         ///< what the interpolator commands
  Vec3 position_mm = Vec3::Zero();        ///< predicted actual axes
  Vec3 velocity_mm_per_s = Vec3::Zero();  ///< predicted actual axes
  double feed_command_mm_per_s = 0;       ///< programmed feed of the commanded move (rapid: its top speed)
  std::uint32_t move = 0;                 ///< index of the move being commanded
};

struct FeedSummary {
  double time_s = 0;
  double cutting_time_s = 0;  ///< commanded time in G1, G2, G3
  std::size_t blocks = 0;     ///< blocks with motion
};

/// Called with runs of samples in time order; memory does not grow with the path's duration.
using SampleSink = std::function<void(std::span<const TimedSample>)>;

/// Look-ahead plan along the whole path, then the axes. Deterministic. Does not throw on valid input.
FeedSummary predict_feed(const nc::Interpretation& program, const machine::Machine& machine, const SampleSink& sink);

}  // namespace camber::feedmodel
