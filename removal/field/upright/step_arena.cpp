#include "removal/field/upright/step_arena.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "removal/field/upright/tiles_reached.h"

namespace camber::removal::upright {
namespace {

/// Tiles that the reach of one tip can touch along an axis.
std::size_t tiles_across(double length_mm, double tile_mm) {
  return static_cast<std::size_t>(std::ceil(length_mm / tile_mm)) + 1;
}

/// Tiles that are kept for each that a stamp has come near at most.
constexpr std::size_t kKept = 3;

}  // namespace

StepArena::StepArena(const Stock& stock, const CutterShape& shape, const Vec3& min_tip_mm, const Vec3& max_tip_mm) {
  voxel_ = stock.voxel_mm();
  const double tile_mm = Tile::kCore * voxel_, band = stock.band_mm(), around = shape.radius_mm + band;
  const Vec3 bands = Vec3::Constant(band);
  const Vec3 lo = (min_tip_mm - Vec3(around, around, band)).cwiseMax(stock.min_mm() - bands);
  Vec3 hi = (max_tip_mm + Vec3(around, around, 0)).cwiseMin(stock.max_mm() + bands);
  hi.z() = stock.max_mm().z() + band;
  slots_.reset(tile_of(lo, tile_mm), tile_of(hi, tile_mm));
  std::ranges::fill(slots_.all(), 0);
  air_.assign(slots_.all().size(), 0);
  is_lowered_.assign(slots_.all().size() / static_cast<std::size_t>(std::max(1, slots_.extent()[2])), 0);
  tops_.reset(slots_);
  const std::size_t side = tiles_across(2 * around, tile_mm);
  near_bound_ = std::min(side * side * static_cast<std::size_t>(std::max(1, slots_.extent()[2])), slots_.all().size());
  make_room((kKept + 2) * near_bound_ + 1);
  take_number({});  // the air
  tiles_[0].distance.fill(static_cast<float>(band));
  tiles_[0].stamp.fill(Stock::kUncut);
}

/// Where there is something, a tile of its own.
void StepArena::load(std::size_t place, const Stock& stock, const Stock& blank) {
  const Index3 index = slots_.tile_at(place);
  if (stock.is_air(index)) {
    air_[place] = 1;
    return;
  }
  const std::size_t number = take_number(index);
  assert(number < room_);
  slots_.all()[place] = static_cast<std::int32_t>(number);
  if (last_near_.size() <= number) last_near_.resize(number + 1), layers_found_.resize(number + 1);
  last_near_[number] = stamps_;
  layers_found_[number] = read_fields(number, stock, &blank) ? 0 : Tile::kCore;
  if (layers_found_[number] == 0) unfinished_.push_back(number);
  fresh_.push_back(number);
  ++there_;
}

/// False where all are known.
bool StepArena::find_some_edges(const Stock& blank) {
  constexpr int kLayers = 4;
  while (!unfinished_.empty() && layers_found_[unfinished_.front()] >= Tile::kCore) unfinished_.pop_front();
  if (unfinished_.empty()) return false;
  const std::size_t tile = unfinished_.front();
  for (int k = 0; k < kLayers && layers_found_[tile] < Tile::kCore; ++k) find_edges(tile, layers_found_[tile]++, blank);
  return true;
}

void StepArena::find_all_edges(std::size_t tile, const Stock& blank) {
  while (layers_found_[tile] < Tile::kCore) find_edges(tile, layers_found_[tile]++, blank);
}

std::span<const std::int32_t> StepArena::reach(const Stock& stock, const Stock& blank, const CutterShape& shape,
                                               const Vec3& tip_mm) {
  ++stamps_;
  fresh_.clear(), tiles_of_stamp_.clear();
  for_each_tile_reached(slots_, voxel_, shape, tip_mm, stock.band_mm(), [&](std::size_t place) {
    if (air_[place] != 0) return;
    if (slots_.all()[place] == 0) load(place, stock, blank);
    const std::int32_t tile = slots_.all()[place];
    if (tile == 0) return;
    find_all_edges(static_cast<std::size_t>(tile), blank);
    last_near_[static_cast<std::size_t>(tile)] = stamps_;
    tiles_of_stamp_.push_back(tile);
  });
  for (const std::size_t t : fresh_) share_upper_layer(t, [](std::size_t) { return false; });
  most_near_ = std::max(most_near_, tiles_of_stamp_.size());
  return tiles_of_stamp_;
}

void StepArena::approach(const Stock& stock, const Stock& blank, const CutterShape& shape, const Vec3& tip_mm,
                         int most) {
  fresh_.clear();
  const auto find_edges_so_far = [&] {
    while (most > 0 && find_some_edges(blank)) --most;
  };
  find_edges_so_far();
  if (there_ > (kKept + 1) * near_bound_) return;
  for_each_tile_reached(slots_, voxel_, shape, tip_mm, stock.band_mm(), [&](std::size_t place) {
    if (most > 0 && air_[place] == 0 && slots_.all()[place] == 0) load(place, stock, blank), --most;
  });
  for (const std::size_t t : fresh_) share_upper_layer(t, [](std::size_t) { return false; });
  find_edges_so_far();
}

void StepArena::lowered(std::size_t tile) {
  const Index3& index = index_[tile];
  const std::size_t column = column_of(slots_.place(index[0], index[1], index[2]));
  if (is_lowered_[column] != 0) return;
  is_lowered_[column] = 1;
  lowered_.push_back(column);
}

void StepArena::read_a_top(int reach_voxels, const std::function<const ColumnCover&(std::size_t)>& cover_of) {
  if (lowered_.empty()) return;
  const std::size_t column = lowered_.front(), n = static_cast<std::size_t>(slots_.extent()[2]);
  lowered_.pop_front();
  is_lowered_[column] = 0;
  covers_.clear();
  for (std::size_t place = (column + 1) * n; place-- > column * n;) {
    const std::int32_t tile = slots_.all()[place];
    if (tile == 0 && air_[place] == 0) break;
    covers_.push_back(tile == 0 ? nullptr : &cover_of(static_cast<std::size_t>(tile)));
  }
  const auto ny = static_cast<std::size_t>(slots_.extent()[1]);
  tops_.read_column(slots_, reach_voxels, static_cast<int>(column / ny), static_cast<int>(column % ny), covers_);
}

std::optional<std::size_t> StepArena::to_give_up(Keep keep) const {
  const std::size_t kept = keep == Keep::some   ? kKept * most_near_
                           : keep == Keep::more ? kKept * near_bound_
                                                : (kKept + 1) * near_bound_;
  if (there_ <= kept) return std::nullopt;
  std::size_t oldest = 0;
  for (std::size_t t = 1; t < used_.size(); ++t)
    if (used_[t] != 0 && (oldest == 0 || last_near_[t] < last_near_[oldest])) oldest = t;
  return oldest;
}

void StepArena::give_up(std::size_t t, bool is_air) {
  const Index3& index = index_[t];
  const std::size_t place = slots_.place(index[0], index[1], index[2]);
  slots_.all()[place] = 0;
  if (is_air) air_[place] = 1;
  layers_found_[t] = Tile::kCore;
  used_[t] = 0;
  free_.push_back(t);
  --there_;
}

}  // namespace camber::removal::upright
