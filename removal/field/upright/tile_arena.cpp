#include "removal/field/upright/tile_arena.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "removal/field/tilted/tiles_reached.h"
#include "removal/field/upright/tiles_reached.h"

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

namespace {

Index3 first_voxel(const Index3& tile) { return {tile[0] * Tile::kCore, tile[1] * Tile::kCore, tile[2] * Tile::kCore}; }

}  // namespace

/// The part of a tile's upper layer that is the core of a neighbour, `up` tiles on. What the stock has there is old
/// where the neighbour stayed.
void TileArena::copy_shared(const Tile& from, const std::array<int, 3>& up, Tile& to) {
  const auto range = [](int up) { return up != 0 ? 1 : Tile::kCore; };
  for (int i = 0; i < range(up[0]); ++i)
    for (int j = 0; j < range(up[1]); ++j) {
      const int there = Tile::offset(i, j, 0);
      const int here = Tile::offset(i + up[0] * Tile::kCore, j + up[1] * Tile::kCore, up[2] * Tile::kCore);
      std::copy_n(from.distance.data() + there, range(up[2]), to.distance.data() + here);
      std::copy_n(from.stamp.data() + there, range(up[2]), to.stamp.data() + here);
    }
}

void TileArena::load(const Stock& stock, const Stock* blank, const CutterShape& shape, std::span<const Stamp> stamps,
                     const Leave& leave, double deflection_mm) {
  voxel_ = stock.voxel_mm();
  list_tiles(stock, shape, stamps, leave, deflection_mm);
  tops_.reset(slots_);
  make_room(used_.size());
  load_fresh(stock, blank);
}

void TileArena::clear(const Leave& leave) {
  std::vector<std::size_t> all;
  for (std::size_t t = 1; t < used_.size(); ++t)
    if (used_[t] != 0) all.push_back(t);
  leave(all);
  if (!used_.empty()) used_.resize(1), in_solid_.resize(1), index_.resize(1);
  free_.clear();
  fresh_.clear();
  slots_ = {};
}

std::size_t TileArena::take_number(const Index3& index) {
  std::size_t t = used_.size();
  if (free_.empty()) {
    used_.push_back(1), in_solid_.push_back(1), index_.push_back(index);
  } else {
    t = free_.back();
    free_.pop_back();
    used_[t] = 1, index_[t] = index;
  }
  return t;
}

/// A box around all tiles that the stamps reach, within the stock.
void TileArena::reset_slots(const Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps,
                            double reach_mm) {
  const double tile_mm = Tile::kCore * voxel_, around = shape.radius_mm + reach_mm;
  const Vec3 bands = Vec3::Constant(reach_mm);
  const tilted::ReachedBox within{stock.min_mm() - bands, stock.max_mm() + bands};
  const auto bounds_of = [&](const ToolPose& pose) {
    if (!pose.upright()) return tilted::bounds_in(shape, pose, reach_mm, within);
    const Vec3& tip = pose.tip_mm;
    return tilted::ReachedBox{tip - Vec3(around, around, reach_mm),
                              {tip.x() + around, tip.y() + around, within.hi.z()}};
  };
  auto [lo, hi] = bounds_of(stamps.front().pose);
  for (const auto& s : stamps) {
    const tilted::ReachedBox own = bounds_of(s.pose);
    lo = lo.cwiseMin(own.lo), hi = hi.cwiseMax(own.hi);
  }
  slots_.reset(tile_of(lo.cwiseMax(within.lo), tile_mm), tile_of(hi.cwiseMin(within.hi), tile_mm));
}

void TileArena::list_tiles(const Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps,
                           const Leave& leave, double deflection_mm) {
  reached_.resize(stamps.size());
  for (auto& tiles : reached_) tiles.clear();
  const double band = stock.band_mm() + deflection_mm;
  std::swap(before_, slots_);
  reset_slots(stock, shape, stamps, band);
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    const auto reach = [&](std::size_t place) { reached_[k].push_back(static_cast<std::int32_t>(place)); };
    const ToolPose& pose = stamps[k].pose;
    if (pose.upright())
      for_each_tile_reached(slots_, voxel_, shape, pose.tip_mm, band, reach);
    else
      tilted::for_each_tile_reached(slots_, voxel_, shape, pose, band, reach);
  });
  constexpr std::int32_t kWanted = 0;
  auto& slot = slots_.all();
  for (const auto& places : reached_)
    for (const std::int32_t p : places) slot[static_cast<std::size_t>(p)] = kWanted;
  std::vector<char> stays(used_.size(), 0);
  std::vector<std::size_t> wanted;  // places
  for (std::size_t p = 0; p < slot.size(); ++p) {
    if (slot[p] != kWanted) continue;
    const Index3 tile = slots_.tile_at(p);
    const std::int32_t known = before_.find(tile[0], tile[1], tile[2]);
    if (known > 0) {
      slot[p] = known;
      stays[static_cast<std::size_t>(known)] = 1;
    } else {
      wanted.push_back(p);
    }
  }
  std::vector<std::size_t> leaving;
  for (std::size_t t = 1; t < used_.size(); ++t)
    if (used_[t] != 0 && stays[t] == 0) leaving.push_back(t);
  leave(leaving);
  for (const std::size_t t : leaving) {
    used_[t] = 0;
    free_.push_back(t);
  }
  if (used_.empty()) take_number({});  // the air
  // In the order of places, so that nothing depends on the number of threads.
  fresh_.clear();
  for (const std::size_t p : wanted) {
    const Index3 tile = slots_.tile_at(p);
    if (stock.is_air(tile)) continue;
    fresh_.push_back(take_number(tile));
    slot[p] = static_cast<std::int32_t>(fresh_.back());
  }
  for (std::int32_t& s : slot) s = std::max(s, 0);
  tbb::parallel_for(std::size_t{0}, reached_.size(), [&](std::size_t k) {
    auto& tiles = reached_[k];
    for (std::int32_t& t : tiles) t = slot[static_cast<std::size_t>(t)];
    std::erase(tiles, 0);
  });
}

void TileArena::make_room(std::size_t tiles_wanted) {
  if (tiles_wanted <= room_) return;
  const std::size_t before = room_;
  room_ = tiles_wanted + tiles_wanted / 8;
  std::unique_ptr<Tile[]> tiles(new Tile[room_]);
  std::unique_ptr<float[]> blanks(new float[room_ * Tile::kVolume]);
  std::copy_n(tiles_.get(), before, tiles.get());
  for (std::size_t t = 1; t < before; ++t)
    if (const float* from = blank(t)) std::copy_n(from, Tile::kVolume, blanks.get() + t * Tile::kVolume);
  tiles_ = std::move(tiles);
  blanks_ = std::move(blanks);
  edges_.resize(room_);
}

void TileArena::read_tile(std::size_t t, const Stock& stock, const Stock* blank) {
  if (!read_fields(t, stock, blank)) return;
  for (int layer = 0; layer < Tile::kCore; ++layer) find_edges(t, layer, *blank);
}

bool TileArena::read_fields(std::size_t t, const Stock& stock, const Stock* blank) {
  stock.load(index_[t], tiles_[t]);
  edges_[t].clear();
  in_solid_[t] = static_cast<char>(!blank || blank->is_solid(index_[t]));
  if (in_solid_[t] != 0) return false;
  blank->read(first_voxel(index_[t]), Tile::kSide, blanks_.get() + t * Tile::kVolume, nullptr);
  return true;
}

void TileArena::find_edges(std::size_t t, int layer, const Stock& blank) {
  const Index3 first = first_voxel(index_[t]);
  edges_[t].find_in_layer(layer, blanks_.get() + t * Tile::kVolume, blank.voxel_mm(), blank.band_mm(),
                          [&](const Index3& cell, float* out) {
                            blank.read({first[0] + cell[0] - 1, first[1] + cell[1] - 1, first[2] + cell[2] - 1},
                                       BlankEdges::kAround, out, nullptr);
                          });
}

void TileArena::load_fresh(const Stock& stock, const Stock* blank) {
  tiles_[0].distance.fill(static_cast<float>(stock.band_mm()));
  tiles_[0].stamp.fill(Stock::kUncut);
  tbb::parallel_for(std::size_t{0}, fresh_.size(), [&](std::size_t i) { read_tile(fresh_[i], stock, blank); });
  std::vector<char> is_fresh(used_.size(), 0);
  for (const std::size_t t : fresh_) is_fresh[t] = 1;
  tbb::parallel_for(std::size_t{0}, fresh_.size(), [&](std::size_t i) {
    share_upper_layer(fresh_[i], [&](std::size_t other) { return is_fresh[other] != 0; });
  });
}

void TileArena::read_tops(int reach_voxels, const std::function<const ColumnCover&(std::size_t)>& cover_of) {
  tops_.read(slots_, reach_voxels, [&](std::size_t place) {
    const std::int32_t tile = slots_.all()[place];
    return tile > 0 ? &cover_of(static_cast<std::size_t>(tile)) : nullptr;
  });
}

ArenaView TileArena::view() const {
  static_assert(sizeof(Tile) == 2 * sizeof(float) * Tile::kVolume);
  static constexpr std::int32_t kAir = 0;  // read, and not used, where no stamp comes near the stock
  return {tiles_[0].distance.data(),
          tiles_[0].stamp.data(),
          2 * Tile::kVolume,
          slots_.all().empty() ? &kAir : slots_.all().data(),
          {slots_.extent()[0], slots_.extent()[1], slots_.extent()[2]},
          tops_.heights().empty() ? &kAir : tops_.heights().data()};
}

StampPlace TileArena::place_of(const Stamp& stamp, double min_forward_mm) const {
  StampPlace place{};
  for (int a = 0; a < 3; ++a) {
    const double at = stamp.pose.tip_mm[a] / voxel_, base = std::floor(at);
    place.fraction[a] = static_cast<float>(at - base);
    place.base[a] = static_cast<std::int32_t>(base) - slots_.first()[static_cast<std::size_t>(a)] * Tile::kCore;
    place.feed_mm[a] = static_cast<float>(stamp.feed_per_tooth_mm[a]);
  }
  place.per_voxel = static_cast<float>(1 / voxel_);
  place.feed_length_mm = static_cast<float>(stamp.feed_per_tooth_mm.norm());
  place.min_forward_mm = static_cast<float>(min_forward_mm);
  return place;
}

}  // namespace camber::removal::upright
