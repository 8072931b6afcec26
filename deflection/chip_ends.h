#pragma once
// Where, between two samples, an edge enters the material and leaves it.
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/engagement.h"

namespace camber::deflection {

/// An end of a chip on one ring of the envelope. Lengths of time are in rotation steps.
struct ChipEnd {
  std::uint32_t point = 0;  ///< of the envelope: the last sample in the cut
  int ring = 0;
  int step = 0;               ///< of the pitch, at which an even tooth is there
  int side = 1;               ///< 1: the next sample, at the larger angle, is out of the cut; -1: the one before
  double at = 0.5;            ///< from the sample outwards, 0 to 1: where the chip of the ring's middle ends
  double ramp = 0;            ///< how long the end takes to cross the ring's width; 0: all at once, or not known
  double thickness_mm = 0;    ///< at the sample
  double fall_mm = 0;         ///< of the thickness, a step outwards; 0: the chip ends at its full thickness
  double width_fraction = 1;  ///< of the ring that is in the cut at the sample
};

/// Ends of all chips of a stamp, ring by ring. A sample out of the cut tells by its negative thickness how far the
/// material is; where it does not, the chip is drawn out from its last two samples.
class ChipEnds {
 public:
  /// The result is good until the next call.
  std::span<const ChipEnd> find(const removal::EnvelopeGrid& envelope, const removal::EnvelopeBlocks& blocks,
                                std::span<const removal::ChipBlock> chips);

 private:
  void add_ring(const removal::EnvelopeGrid& envelope, int ring, std::span<const removal::ChipBlock> chips,
                const removal::EnvelopeBlocks& blocks, int half);
  void set_ramps(int steps);

  std::vector<ChipEnd> ends_;
  std::vector<std::size_t> first_;  ///< of each ring
};

}  // namespace camber::deflection
