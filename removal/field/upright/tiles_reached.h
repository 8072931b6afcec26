#pragma once
// Which tiles of the stock a cutter comes near.
#include <algorithm>
#include <cmath>
#include <optional>

#include "removal/cutter.h"
#include "removal/field/slot_map.h"
#include "removal/field/tile.h"

namespace camber::removal::upright {

/// Height above the tip from which on the cutter is within `reach_mm` of a place that is `rho_mm` from its axis; none
/// where it is nowhere. A rounded cylinder.
inline std::optional<double> lowest_within(const CutterShape& shape, double rho_mm, double reach_mm) {
  const double around = std::max(0.0, rho_mm - shape.bottom_length_mm()), r = shape.corner_radius_mm + reach_mm;
  if (around > r) return std::nullopt;
  return shape.corner_radius_mm - std::sqrt(r * r - around * around);
}

/// Calls f(place in slots.all()) for every tile of `slots` that the cutter with its tip at `tip` comes within
/// `reach_mm` of; a cutter has no upper end.
template <class Function>
void for_each_tile_reached(const SlotMap& slots, double voxel_mm, const CutterShape& shape, const Vec3& tip,
                           double reach_mm, Function f) {
  const double tile_mm = Tile::kCore * voxel_mm, around = shape.radius_mm + reach_mm;
  const Index3 from = tile_of(tip - Vec3(around, around, reach_mm), tile_mm),
               to = tile_of(tip + Vec3(around, around, 0), tile_mm);
  const Index3 first = slots.first(), n = slots.extent();
  const auto gap = [&](int tile, int a) {
    return std::max({tile * tile_mm - tip[a], tip[a] - (tile + 1) * tile_mm, 0.0});
  };
  for (int i = std::max(from[0], first[0]); i <= std::min(to[0], first[0] + n[0] - 1); ++i)
    for (int j = std::max(from[1], first[1]); j <= std::min(to[1], first[1] + n[1] - 1); ++j) {
      const double rho = std::sqrt(gap(i, 0) * gap(i, 0) + gap(j, 1) * gap(j, 1));
      int lowest = std::max(from[2], first[2]);
      if (!shape.general) {
        constexpr double kRounding = 1e-9;
        const auto z = lowest_within(shape, rho, reach_mm);
        if (!z) continue;
        lowest = std::max(lowest, static_cast<int>(std::ceil((tip.z() + *z) / tile_mm - kRounding)) - 1);
      }
      for (int l = first[2] + n[2] - 1; l >= lowest; --l) {
        // Lower tiles are farther away.
        if (shape.general && shape.distance_mm({rho, 0, (l + 1) * tile_mm - tip.z()}) > reach_mm) break;
        f(slots.place(i, j, l));
      }
    }
}

}  // namespace camber::removal::upright
