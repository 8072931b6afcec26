#pragma once
// Which tiles of the stock a cutter comes near.
#include <algorithm>

#include "removal/carve.h"
#include "removal/cutter.h"
#include "removal/slot_map.h"

namespace camber::removal {

/// Calls f(place in slots.all()) for every tile of `slots` that the cutter with its tip at `tip` comes within
/// `reach_mm` of; a cutter has no upper end.
template <class Function>
void for_each_tile_reached(const SlotMap& slots, double voxel_mm, const CutterShape& shape, const Vec3& tip,
                           double reach_mm, Function f) {
  const double tile_mm = Tile::kCore * voxel_mm, around = shape.radius_mm + reach_mm;
  const Index3 from = tile_of(tip - Vec3(around, around, reach_mm), tile_mm),
               to = tile_of(tip + Vec3(around, around, 0), tile_mm);
  const Index3 first = slots.first(), n = slots.extent();
  for (int i = std::max(from[0], first[0]); i <= std::min(to[0], first[0] + n[0] - 1); ++i)
    for (int j = std::max(from[1], first[1]); j <= std::min(to[1], first[1] + n[1] - 1); ++j)
      for (int l = first[2] + n[2] - 1; l >= std::max(from[2], first[2]); --l) {
        // Lower tiles are farther away.
        if (tile_distance_mm({i, j, l}, voxel_mm, shape, tip) > reach_mm) break;
        f(slots.place(i, j, l));
      }
}

}  // namespace camber::removal
