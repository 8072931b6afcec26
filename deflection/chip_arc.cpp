#include "deflection/tooth_pass.h"

#include <algorithm>

namespace camber::deflection {

using removal::EnvelopeBlocks;
using removal::EnvelopeGrid;

namespace {

/// Sums in double over one ring.
struct RingArc {
  double cut = 0, cosine = 0, sine = 0;  ///< of shares of the ring's width

  void add(double share, double c, double s) {
    cut += share;
    cosine += share * (c * c - s * s);
    sine += share * 2 * c * s;
  }
};

void add_ring(const RingArc& r, const EnvelopeGrid::Ring& ring, int steps, ChipArc& arc) {
  const double height = ring.width_mm * ring.sine, each = height * 2 * kPi / steps;
  arc.area_mm_rad += static_cast<float>(r.cut * each);
  arc.cosine_mm_rad += static_cast<float>(r.cosine * each);
  arc.sine_mm_rad += static_cast<float>(r.sine * each);
  arc.wall_mm_rad += static_cast<float>(r.cut * each * ring.sine);
}

}  // namespace

ChipArc chip_arc(const EnvelopeGrid& e, std::span<const removal::ChipSample> chips) {
  ChipArc arc;
  const auto steps = static_cast<std::uint32_t>(e.steps);
  for (std::size_t i = 0; i < chips.size();) {
    const std::uint32_t ring = chips[i].point / steps;
    RingArc sums;
    for (; i < chips.size() && chips[i].point / steps == ring; ++i)
      if (chips[i].thickness_mm > kThinnestChip_mm)
        sums.add(chips[i].width_fraction(), e.cos_phi[chips[i].point], e.sin_phi[chips[i].point]);
    add_ring(sums, e.rings[ring], e.steps, arc);
  }
  return arc;
}

ChipArc chip_arc(const EnvelopeGrid& e, const EnvelopeBlocks& blocks, std::span<const removal::ChipBlock> chips) {
  constexpr int kSteps = EnvelopeBlocks::kSteps;
  const int last = static_cast<int>(e.rings.size()) - 1;
  ChipArc arc;
  for (const removal::ChipBlock& chip : chips)
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const float *h = chip.thickness_mm.data() + half * kSteps, *c = blocks.cos_phi(chip.block) + half * kSteps,
                  *s = blocks.sin_phi(chip.block) + half * kSteps;
      const std::uint8_t* cut_255 = chip.cut_255.data() + half * kSteps;
      RingArc sums;
      for (int l = 0; l < kSteps; ++l)
        sums.add(h[l] > kThinnestChip_mm ? cut_255[l] / 255.0 : 0.0, static_cast<double>(c[l]),
                 static_cast<double>(s[l]));
      if (sums.cut > 0)
        add_ring(sums, e.rings[static_cast<std::size_t>(std::min(blocks.block(chip.block).ring + half, last))], e.steps,
                 arc);
    }
  return arc;
}

}  // namespace camber::deflection
