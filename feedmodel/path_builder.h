#pragma once
// From moves to the segments that the control commands: lines merged, corners rounded, limits set.
#include <cstdint>
#include <functional>
#include <span>

#include "feedmodel/segment.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

using SegmentSink = std::function<void(const Segment&)>;

/// What cycle time asks beside what a machine's feed model has.
struct PathOptions {
  std::span<const std::uint32_t> rests;                      ///< moves (ascending) before which the path rests
  bool rest_at_rapids = false;                               ///< before, after and between rapids
  double feed_factor = 1, rapid_factor = 1;                  ///< overrides
  double linear_acceleration_mm_per_s2 = machine::kNoLimit;  ///< most along a straight feed move
};

/// Hands the segments out in order; each starts where the one before ended. A dwell, a tool change and the end
/// of the program are rests (length 0). Moves without length and moves to a reference point that is not known
/// are left out. Memory does not grow with the program; called twice it gives the same segments.
void build_segments(const nc::Interpretation& program, const machine::Machine& machine, const SegmentSink& sink,
                    const PathOptions& options = {});

}  // namespace camber::feedmodel
