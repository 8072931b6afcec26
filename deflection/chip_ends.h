#pragma once
// Finds the instants, between two samples of a ring, at which an edge enters and leaves the material (rigid coupling).
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/engagement.h"

namespace camber::deflection {

/// An end of a chip on one ring of the envelope. Times are in rotation steps.
struct ChipEnd {
  std::uint32_t point = 0;  ///< envelope point: the last sample in the cut
  int ring = 0;
  int step = 0;               ///< rotation step of the pitch at which a uniform tooth is there
  int side = 1;               ///< 1: the next sample, at the larger angle, is out of the cut; -1: the one before
  double at = 0.5;            ///< from the sample outwards, 0 to 1: end of the chip in the middle of the ring
  double ramp = 0;            ///< time over which the end crosses the ring width; 0: at once, or not known
  double thickness_mm = 0;    ///< at the sample
  double inside_mm = 0;       ///< thickness at the sample before, on the way out; 0: that one is out of the cut, too
  double fall_mm = 0;         ///< decrease of the thickness per step outwards; 0: the chip ends at its full thickness
  double width_fraction = 1;  ///< fraction of the ring that is in the cut at the sample
};

/// Finds the ends of all chips of a stamp, ring by ring. For a sample out of the cut the negative thickness is the
/// distance to the material; without it, the chip is extrapolated from its last two samples. Where that distance is
/// many times the way between two samples the material ends in a face nearly along the normal: the chip ends there at
/// its full thickness, midway between the samples, which is as near as they tell.
class ChipEnds {
 public:
  /// The result is valid until the next call.
  std::span<const ChipEnd> find(const removal::EnvelopeGrid& envelope, const removal::EnvelopeBlocks& blocks,
                                std::span<const removal::ChipBlock> chips);

 private:
  void add_ring(const removal::EnvelopeGrid& envelope, int ring, std::span<const removal::ChipBlock> chips,
                const removal::EnvelopeBlocks& blocks, int half);
  void set_ramps(int steps);

  std::vector<ChipEnd> ends_;
  std::vector<std::size_t> first_;  ///< first end of each ring
};

}  // namespace camber::deflection
