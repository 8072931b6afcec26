#include "removal/field/stamp_deflection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace camber::removal {
namespace {

/// Middles of the sectors, half a turn more on both sides.
struct SectorTable {
  static_assert((StampDeflection::kSectors & (StampDeflection::kSectors - 1)) == 0);
  static constexpr int kPadded = 2 * StampDeflection::kSectors + 1;
  std::array<float, kPadded> cosine, sine;
  SectorTable() {
    const double sector = 2 * kPi / StampDeflection::kSectors;
    for (int o = 0; o < kPadded; ++o) {
      const int i = (o + StampDeflection::kSectors / 2) & (StampDeflection::kSectors - 1);
      cosine[o] = static_cast<float>(std::cos(-kPi + (i + 0.5) * sector));
      sine[o] = static_cast<float>(std::sin(-kPi + (i + 0.5) * sector));
    }
  }
};

}  // namespace

StampDeflections::StampDeflections(const EnvelopeGrid& envelope, const DeflectionTable& deflections)
    : deflections_(deflections),
      flutes_(envelope.flutes),
      group_(std::max(1, deflections.steps * envelope.flutes / 360)) {
  const int nodes = static_cast<int>(deflections.nodes());
  const double node_step = nodes > 1 ? deflections.node_height_mm[1] : 0.0;
  const double sector = 2 * kPi / StampDeflection::kSectors;
  // A deflection between two nodes belongs to a range of lags; one sector more for interpolation between steps.
  spread_ = std::min(1 + static_cast<int>(std::ceil(envelope.lag_per_mm * node_step / sector)),
                     StampDeflection::kSectors / 2);
  static_assert(StampDeflection::kSectors == 32);
  for (int o = -spread_; o <= spread_; ++o) spread_sectors_ |= std::rotl(1u, o);
  for (int n = 0; n < nodes; ++n)
    for (int m = 0; m < deflections.steps; m += group_)
      for (int j = 0; j < flutes_; ++j) {
        const double turn = static_cast<double>(m + j * deflections.steps) / (deflections.steps * flutes_);
        const double phi = 2 * kPi * turn + deflections.node_height_mm[n] * envelope.lag_per_mm;
        const int centre = static_cast<int>(std::floor((phi + kPi) / sector)) & (StampDeflection::kSectors - 1);
        centre_.push_back(static_cast<std::uint8_t>(centre));
      }
}

namespace {

bool all_zero(const float* values, int count) {
  int i = 0;
  for (std::array<std::uint64_t, 4> words{}; i + 8 <= count; i += 8) {
    std::memcpy(words.data(), values + i, sizeof(words));
    if ((words[0] | words[1] | words[2] | words[3]) != 0) return false;
  }
  while (i < count && values[i] == 0) ++i;
  return i == count;
}

}  // namespace

StampDeflection StampDeflections::of(std::ptrdiff_t stamp) const {
  StampDeflection deflection{deflections_.row(stamp), 0, {}, deflections_.largest_axial_mm(stamp)};
  float largest2 = 0;
  const auto half_sector = static_cast<float>(kPi / StampDeflection::kSectors);
  static const SectorTable table;
  constexpr float kNone = -std::numeric_limits<float>::infinity();
  std::uint32_t without = 0;                        // sectors where edges pass without a deflection
  std::array<float, SectorTable::kPadded> outward;  // from sector -kSectors / 2 on
  outward.fill(kNone);
  deflection.outward_mm.fill(kNone);
  const std::uint8_t* centre = centre_.data();
  for (std::size_t n = 0; n < deflections_.nodes(); ++n)
    for (int m = 0; m < deflections_.steps; m += group_, centre += flutes_) {
      const float* v = deflection.row + 2 * (static_cast<int>(n) * deflections_.steps + m);
      const int count = std::min(group_, deflections_.steps - m);
      // The others of a group lie within `apart` of its first.
      float longest2 = 0, apart2 = 0;
      const int not_zero = all_zero(v, 2 * count) ? 0 : count;  // most of a row is
      for (int i = 0; i < not_zero; ++i) {
        const float x = v[2 * i], y = v[2 * i + 1], dx = x - v[0], dy = y - v[1];
        longest2 = std::max(longest2, x * x + y * y);
        apart2 = std::max(apart2, dx * dx + dy * dy);
      }
      if (longest2 == 0) {
        for (int j = 0; j < flutes_; ++j) without |= std::rotl(spread_sectors_, centre[j]);
        continue;
      }
      largest2 = std::max(largest2, longest2);
      const float more = half_sector * std::sqrt(longest2) + std::sqrt(apart2);
      for (int j = 0; j < flutes_; ++j) {
        const int first = centre[j] - spread_ + StampDeflection::kSectors / 2;
        for (int o = first; o <= first + 2 * spread_; ++o)
          outward[o] = std::max(outward[o], v[0] * table.cosine[o] + v[1] * table.sine[o] + more);
      }
    }
  for (int o = 0; o < SectorTable::kPadded; ++o) {
    float& of_sector = deflection.outward_mm[(o + StampDeflection::kSectors / 2) & (StampDeflection::kSectors - 1)];
    of_sector = std::max(of_sector, outward[o]);
  }
  for (int i = 0; i < StampDeflection::kSectors; ++i) {
    float& of_sector = deflection.outward_mm[static_cast<std::size_t>(i)];
    if ((without >> i & 1u) != 0 || of_sector == kNone) of_sector = std::max(of_sector, 0.0f);
  }
  deflection.largest_mm = std::sqrt(static_cast<double>(largest2));
  if (deflection.axial_mm > 0) {
    for (float& outwards : deflection.outward_mm) outwards += static_cast<float>(deflection.axial_mm);
    deflection.largest_mm = std::hypot(deflection.largest_mm, deflection.axial_mm);
  }
  return deflection;
}

}  // namespace camber::removal
