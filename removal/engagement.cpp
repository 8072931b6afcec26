#include "removal/engagement.h"

#include <algorithm>
#include <array>

#include "base/vector_clones.h"

namespace camber::removal {

std::vector<ChipSample> chips_of(const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  std::vector<ChipSample> out;
  for (const ChipBlock& c : chips)
    for (int l = 0; l < EnvelopeBlocks::kLanes; ++l)
      if (const float h = c.thickness_mm[static_cast<std::size_t>(l)]; h > 0)
        out.push_back({blocks.point(c.block, l), h, (c.after_tooth >> l & 1u) != 0, (c.own_surface >> l & 1u) != 0,
                       c.cut_255[static_cast<std::size_t>(l)]});
  return out;
}

double chip_volume_mm3(const EnvelopeGrid& e, std::span<const ChipSample> chips) {
  const double turn = 2 * kPi / e.steps;
  double volume = 0;
  for (const ChipSample& c : chips) {
    const auto& ring = e.rings[c.point / static_cast<std::uint32_t>(e.steps)];
    const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
    const double h = c.thickness_mm;
    volume += (h - 0.5 * (k1 + k2) * h * h + k1 * k2 * h * h * h / 3) * c.width_fraction() * ring.width_mm *
              ring.profile.radius_mm * turn;
  }
  return volume;
}

namespace {

/// Sums over chips that stand side by side, of share h, share h^2 and share h^3.
struct Powers {
  std::array<double, EnvelopeBlocks::kLanes> h{}, h2{}, h3{};

  double sum(const std::array<double, EnvelopeBlocks::kLanes>& of, int half) const {
    double out = 0;
    for (std::size_t l = 0; l < EnvelopeBlocks::kSteps; ++l)
      out += of[static_cast<std::size_t>(half * EnvelopeBlocks::kSteps) + l];
    return out;
  }
};

CAMBER_VECTOR_CLONES
void add_powers(const ChipBlock* chips, std::size_t count, Powers& sums) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t l = 0; l < EnvelopeBlocks::kLanes; ++l) {
      const double h = std::max(0.0f, chips[k].thickness_mm[l]), cut = chips[k].cut_255[l] * h;
      sums.h[l] += cut, sums.h2[l] += cut * h, sums.h3[l] += cut * h * h;
    }
}

}  // namespace

double chip_volume_mm3(const EnvelopeGrid& e, const EnvelopeBlocks& blocks, std::span<const ChipBlock> chips) {
  const double per_255 = 2 * kPi / e.steps / 255;
  const int last = static_cast<int>(e.rings.size()) - 1;
  double volume = 0;
  for (std::size_t from = 0, end = 0; from < chips.size(); from = end) {
    const int lower = blocks.block(chips[from].block).ring;
    while (end < chips.size() && blocks.block(chips[end].block).ring == lower) ++end;
    Powers sums;
    add_powers(chips.data() + from, end - from, sums);
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const auto& ring = e.rings[static_cast<std::size_t>(std::min(lower + half, last))];
      const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
      volume +=
          (sums.sum(sums.h, half) - 0.5 * (k1 + k2) * sums.sum(sums.h2, half) + k1 * k2 * sums.sum(sums.h3, half) / 3) *
          ring.width_mm * ring.profile.radius_mm * per_255;
    }
  }
  return volume;
}

}  // namespace camber::removal
