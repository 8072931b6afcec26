#pragma once
// Tiles of the stock while they are cut: what both engagers do with them.
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/tile_arena.h"

namespace camber::removal::upright {

/// Begins with the tiles that the arena has loaded last. `tiles`, by number: begin with `cover` and `material`, in
/// voxels.
template <class CutTile>
void load_cut(const Stock& stock, TileArena& arena, const CutterShape& shape, const ColumnCover::TipOf& tip_of,
              std::vector<std::optional<CutTile>>& tiles) {
  if (tiles.size() < arena.size()) tiles.resize(arena.size());
  const auto fresh = arena.fresh();
  tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t i) {
    cancellation_point();
    const std::size_t t = fresh[i];
    tiles[t].emplace(CutTile{ColumnCover(arena[t], arena.index(t), stock.voxel_mm(), stock.band_mm(), shape, tip_of),
                             material_voxels(arena[t], stock.voxel_mm())});
  });
}

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

}  // namespace camber::removal::upright
