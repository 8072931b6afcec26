#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "removal/engage/engaged_path.h"
#include "removal/engage/patch_reading.h"
#include "removal/engage/upright/bend_memory.h"
#include "removal/engage/upright/chip_reader.h"
#include "removal/engage/upright/patch_lanes.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/cut_tiles.h"
#include "removal/field/upright/tile_arena.h"

namespace camber::removal::upright {
namespace {

/// A tile that is being cut.
struct CutTile {
  ColumnCover cover;
  double material;  ///< volume of material when it was loaded, voxels
  bool changed = false;
  std::vector<std::int32_t> group{};  ///< stamps that are cut together and reach the tile
  bool cut = false;                   ///< whether a stamp has cut it; tip and bend are those of the last one
  Vec3 last_tip_mm = Vec3::Zero();
  double last_deflection_mm = 0;
};

class UprightDeflectedPath : public DeflectedPath {
 public:
  explicit UprightDeflectedPath(const EngagedRun& run) : run_(run) {}

  void remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double largest_mm) override;
  void start(std::size_t from, std::size_t count, const DeflectionTable& deflections) override;
  std::span<const DeflectedChipSample> read(std::size_t k) override { return reading_->read(*reader_, arena_, k); }
  std::span<const double> glance(std::size_t k, std::size_t count) override {
    return reading_->glance(*reader_, arena_, k, count, cut_);
  }
  double glance_of(std::span<const DeflectedChipSample> chips) const override { return reading_->glance_of(chips); }
  void cut(std::size_t k, std::size_t count) override;
  double commit() override {
    arena_.clear([&](auto left) { leave(left); });
    return std::exchange(removed_mm3_, 0.0);
  }

 private:
  void list_group(std::size_t k, std::size_t count);
  void cut_tile(std::size_t tile, std::size_t k, const StampDeflection& deflection);
  void leave(std::span<const std::size_t> numbers) { removed_mm3_ += store_cut(run_.stock, arena_, numbers, tiles_); }

  EngagedRun run_;
  std::size_t from_ = 0;             ///< first stamp of the stretch
  std::span<const Stamp> stamps_{};  ///< stamps of the stretch
  const DeflectionTable* deflections_ = nullptr;
  std::optional<PatchLanes> lanes_{};
  std::optional<ChipReader> reader_{};
  std::optional<PatchReading<ChipReader>> reading_{};
  TileArena arena_{};
  std::vector<std::optional<CutTile>> tiles_{};  ///< by the arena's numbers
  BendMemory memory_{};
  double removed_mm3_ = 0;        ///< volume removed from tiles given back since the last commit
  std::size_t cut_ = 0;           ///< stamps of the stretch that were cut
  double max_deflection_mm_ = 0;  ///< largest deflection of all stamps that were cut
  double max_axial_mm_ = 0;       ///< the same along the axis
  std::optional<StampDeflections> bends_{};
  std::vector<StampDeflection> group_{};  ///< stamps that are cut together
  std::vector<std::size_t> reached_{};    ///< tiles
};

void UprightDeflectedPath::remember(std::size_t from, std::span<const float> rows, std::size_t row_size,
                                    double largest_mm) {
  max_deflection_mm_ = std::max(max_deflection_mm_, largest_mm);
  memory_.add_before(from, rows, row_size);
}

void UprightDeflectedPath::start(std::size_t from, std::size_t count, const DeflectionTable& deflections) {
  const EnvelopeGrid& envelope = run_.envelope;
  assert(from >= from_ + stamps_.size());
  from_ = from, cut_ = 0;
  stamps_ = run_.stamps.subspan(from, count);
  deflections_ = &deflections;
  if (count == 0) return;
  if (!lanes_) {
    lanes_.emplace(envelope, deflections.node_height_mm, run_.stock.voxel_mm(), run_.stock.band_mm());
    reading_.emplace(envelope, *lanes_);
  }
  arena_.load(
      run_.stock, &run_.blank, envelope.shape, stamps_, [&](auto left) { leave(left); },
      DeflectedEngager::kMaxDeflection_mm);
  load_cut(run_.stock, arena_, envelope.shape, tips_by_id(run_.stamps, run_.first_id, max_deflection_mm_), tiles_);
  arena_.read_tops(
      static_cast<int>(std::ceil((lanes_->widest_mm() + DeflectedEngager::kMaxDeflection_mm) / run_.stock.voxel_mm())),
      [&](std::size_t t) -> const ColumnCover& { return tiles_[t]->cover; });
  memory_.begin(deflections.row_size(), from);
  bends_.emplace(envelope, deflections);
  reader_.emplace(run_, *lanes_, stamps_, deflections, memory_);
}

void UprightDeflectedPath::list_group(std::size_t k, std::size_t count) {
  group_.clear();
  reached_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<std::ptrdiff_t>(k + i);
    group_.push_back(bends_->of(row));
    memory_.add(deflections_->row(row));
    max_deflection_mm_ = std::max(max_deflection_mm_, group_.back().largest_mm);
    max_axial_mm_ = std::max(max_axial_mm_, group_.back().axial_mm);
    for (const std::int32_t t : arena_.reached_by(k + i)) {
      CutTile& tile = *tiles_[static_cast<std::size_t>(t)];
      if (tile.cover.all_air()) continue;
      if (tile.group.empty()) reached_.push_back(static_cast<std::size_t>(t));
      tile.group.push_back(static_cast<std::int32_t>(i));
    }
  }
}

void UprightDeflectedPath::cut_tile(std::size_t t, std::size_t k, const StampDeflection& deflection) {
  CutTile& tile = *tiles_[t];
  const EnvelopeGrid& envelope = run_.envelope;
  const Stamp& stamp = stamps_[k];
  const double voxel = run_.stock.voxel_mm(), band = run_.stock.band_mm();
  if (tile.cover.all_air()) return;
  tile.cover.allow_axial(max_axial_mm_);
  if (tile_distance_mm(arena_.index(t), voxel, envelope.shape, stamp.pose.tip_mm) > band + deflection.largest_mm)
    return;
  const bool ends = std::isfinite(deflections_->edges_end_mm);
  if (tile.cut && !ends &&
      !tile.cover.changeable_after(tile.last_tip_mm, tile.last_deflection_mm, stamp.pose.tip_mm, deflection.largest_mm))
    return;
  const CarveStamp at{stamp.pose.tip_mm, run_.first_id + static_cast<std::int32_t>(from_ + k)};
  tile.changed |= deflection.largest_mm > 0 || ends
                      ? carve_deflected(arena_[t], tile.cover, arena_.index(t), voxel, band, envelope, at,
                                        *deflections_, deflection)
                      : carve(arena_[t], tile.cover, arena_.index(t), voxel, band, envelope.shape, at);
  tile.cut = true;
  tile.last_tip_mm = stamp.pose.tip_mm;
  tile.last_deflection_mm = deflection.largest_mm;
}

/// The last stamp of a tile first: where the tool moves ahead, it leaves nothing to those before it.
void UprightDeflectedPath::cut(std::size_t k, std::size_t count) {
  list_group(k, count);
  cut_ = k + count;
  tbb::parallel_for(std::size_t{0}, reached_.size(), [&](std::size_t i) {
    auto& group = tiles_[reached_[i]]->group;
    for (; !group.empty(); group.pop_back()) {
      const auto of_group = static_cast<std::size_t>(group.back());
      cut_tile(reached_[i], k + of_group, group_[of_group]);
    }
  });
}

}  // namespace

std::unique_ptr<DeflectedPath> deflected_path(const EngagedRun& run) {
  return std::make_unique<UprightDeflectedPath>(run);
}

}  // namespace camber::removal::upright
