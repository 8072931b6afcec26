#pragma once
// Tiles that were cut go back to the stock.
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "removal/carve.h"
#include "removal/tile_arena.h"

namespace camber::removal {

/// Writes those of the tiles that have changed to the stock, and forgets all. `tiles`, by number: each with `changed`
/// and `material`, in voxels, as it was loaded. The volume that was taken, mm^3.
template <class CutTile>
double store_cut(Stock& stock, TileArena& arena, std::span<const std::size_t> numbers,
                 std::vector<std::optional<CutTile>>& tiles) {
  std::vector<Stock::StoredTile> changed;
  for (const std::size_t t : numbers)
    if (tiles[t]->changed) changed.push_back({arena.index(t), &arena[t]});
  stock.store(changed);
  const double voxel = stock.voxel_mm();
  std::vector<double> taken(numbers.size(), 0.0);  // voxels
  tbb::parallel_for(std::size_t{0}, numbers.size(), [&](std::size_t i) {
    auto& tile = tiles[numbers[i]];
    if (tile->changed) taken[i] = tile->material - material_voxels(arena[numbers[i]], voxel);
    tile.reset();
  });
  double volume = 0;
  for (const double voxels : taken) volume += voxels * std::pow(voxel, 3);
  return volume;
}

}  // namespace camber::removal
