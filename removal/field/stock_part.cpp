#include "removal/stock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "removal/field/tile.h"

namespace camber::removal {
namespace {

constexpr std::size_t kAtOnce = 512;  // tiles in memory

/// Calls f(n, offset) for every voxel of a tile's core.
template <class Function>
void for_each_voxel(Function f) {
  std::size_t n = 0;
  for (int i = 0; i < Tile::kCore; ++i)
    for (int j = 0; j < Tile::kCore; ++j)
      for (int k = 0; k < Tile::kCore; ++k) f(n++, static_cast<std::size_t>(Tile::offset(i, j, k)));
}

}  // namespace

bool Region::meets(const Index3& tile, double voxel_mm) const {
  for (int a = 0; a < 3; ++a) {
    const double from = tile[static_cast<std::size_t>(a)] * kTileVoxels * voxel_mm;
    if (from > max_mm[a] || from + kTileVoxels * voxel_mm < min_mm[a]) return false;
  }
  return true;
}

std::vector<Index3> Region::tiles_of(const Stock& stock) const {
  const double tile_mm = kTileVoxels * stock.voxel_mm();
  const Vec3 lo = min_mm.cwiseMax(stock.min_mm() - Vec3::Constant(stock.band_mm())),
             hi = max_mm.cwiseMin(stock.max_mm() + Vec3::Constant(stock.band_mm()));
  Index3 from{}, to{};
  for (std::size_t a = 0; a < 3; ++a) {
    from[a] = static_cast<int>(std::floor(lo[static_cast<int>(a)] / tile_mm));
    to[a] = static_cast<int>(std::floor(hi[static_cast<int>(a)] / tile_mm));
    if (to[a] < from[a]) return {};
  }
  const auto layers = static_cast<std::size_t>(to[0] - from[0] + 1);
  std::vector<std::vector<Index3>> of_layer(layers);
  tbb::parallel_for(std::size_t{0}, layers, [&](std::size_t layer) {
    const int i = from[0] + static_cast<int>(layer);
    for (int j = from[1]; j <= to[1]; ++j)
      for (int k = from[2]; k <= to[2]; ++k)
        if (!stock.is_air({i, j, k})) of_layer[layer].push_back({i, j, k});
  });
  std::vector<Index3> out;
  for (const auto& some : of_layer) out.insert(out.end(), some.begin(), some.end());
  return out;
}

StockPart::StockPart(const Stock& cut, const Stock& before, const Region& reach,
                     std::optional<std::array<std::int32_t, 2>> stamps) {
  const std::vector<Index3> tiles = reach.tiles_of(before);
  const auto band = static_cast<float>(cut.band_mm());
  const auto counts = [&](std::int32_t stamp) {
    return stamps ? stamp >= (*stamps)[0] && stamp < (*stamps)[1] : stamp != Stock::kUncut;
  };
  struct Found {
    OfTile tile;
    std::vector<float> distance;
    std::vector<std::int32_t> stamp;
    bool any = false;
  };
  std::vector<Found> found(std::min(kAtOnce, tiles.size()));
  for (std::size_t from = 0; from < tiles.size(); from += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, tiles.size() - from);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      cancellation_point();
      Found& f = found[i];
      f = {};
      f.tile.index = tiles[from + i];
      if (cut.is_solid(f.tile.index)) return;
      const auto tile = std::make_unique<Tile>(), was = std::make_unique<Tile>();
      cut.load(f.tile.index, *tile);
      before.load(f.tile.index, *was);
      for_each_voxel([&](std::size_t n, std::size_t at) {
        const float d = tile->distance[at];
        if (d >= band) {
          if (was->distance[at] >= band) return;
          f.tile.air.set(n);
        } else if (counts(tile->stamp[at])) {
          f.tile.cut.set(n);
          f.distance.push_back(d);
          f.stamp.push_back(tile->stamp[at]);
        } else {
          return;
        }
        f.any = true;
      });
    });
    for (std::size_t i = 0; i < count; ++i) {
      if (!found[i].any) continue;
      tile_.push_back(found[i].tile);
      tile_.back().first = distance_.size();
      distance_.insert(distance_.end(), found[i].distance.begin(), found[i].distance.end());
      stamp_.insert(stamp_.end(), found[i].stamp.begin(), found[i].stamp.end());
    }
  }
}

void StockPart::join_to(Stock& stock, const Region* within, bool stamps) const {
  const auto band = static_cast<float>(stock.band_mm());
  std::vector<std::size_t> which;
  for (std::size_t t = 0; t < tile_.size(); ++t)
    if (!within || within->meets(tile_[t].index, stock.voxel_mm())) which.push_back(t);
  std::vector<Tile> tiles(std::min(kAtOnce, which.size()));
  std::vector<char> changed(tiles.size());
  for (std::size_t from = 0; from < which.size(); from += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, which.size() - from);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      cancellation_point();
      const OfTile& part = tile_[which[from + i]];
      Tile& tile = tiles[i];
      stock.load(part.index, tile);
      changed[i] = 0;
      std::size_t next = part.first;
      for_each_voxel([&](std::size_t n, std::size_t at) {
        float d = band;
        std::int32_t stamp = Stock::kUncut;
        if (part.cut.has(n)) {
          d = distance_[next];
          stamp = stamps ? stamp_[next] : Stock::kUncut;
          ++next;
        } else if (!part.air.has(n)) {
          return;
        }
        if (!(d > tile.distance[at])) return;
        tile.distance[at] = d;
        tile.stamp[at] = stamp;
        changed[i] = 1;
      });
    });
    std::vector<Stock::StoredTile> stored;
    for (std::size_t i = 0; i < count; ++i)
      if (changed[i] != 0) stored.push_back({tile_[which[from + i]].index, &tiles[i]});
    stock.store(stored);
  }
}

StockPart StockPart::within(const Region& region, double voxel_mm) const {
  StockPart kept;
  for (std::size_t t = 0; t < tile_.size(); ++t) {
    if (!region.meets(tile_[t].index, voxel_mm)) continue;
    const auto from = static_cast<std::ptrdiff_t>(tile_[t].first);
    const auto end = static_cast<std::ptrdiff_t>(t + 1 < tile_.size() ? tile_[t + 1].first : distance_.size());
    kept.tile_.push_back(tile_[t]);
    kept.tile_.back().first = kept.distance_.size();
    kept.distance_.insert(kept.distance_.end(), distance_.begin() + from, distance_.begin() + end);
    kept.stamp_.insert(kept.stamp_.end(), stamp_.begin() + from, stamp_.begin() + end);
  }
  return kept;
}

StockPart::StockPart(std::span<const StockPart* const> parts) {
  std::map<Index3, std::vector<std::pair<const StockPart*, std::size_t>>> tiles;
  for (const StockPart* part : parts)
    for (std::size_t t = 0; t < part->tile_.size(); ++t) tiles[part->tile_[t].index].emplace_back(part, t);
  for (const auto& [index, of_parts] : tiles) add_joined(index, of_parts);
}

/// `parts`: each with its number of the tile, in the order in which they are joined. Of equal values the first stays.
void StockPart::add_joined(const Index3& index, std::span<const std::pair<const StockPart*, std::size_t>> parts) {
  OfTile out;
  out.index = index;
  out.first = distance_.size();
  std::array<float, kVoxels> distance{};
  std::array<std::int32_t, kVoxels> stamp{};
  for (const auto& [part, t] : parts) {
    const OfTile& tile = part->tile_[t];
    std::size_t next = tile.first;
    for (std::size_t n = 0; n < kVoxels; ++n) {
      if (tile.air.has(n)) out.air.set(n);
      if (!tile.cut.has(n)) continue;
      const std::size_t at = next++;
      if (out.cut.has(n) && !(part->distance_[at] > distance[n])) continue;
      out.cut.set(n);
      distance[n] = part->distance_[at];
      stamp[n] = part->stamp_[at];
    }
  }
  for (std::size_t w = 0; w < out.cut.bits.size(); ++w) out.cut.bits[w] &= ~out.air.bits[w];
  for (std::size_t n = 0; n < kVoxels; ++n) {
    if (!out.cut.has(n)) continue;
    distance_.push_back(distance[n]);
    stamp_.push_back(stamp[n]);
  }
  tile_.push_back(out);
}

void StockPart::write(ByteWriter& out) const {
  out.list(tile_);
  out.list(distance_);
  out.list(stamp_);
}

StockPart StockPart::read(ByteReader& in) {
  StockPart out;
  out.tile_ = in.list<OfTile>();
  out.distance_ = in.list<float>();
  out.stamp_ = in.list<std::int32_t>();
  if (out.distance_.size() != out.stamp_.size()) throw BytesMissing();
  std::uint64_t cut = 0;
  for (const OfTile& t : out.tile_) {
    if (t.first != cut) throw BytesMissing();
    for (const std::uint64_t word : t.cut.bits) cut += static_cast<std::uint64_t>(__builtin_popcountll(word));
  }
  if (cut != out.distance_.size()) throw BytesMissing();
  return out;
}

double largest_difference_mm(const Stock& a, const Stock& b, const Region& region) {
  std::vector<Index3> tiles = region.tiles_of(a);
  const std::vector<Index3> others = region.tiles_of(b);
  tiles.insert(tiles.end(), others.begin(), others.end());
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  std::erase_if(tiles, [&](const Index3& t) { return a.is_solid(t) && b.is_solid(t); });
  const auto near = static_cast<float>(a.voxel_mm());
  std::vector<float> largest(tiles.size(), 0.0f);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const auto of_a = std::make_unique<Tile>(), of_b = std::make_unique<Tile>();
    a.load(tiles[t], *of_a);
    b.load(tiles[t], *of_b);
    for_each_voxel([&](std::size_t, std::size_t at) {
      const float x = of_a->distance[at], y = of_b->distance[at];
      if (std::min(std::abs(x), std::abs(y)) <= near) largest[t] = std::max(largest[t], std::abs(x - y));
    });
  });
  float out = 0;
  for (const float v : largest) out = std::max(out, v);
  return static_cast<double>(out);
}

void JoinedParts::add(StockPart part) {
  groups_.push_back({std::move(part)});
  while (groups_.size() > 1 && groups_[groups_.size() - 2].of == groups_.back().of) join_last_two();
}

StockPart JoinedParts::take() {
  if (groups_.empty()) return {};
  while (groups_.size() > 1) join_last_two();
  StockPart out = std::move(groups_.back().part);
  groups_.clear();
  return out;
}

void JoinedParts::join_last_two() {
  Group& first = groups_[groups_.size() - 2];
  const std::array<const StockPart*, 2> both{&first.part, &groups_.back().part};
  StockPart joined(both);
  first = {std::move(joined), first.of + groups_.back().of};
  groups_.pop_back();
}

}  // namespace camber::removal
