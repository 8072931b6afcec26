#include "removal/chip.h"

#include <algorithm>
#include <array>

#include "removal/envelope_blocks.h"
#include "removal/vector_clones.h"

namespace camber::removal {

std::vector<Chip> chips_of(const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  std::vector<Chip> out;
  for (const ChipBlock& c : chips)
    for (int l = 0; l < EnvelopeBlocks::kLanes; ++l)
      if (const float h = c.thickness_mm[static_cast<std::size_t>(l)]; h > 0)
        out.push_back(
            {blocks.point(c.block, l), h, (c.after_tooth >> l & 1u) != 0, c.cut_255[static_cast<std::size_t>(l)]});
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

namespace {

/// Four chips of one ring: h - (k1 + k2) / 2 h^2 + k1 k2 / 3 h^3 each, by the share of the width that is cut.
CAMBER_VECTOR_CLONES
void add_volumes(const float* h_mm, const std::uint8_t* cut_255, double half_sum, double third_product, double scale,
                 std::array<double, EnvelopeBlocks::kSteps>& volume) {
  for (std::size_t l = 0; l < EnvelopeBlocks::kSteps; ++l) {
    const double h = std::max(0.0f, h_mm[l]);
    volume[l] += h * (1 - h * (half_sum - h * third_product)) * cut_255[l] * scale;
  }
}

}  // namespace

double chip_volume_mm3(const EnvelopeGrid& e, const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  const double per_255 = 2 * kPi / e.steps / 255;
  const int last = static_cast<int>(e.rings.size()) - 1;
  std::array<double, EnvelopeBlocks::kSteps> volume{};
  for (const ChipBlock& c : chips)
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const auto& ring = e.rings[static_cast<std::size_t>(std::min(blocks.block(c.block).ring + half, last))];
      const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
      add_volumes(c.thickness_mm.data() + half * EnvelopeBlocks::kSteps,
                  c.cut_255.data() + half * EnvelopeBlocks::kSteps, (k1 + k2) / 2, k1 * k2 / 3,
                  ring.width_mm * ring.profile.radius_mm * per_255, volume);
    }
  return volume[0] + volume[1] + volume[2] + volume[3];
}

}  // namespace camber::removal
