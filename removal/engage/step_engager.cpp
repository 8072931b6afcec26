#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "removal/engage/upright/block_reader.h"
#include "removal/engagement.h"
#include "removal/field/cell.h"
#include "removal/field/upright/batch_cut.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/step_arena.h"

namespace camber::removal {

using namespace upright;

namespace {

/// Distance by which tips may lie outside of their box, mm: rounding of a path that is summed up.
constexpr double kRounding_mm = 1e-6;

/// Number of tips for which the reader reserves space.
constexpr std::size_t kExpectedStamps = std::size_t{1} << 23;

/// A tile in which stamps are cut one by one.
struct StepTile {
  ColumnCover cover;
  double material;  ///< volume of material when it was read or written, voxels
  bool changed = false;
};

}  // namespace

bool TipBox::contains(const Vec3& tip_mm) const {
  return (tip_mm.array() >= min_mm.array() - kRounding_mm).all() &&
         (tip_mm.array() <= max_mm.array() + kRounding_mm).all();
}

struct StepEngager::Impl {
  Stock& stock;
  const Stock& blank;
  const EnvelopeGrid& envelope;
  TipBox box;
  std::int32_t first_id;
  EnvelopeBlocks blocks;
  BlockReader reader;
  StepArena arena;
  BatchCut batch_cut;
  std::deque<std::optional<StepTile>> tiles{};  ///< by number; a deque, since tiles must not move in memory
  BlockReader::Buffers buffers{};
  int widest_voxels;  ///< widest block of the envelope, voxels
  double removed_voxels = 0;

  Impl(Stock& stock_, const Stock& blank_, const EnvelopeGrid& envelope_, const TipBox& box_, std::int32_t first_id_,
       int pitches)
      : stock(stock_),
        blank(blank_),
        envelope(envelope_),
        box(box_),
        first_id(first_id_),
        blocks(envelope_, stock_.voxel_mm(), stock_.band_mm()),
        reader(envelope_, blocks, StampTips(box_.min_mm, box_.max_mm, kExpectedStamps), first_id_, stock_.voxel_mm(),
               stock_.max_mm().z() + stock_.band_mm(), pitches),
        arena(stock_, envelope_.shape, box_.min_mm, box_.max_mm),
        batch_cut(envelope.shape, stock_.voxel_mm(), stock_.band_mm(), 0),
        widest_voxels(static_cast<int>(std::ceil(blocks.widest_mm() / stock_.voxel_mm()))) {}

  std::span<const std::int32_t> reach(const Vec3& tip_mm);
  void approach(const Vec3& tip_mm, int most);
  void begin_fresh();
  bool cut(std::size_t tile, const Stamp& stamp, std::int32_t id);
  void write(std::span<const std::size_t> numbers);
  void give_up(StepArena::Keep keep, int most);
  float voxel(const Index3& index) const;
};

/// Takes over the tiles that the arena has loaded last.
void StepEngager::Impl::begin_fresh() {
  const auto tip_of = [&](std::int32_t id, Vec3& tip, double& deflection) {
    if (id < first_id) return false;
    tip = reader.tips().view()[id - first_id];
    deflection = 0;
    return true;
  };
  for (const std::size_t t : arena.fresh()) {
    while (tiles.size() <= t) tiles.emplace_back();
    tiles[t].emplace(
        StepTile{ColumnCover(arena[t], arena.index(t), stock.voxel_mm(), stock.band_mm(), envelope.shape, tip_of),
                 material_voxels(arena[t], stock.voxel_mm())});
    arena.lowered(t);
  }
}

/// Loads the tiles around a tip that are not in memory. Reading at many places without a cut loads tiles as well, so
/// that old ones are given up first.
std::span<const std::int32_t> StepEngager::Impl::reach(const Vec3& tip_mm) {
  give_up(StepArena::Keep::most, kAll);
  const auto near = arena.reach(stock, blank, envelope.shape, tip_mm);
  begin_fresh();
  return near;
}

void StepEngager::Impl::approach(const Vec3& tip, int most) {
  arena.approach(stock, blank, envelope.shape, tip.cwiseMax(box.min_mm).cwiseMin(box.max_mm), most);
  begin_fresh();
}

bool StepEngager::Impl::cut(std::size_t t, const Stamp& stamp, std::int32_t id) {
  StepTile& tile = *tiles[t];
  if (tile.cover.all_air()) return false;
  if (envelope.shape.general)
    return carve(arena[t], tile.cover, arena.index(t), stock.voxel_mm(), stock.band_mm(), envelope.shape,
                 {stamp.pose.tip_mm, id, 0});
  static constexpr std::array<std::int32_t, 1> kAlone{0};
  return batch_cut.cut(arena[t], tile.cover, {&stamp, 1}, kAlone, id);
}

/// Writes those of the tiles that have changed.
void StepEngager::Impl::write(std::span<const std::size_t> numbers) {
  std::vector<Stock::StoredTile> changed;
  for (const std::size_t t : numbers) {
    StepTile& tile = *tiles[t];
    if (!std::exchange(tile.changed, false)) continue;
    changed.push_back({arena.index(t), &arena[t]});
    removed_voxels += tile.material;
    tile.material = material_voxels(arena[t], stock.voxel_mm());
    removed_voxels -= tile.material;
  }
  stock.store(changed);
}

void StepEngager::Impl::give_up(StepArena::Keep keep, int most) {
  for (int given = 0; given < most; ++given) {
    const auto oldest = arena.to_give_up(keep);
    if (!oldest) return;
    write({&*oldest, 1});
    arena.give_up(*oldest, tiles[*oldest]->cover.all_air());
    tiles[*oldest].reset();
  }
}

float StepEngager::Impl::voxel(const Index3& index) const {
  static_assert((Tile::kCore & (Tile::kCore - 1)) == 0);
  constexpr int kIn = Tile::kCore - 1;
  const std::int32_t t =
      arena.find((index[0] & ~kIn) / Tile::kCore, (index[1] & ~kIn) / Tile::kCore, (index[2] & ~kIn) / Tile::kCore);
  if (t <= 0) return stock.voxel(index);
  const ArenaView view = arena.view();
  return view.distance[static_cast<std::ptrdiff_t>(t) * view.stride +
                       Tile::offset(index[0] & kIn, index[1] & kIn, index[2] & kIn)];
}

StepEngager::StepEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, const TipBox& tips,
                         std::int32_t first_id, int pitches)
    : impl_(std::make_unique<Impl>(stock, blank, envelope, tips, first_id, pitches)) {}
StepEngager::~StepEngager() = default;

const EnvelopeBlocks& StepEngager::blocks() const { return impl_->blocks; }

std::size_t StepEngager::count() const { return impl_->reader.tips().size(); }

std::span<const ChipBlock> StepEngager::read(const Stamp& stamp) {
  Impl& m = *impl_;
  assert(stamp.pose.upright() && m.box.contains(stamp.pose.tip_mm));
  m.reach(stamp.pose.tip_mm);
  return m.reader.read(m.arena, stamp, {}, m.buffers);
}

void StepEngager::approach(const Vec3& tip_mm, int most) {
  impl_->give_up(most == kAll ? StepArena::Keep::some : StepArena::Keep::more, most);
  impl_->approach(tip_mm, most);
}

void StepEngager::cut(const Stamp& stamp) {
  Impl& m = *impl_;
  assert(stamp.pose.upright() && m.box.contains(stamp.pose.tip_mm));
  const std::int32_t id = m.first_id + static_cast<std::int32_t>(count());
  m.reader.append(stamp.pose.tip_mm);
  for (const std::int32_t near : m.reach(stamp.pose.tip_mm)) {
    const auto t = static_cast<std::size_t>(near);
    if (!m.cut(t, stamp, id)) continue;
    m.tiles[t]->changed = true;
    m.arena.lowered(t);
  }
  constexpr std::int32_t kStampsATop = 4;
  if (id % kStampsATop == 0)
    m.arena.read_a_top(m.widest_voxels, [&](std::size_t t) -> const ColumnCover& { return m.tiles[t]->cover; });
}

double StepEngager::flush() {
  Impl& m = *impl_;
  std::vector<std::size_t> there;
  for (std::size_t t = 1; t < m.arena.size(); ++t)
    if (m.arena.has(t)) there.push_back(t);
  m.write(there);
  return std::exchange(m.removed_voxels, 0.0) * std::pow(m.stock.voxel_mm(), 3);
}

double StepEngager::distance_mm(const Vec3& place_mm) const {
  const Impl& m = *impl_;
  const Vec3 at = place_mm / m.stock.voxel_mm();
  const Vec3 low = at.array().floor();
  const CellShare share{static_cast<float>(at.x() - low.x()), static_cast<float>(at.y() - low.y()),
                        static_cast<float>(at.z() - low.z())};
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const float weight = corner_weight(c, share);
    if (weight == 0) continue;
    sum += static_cast<double>(weight *
                               m.voxel({static_cast<int>(low.x()) + (c & 1), static_cast<int>(low.y()) + (c >> 1 & 1),
                                        static_cast<int>(low.z()) + (c >> 2)}));
  }
  return sum;
}

}  // namespace camber::removal
