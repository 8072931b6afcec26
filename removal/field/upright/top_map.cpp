#include "removal/field/upright/top_map.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

namespace camber::removal::upright {
namespace {

/// Raises a tile's squares to what one of its columns reaches; those of the next tile's first layer count as well.
void raise(const ColumnCover& cover, int from_z, std::int32_t* square, std::size_t per_x) {
  for (int i = 0; i < Tile::kSide; ++i) {
    const std::int16_t* tops = cover.tops(i);
    for (int c = std::max(0, (i - 1) / TopMap::kCell); c <= std::min(i / TopMap::kCell, TopMap::kOfTile - 1); ++c)
      for (int d = 0; d < TopMap::kOfTile; ++d) {
        std::int32_t& top = square[static_cast<std::size_t>(c) * per_x + static_cast<std::size_t>(d)];
        for (int j = d * TopMap::kCell; j <= (d + 1) * TopMap::kCell; ++j)
          if (tops[j] > 0) top = std::max(top, from_z + tops[j]);
      }
  }
}

}  // namespace

void TopMap::reset(const SlotMap& slots) {
  const Index3 n = slots.extent();
  for (auto* heights : {&own_, &around_})
    heights->assign(static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * kOfTile * kOfTile,
                    (n[2] + 1) * Tile::kCore);
}

void TopMap::read_column(const SlotMap& slots, int reach_voxels, int i, int j,
                         std::span<const ColumnCover* const> covers) {
  const Index3 n = slots.extent();
  const int nx = n[0] * kOfTile, ny = n[1] * kOfTile, reach = (reach_voxels + kCell - 1) / kCell;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y);
  };
  const int unknown = n[2] - static_cast<int>(covers.size());  // tiles, from the bottom up
  const int x0 = i * kOfTile, y0 = j * kOfTile;
  for (int x = x0; x < x0 + kOfTile; ++x)
    std::fill_n(own_.begin() + static_cast<std::ptrdiff_t>(at(x, y0)), kOfTile, unknown * Tile::kCore);
  for (int k = n[2] - 1; k >= unknown; --k)
    if (const ColumnCover* cover = covers[static_cast<std::size_t>(n[2] - 1 - k)])
      raise(*cover, k * Tile::kCore, own_.data() + at(x0, y0), static_cast<std::size_t>(ny));
  const auto within = [](int from, int count, int reach_around, int end) {
    return std::pair(std::max(0, from - reach_around), std::min(end, from + count + reach_around));
  };
  const auto [x_from, x_to] = within(x0, kOfTile, reach, nx);
  const auto [y_from, y_to] = within(y0, kOfTile, reach, ny);
  for (int x = x_from; x < x_to; ++x)
    for (int y = y_from; y < y_to; ++y) {
      const auto [a, a_end] = within(x, 1, reach, nx);
      const auto [b, b_end] = within(y, 1, reach, ny);
      std::int32_t highest = 0;
      for (int c = a; c < a_end; ++c)
        for (int d = b; d < b_end; ++d) highest = std::max(highest, own_[at(c, d)]);
      around_[at(x, y)] = highest;
    }
}

void TopMap::read(const SlotMap& slots, int reach_voxels,
                  const std::function<const ColumnCover*(std::size_t)>& cover_of) {
  const Index3 n = slots.extent(), first = slots.first();
  const int nx = n[0] * kOfTile, ny = n[1] * kOfTile, reach = (reach_voxels + kCell - 1) / kCell;
  const auto at = [&](int i, int j) {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(j);
  };
  for (auto* heights : {&own_, &across_, &around_})
    heights->assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), 0);
  tbb::parallel_for(0, n[0], [&](int i) {
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k)
        if (const ColumnCover* cover = cover_of(slots.place(first[0] + i, first[1] + j, first[2] + k)))
          raise(*cover, k * Tile::kCore, own_.data() + at(i * kOfTile, j * kOfTile), static_cast<std::size_t>(ny));
  });
  tbb::parallel_for(0, nx, [&](int i) {
    for (int j = 0; j < ny; ++j)
      for (int d = std::max(0, j - reach); d <= std::min(ny - 1, j + reach); ++d)
        across_[at(i, j)] = std::max(across_[at(i, j)], own_[at(i, d)]);
  });
  tbb::parallel_for(0, nx, [&](int i) {
    for (int c = std::max(0, i - reach); c <= std::min(nx - 1, i + reach); ++c)
      for (int j = 0; j < ny; ++j) around_[at(i, j)] = std::max(around_[at(i, j)], across_[at(c, j)]);
  });
}

}  // namespace camber::removal::upright
