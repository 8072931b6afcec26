#include "removal/tile_arena.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "removal/carve.h"

namespace camber::removal {
namespace {

Index3 first_voxel(const Index3& tile) { return {tile[0] * Tile::kCore, tile[1] * Tile::kCore, tile[2] * Tile::kCore}; }

}  // namespace

void TileArena::load(const Stock& stock, const Stock& blank, const CutterShape& shape, std::span<const Stamp> stamps) {
  voxel_ = stock.voxel_mm();
  list_tiles(stock, shape, stamps);
  load_tiles(stock, blank);
}

void TileArena::list_tiles(const Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps) {
  reached_.resize(stamps.size());
  for (auto& tiles : reached_) tiles.clear();
  const double tile_mm = Tile::kCore * voxel_, band = stock.band_mm(), reach = shape.radius_mm + band;
  Vec3 lo = stamps.front().tip_mm, hi = lo;
  for (const auto& s : stamps) {
    lo = lo.cwiseMin(s.tip_mm);
    hi = hi.cwiseMax(s.tip_mm);
  }
  lo -= Vec3(reach, reach, band);
  hi = Vec3(hi.x() + reach, hi.y() + reach, stock.max_mm().z() + band);
  const Vec3 bands = Vec3::Constant(band);
  slots_.reset(tile_of(lo.cwiseMax(stock.min_mm() - bands), tile_mm),
               tile_of(hi.cwiseMin(stock.max_mm() + bands), tile_mm));
  const Index3 first = slots_.first(), n = slots_.extent();
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    const Vec3& tip = stamps[k].tip_mm;
    const Index3 from = tile_of(tip - Vec3(reach, reach, band), tile_mm),
                 to = tile_of(tip + Vec3(reach, reach, 0), tile_mm);
    for (int i = std::max(from[0], first[0]); i <= std::min(to[0], first[0] + n[0] - 1); ++i)
      for (int j = std::max(from[1], first[1]); j <= std::min(to[1], first[1] + n[1] - 1); ++j)
        for (int l = first[2] + n[2] - 1; l >= std::max(from[2], first[2]); --l) {
          // Lower tiles are farther away.
          if (tile_distance_mm({i, j, l}, voxel_, shape, tip) > band) break;
          reached_[k].push_back(static_cast<std::int32_t>(slots_.place(i, j, l)));
        }
  });
  // Numbers in the order of places, so that nothing depends on the number of threads.
  auto& slot = slots_.all();
  for (const auto& places : reached_)
    for (const std::int32_t p : places) slot[static_cast<std::size_t>(p)] = 0;
  index_.assign(1, {});
  for (std::size_t p = 0; p < slot.size(); ++p) {
    if (slot[p] == 0 && !stock.is_air(slots_.tile_at(p))) {
      slot[p] = static_cast<std::int32_t>(index_.size());
      index_.push_back(slots_.tile_at(p));
    } else {
      slot[p] = 0;
    }
  }
  tbb::parallel_for(std::size_t{0}, reached_.size(), [&](std::size_t k) {
    auto& tiles = reached_[k];
    for (std::int32_t& t : tiles) t = slot[static_cast<std::size_t>(t)];
    std::erase(tiles, 0);
  });
}

void TileArena::load_tiles(const Stock& stock, const Stock& blank) {
  count_ = index_.size();
  if (count_ > room_) {
    room_ = count_ + count_ / 8;
    tiles_.reset();
    tiles_.reset(new Tile[room_]);
  }
  tiles_[0].distance.fill(static_cast<float>(stock.band_mm()));
  tiles_[0].stamp.fill(Stock::kUncut);
  blank_.assign(count_, -1);
  tbb::parallel_for(std::size_t{1}, count_, [&](std::size_t t) {
    stock.load(index_[t], tiles_[t]);
    blank_[t] = blank.is_solid(index_[t]) ? -1 : 0;
  });
  std::int32_t count = 0;
  for (std::int32_t& b : blank_)
    if (b == 0) b = count++;
  blanks_.resize(static_cast<std::size_t>(count) * Tile::kVolume);
  tbb::parallel_for(std::size_t{1}, count_, [&](std::size_t t) {
    if (blank_[t] >= 0)
      blank.read(first_voxel(index_[t]), Tile::kSide,
                 blanks_.data() + static_cast<std::size_t>(blank_[t]) * Tile::kVolume, nullptr);
  });
}

ArenaView TileArena::view() const {
  static_assert(sizeof(Tile) == 2 * sizeof(float) * Tile::kVolume);
  static constexpr std::int32_t kAir = 0;  // read, and not used, where no stamp comes near the stock
  return {tiles_[0].distance.data(),
          tiles_[0].stamp.data(),
          2 * Tile::kVolume,
          slots_.all().empty() ? &kAir : slots_.all().data(),
          {slots_.extent()[0], slots_.extent()[1], slots_.extent()[2]}};
}

StampPlace TileArena::place_of(const Stamp& stamp, double least_mm) const {
  StampPlace place{};
  for (int a = 0; a < 3; ++a) {
    const double at = stamp.tip_mm[a] / voxel_, base = std::floor(at);
    place.fraction[a] = static_cast<float>(at - base);
    place.base[a] = static_cast<std::int32_t>(base) - slots_.first()[static_cast<std::size_t>(a)] * Tile::kCore;
    place.feed_mm[a] = static_cast<float>(stamp.feed_per_tooth_mm[a]);
  }
  place.per_voxel = static_cast<float>(1 / voxel_);
  place.feed_length_mm = static_cast<float>(stamp.feed_per_tooth_mm.norm());
  place.least_mm = static_cast<float>(least_mm);
  return place;
}

}  // namespace camber::removal
