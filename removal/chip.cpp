#include "removal/chip.h"

#include <algorithm>

#include "removal/envelope_blocks.h"

namespace camber::removal {

std::vector<Chip> chips_of(const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  std::vector<Chip> out;
  for (const ChipBlock& c : chips)
    for (int l = 0; l < EnvelopeBlocks::kLanes; ++l)
      if (const float h = c.thickness_mm[static_cast<std::size_t>(l)]; h > 0)
        out.push_back({blocks.point(c.block, l), h, (c.after_tooth >> l & 1u) != 0, (c.own_surface >> l & 1u) != 0,
                       c.cut_255[static_cast<std::size_t>(l)]});
  return out;
}

double chip_volume_mm3(const EnvelopeGrid& e, std::span<const Chip> chips) {
  const double turn = 2 * kPi / e.steps;
  double volume = 0;
  for (const Chip& c : chips) {
    const auto& ring = e.rings[c.point / static_cast<std::uint32_t>(e.steps)];
    const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
    const double h = c.thickness_mm;
    volume += (h - 0.5 * (k1 + k2) * h * h + k1 * k2 * h * h * h / 3) * c.width_share() * ring.width_mm *
              ring.profile.radius_mm * turn;
  }
  return volume;
}

double chip_volume_mm3(const EnvelopeGrid& e, const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  const double turn = 2 * kPi / e.steps;
  const int last = static_cast<int>(e.rings.size()) - 1;
  double volume = 0;
  for (const ChipBlock& c : chips)
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const auto& ring = e.rings[static_cast<std::size_t>(std::min(blocks.block(c.block).ring + half, last))];
      double h1 = 0, h2 = 0, h3 = 0;  // sums of powers
      for (int l = 0; l < EnvelopeBlocks::kSteps; ++l) {
        const auto at = static_cast<std::size_t>(half * EnvelopeBlocks::kSteps + l);
        const double h = std::max(0.0f, c.thickness_mm[at]), cut = c.cut_255[at] * h;
        h1 += cut, h2 += cut * h, h3 += cut * h * h;
      }
      const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
      volume += (h1 - 0.5 * (k1 + k2) * h2 + k1 * k2 * h3 / 3) * ring.width_mm * ring.profile.radius_mm * turn / 255;
    }
  return volume;
}

}  // namespace camber::removal
