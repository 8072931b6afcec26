#pragma once
// Reading of a stamp, or a glance at it, by a chip reader: upright::ChipReader or tilted::ChipReader.
//
// A glance is a cheap reading: it looks at one patch of the envelope in eight, always the same ones. Its sum of chip
// thicknesses shows whether the cut has changed since the last full reading.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "removal/engage/upright/patch_lanes.h"
#include "removal/engagement.h"
#include "removal/field/upright/tile_arena.h"

namespace camber::removal {

/// Selects one patch in eight, scattered over the envelope by a multiplicative hash.
inline bool glanced_at(std::uint32_t patch) {
  constexpr std::uint32_t kGolden = 2654435769u, kTopBits = 29;
  return patch * kGolden >> kTopBits == 0;
}

/// Memory of the readings of a run. A reader has reading_of(k), what a stamp of the stretch is read by; find_patches(),
/// which lists the patches that may take a chip; and read(), which appends the chips of some of them.
template <class Reader>
class PatchReading {
 public:
  PatchReading(const EnvelopeGrid& envelope, const upright::PatchLanes& lanes) : glanced_point_(envelope.size(), 0) {
    for (std::uint32_t patch = 0; patch < envelope.patches.size(); ++patch) {
      if (!glanced_at(patch)) continue;
      const upright::PatchLanes::Range range = lanes.range(patch);
      for (int l = 0; l < range.count; ++l) glanced_point_[lanes.point(range.from + l)] = 1;
    }
  }

  /// Chips of a stamp, patch by patch; valid until the next call.
  std::span<const DeflectedChipSample> read(const Reader& reader, const upright::TileArena& arena, std::size_t k) {
    constexpr std::size_t kGroup = 32;  // patches that a thread reads at once
    const typename Reader::Reading stamp = reader.reading_of(k);
    reader.find_patches(arena, stamp, patches_);
    const std::size_t groups = (patches_.size() + kGroup - 1) / kGroup;
    if (chips_of_group_.size() < groups) chips_of_group_.resize(groups);
    tbb::parallel_for(std::size_t{0}, groups, [&](std::size_t g) {
      const std::size_t from = g * kGroup, count = std::min(kGroup, patches_.size() - from);
      chips_of_group_[g].clear();
      reader.read(arena, stamp, std::span(patches_).subspan(from, count), buffers_.local(), chips_of_group_[g]);
    });
    chips_.clear();
    for (std::size_t g = 0; g < groups; ++g)
      chips_.insert(chips_.end(), chips_of_group_[g].begin(), chips_of_group_[g].end());
    return chips_;
  }

  /// Sum of the chip thicknesses in the patches of a glance, mm; `sharp` as Reader::Reading has it. Thread safe.
  double glance(const Reader& reader, const upright::TileArena& arena, std::size_t k, bool sharp) {
    Glance& b = glance_.local();
    const typename Reader::Reading stamp = reader.reading_of(k, sharp);
    reader.find_patches(arena, stamp, b.patches);
    std::erase_if(b.patches, [](std::int32_t patch) { return !glanced_at(static_cast<std::uint32_t>(patch)); });
    b.chips.clear();
    reader.read(arena, stamp, b.patches, buffers_.local(), b.chips);
    return glance_of(b.chips);
  }
  /// Returns the glances of `count` stamps, of which the first `cut` of the stretch were cut; valid until the next
  /// call.
  std::span<const double> glance(const Reader& reader, const upright::TileArena& arena, std::size_t k,
                                 std::size_t count, std::size_t cut) {
    glances_.resize(count);
    tbb::parallel_for(std::size_t{0}, count,
                      [&](std::size_t i) { glances_[i] = glance(reader, arena, k + i, k + i > cut); });
    return glances_;
  }
  /// Returns the sum of a glance for chips that were read.
  double glance_of(std::span<const DeflectedChipSample> chips) const {
    double sum = 0;
    for (const DeflectedChipSample& c : chips)
      if (c.chip.thickness_mm > 0 && glanced_point_[c.chip.point] != 0)
        sum += static_cast<double>(c.chip.thickness_mm) * c.chip.width_fraction();
    return sum;
  }

 private:
  struct Glance {
    std::vector<std::int32_t> patches;
    std::vector<DeflectedChipSample> chips;
  };
  std::vector<char> glanced_point_;  ///< by envelope point: its patch belongs to the glance
  std::vector<std::int32_t> patches_;
  std::vector<std::vector<DeflectedChipSample>> chips_of_group_;
  std::vector<DeflectedChipSample> chips_;
  std::vector<double> glances_;
  tbb::enumerable_thread_specific<typename Reader::Buffers> buffers_;
  tbb::enumerable_thread_specific<Glance> glance_;
};

}  // namespace camber::removal
