#include "removal/stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "removal/carve.h"
#include "removal/stamp_order.h"
#include "removal/vector_clones.h"

namespace camber::removal {
namespace {

/// Envelope points first ... first + count - 1 of a stamp, all in one tile.
struct Run {
  std::int32_t slot, stamp;
  std::uint32_t first, count;
  std::uint32_t cap;  ///< where the caps of its points begin in the stamp's list
};

struct StampChip {
  std::int32_t stamp;
  Chip chip;
};

struct WorkTile {
  Index3 index{};
  std::vector<std::int32_t> stamps;
  std::vector<Run> runs;
  std::vector<StampChip> chips;
  std::unique_ptr<Tile> result;  ///< null: nothing changed
  double removed_mm3 = 0;
};

/// What one thread holds of a tile.
struct WorkBuffers {
  std::unique_ptr<Tile> stock = std::make_unique<Tile>();
  Tile blank;
};

Index3 tile_of(const Vec3& p, double tile_mm) {
  return {static_cast<int>(std::floor(p.x() / tile_mm)), static_cast<int>(std::floor(p.y() / tile_mm)),
          static_cast<int>(std::floor(p.z() / tile_mm))};
}

/// A point in a tile: its cell's lower corner and the trilinear weights of the eight corners.
struct Cell {
  int at;
  std::array<float, 8> weight;
  static int corner(int c) { return Tile::offset(c & 1, c >> 1 & 1, c >> 2 & 1); }
};

Cell cell_of(const Vec3& g) {
  // Rounding may put a point on the tile's face a hair outside.
  std::array<int, 3> b{};
  std::array<float, 3> f{};
  for (int a = 0; a < 3; ++a) {
    b[a] = std::clamp(static_cast<int>(g[a]), 0, Tile::kCore - 1);
    f[a] = static_cast<float>(g[a] - b[a]);
  }
  Cell cell{Tile::offset(b[0], b[1], b[2]), {}};
  for (int c = 0; c < 8; ++c)
    cell.weight[c] = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
  return cell;
}

float trilinear(const std::array<float, Tile::kVolume>& values, const Cell& cell) {
  float sum = 0;
  for (int c = 0; c < 8; ++c) sum += cell.weight[c] * values[cell.at + Cell::corner(c)];
  return sum;
}

Vec3 gradient(const std::array<float, Tile::kVolume>& values, const Cell& cell, double voxel) {
  Vec3 sum = Vec3::Zero();
  std::array<float, 3> f{};
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a)
      if (c >> a & 1) f[a] += cell.weight[c];
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a) {
      const float up = f[a], w = c >> a & 1 ? up : 1 - up;
      const float face = w > 0 ? cell.weight[c] / w : 0;
      sum[a] += (c >> a & 1 ? 1 : -1) * face * values[cell.at + Cell::corner(c)];
    }
  return sum / voxel;
}

/// A surface that the normal meets at a grazing angle is taken at no more than twenty times its distance.
float slope(double along_normal) { return static_cast<float>(std::clamp(along_normal, 0.05, 1.0)); }

/// Material in the tile's core, in voxels.
CAMBER_VECTOR_CLONES
double material_voxels(const Tile& tile, double voxel_mm) {
  const auto scale = static_cast<float>(0.5 / voxel_mm);
  double sum = 0;
  for (int i = 0; i < Tile::kCore; ++i) {
    std::array<float, Tile::kCore> share{};
    for (int j = 0; j < Tile::kCore; ++j) {
      const float* d = tile.distance.data() + Tile::offset(i, j, 0);
      for (int k = 0; k < Tile::kCore; ++k) share[k] += std::min(std::max(0.5f - scale * d[k], 0.0f), 1.0f);
    }
    for (const float v : share) sum += static_cast<double>(v);
  }
  return sum;
}

/// Tiles of a box of space, numbered; -1 where there is nothing to cut.
class SlotMap {
 public:
  void reset(const Index3& lo, const Index3& hi) {
    lo_ = lo;
    for (int a = 0; a < 3; ++a) n_[a] = std::max(0, hi[a] - lo[a] + 1);
    slots_.assign(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2], -1);
  }
  bool contains(int i, int j, int k) const {
    return i >= lo_[0] && j >= lo_[1] && k >= lo_[2] && i < lo_[0] + n_[0] && j < lo_[1] + n_[1] && k < lo_[2] + n_[2];
  }
  std::int32_t& at(int i, int j, int k) {
    return slots_[(static_cast<std::size_t>(i - lo_[0]) * n_[1] + (j - lo_[1])) * n_[2] + (k - lo_[2])];
  }
  std::int32_t find(int i, int j, int k) { return contains(i, j, k) ? at(i, j, k) : -1; }

 private:
  Index3 lo_{}, n_{};
  std::vector<std::int32_t> slots_;
};

}  // namespace

struct Stretch::Impl {
  Stock& stock;
  const Stock* blank;
  const EnvelopeGrid& envelope;
  std::span<const Stamp> all_stamps;
  std::span<const Stamp> stamps;  ///< of this stretch
  std::int32_t first_id;          ///< of stamps[0]
  StretchOptions options;
  double tile_mm;
  std::vector<WorkTile> tiles;
  SlotMap slots;
  StampOrder order;                      ///< batches and who covers whom
  std::vector<CarveBend> bends;          ///< per stamp of the stretch; empty: straight
  std::vector<std::vector<float>> caps;  ///< per stamp: what the motion allows at the points of its runs

  void find_tiles(const ShiftTable* shifts);
  void list_stamps(const ShiftTable* shifts);
  void list_runs(const ShiftTable* shifts);
  void runs_of_stamp(std::int32_t k, const ShiftTable* shifts, const std::vector<NodeWeight>& weights,
                     std::vector<Run>& out);
  void work(WorkTile& tile, const ShiftTable* shifts, const std::vector<NodeWeight>& weights) const;
  float thickness(const WorkBuffers& buffers, const Cell& cell, const Vec3& point, const Vec3& cell_corner,
                  const Vec3& normal, bool bent) const;
  void sample(const WorkBuffers& buffers, WorkTile& work, const Run& run, const ShiftTable* shifts,
              const std::vector<NodeWeight>& weights) const;
  float thickness_over(std::span<const std::int32_t> earlier, const Vec3& point, const Vec3& normal) const;
  Engagement gather() const;
};

namespace {

/// A depth of more than this share of what the last motion allows ends at the surface of the tooth before.
constexpr float kNearCap = 0.8f;

/// Bent envelopes lean by no more than this (a shift that jumps at an edge's entry is no slope).
constexpr float kMostTilt = 0.3f;

/// Where the envelope's points of one stamp stand, and how far each has moved since the stamp before.
class PointReader {
 public:
  PointReader(const EnvelopeGrid& envelope, const Stamp& stamp, const ShiftTable* shifts, std::ptrdiff_t k,
              const std::vector<NodeWeight>& weights)
      : e_(envelope),
        feed_(stamp.feed_per_tooth_mm.cast<float>()),
        weights_(weights),
        now_(shifts ? shifts->row(k) : nullptr),
        before_(!shifts || stamp.first ? now_ : shifts->row(k - 1)) {
    if (shifts && shifts->nodes() > 1)
      node_step_ = static_cast<float>(shifts->node_height_mm[1] - shifts->node_height_mm[0]);
  }

  /// Where the point stands, from the tip.
  Eigen::Vector3f place(std::uint32_t point) const {
    Eigen::Vector3f from_tip(e_.x[point], e_.y[point], e_.z[point]);
    const auto turn = static_cast<std::uint32_t>(e_.steps);
    if (now_)
      from_tip.head<2>() += shift(now_, point / turn, point % turn % static_cast<std::uint32_t>(e_.steps_per_pitch));
    return from_tip;
  }

  /// Largest thickness that the motion since the stamp before allows; <= 0: the point runs out of the material.
  float cap(std::uint32_t point, Eigen::Vector3f& place_from_tip) const {
    const std::uint32_t ring = point / static_cast<std::uint32_t>(e_.steps);
    Eigen::Vector3f motion = feed_;
    place_from_tip = {e_.x[point], e_.y[point], e_.z[point]};
    const Eigen::Vector3f n(e_.nx[point], e_.ny[point], e_.nz[point]);
    const auto& profile = e_.rings[ring].profile;
    float tilt = 0;
    if (now_) {
      const std::uint32_t step =
          (point - ring * static_cast<std::uint32_t>(e_.steps)) % static_cast<std::uint32_t>(e_.steps_per_pitch);
      const Eigen::Vector2f now = shift(now_, ring, step), before = shift(before_, ring, step);
      tilt = tilt_of(point, ring, step, n, motion);
      place_from_tip.head<2>() += now;
      motion.head<2>() += now - before;
    }
    const float along_normal = motion.dot(n) - tilt;
    const float k1 = static_cast<float>(profile.meridian_curvature_per_mm);
    const float k2 = static_cast<float>(profile.parallel_curvature_per_mm);
    const float tangential2 = std::max(0.0f, motion.squaredNorm() - along_normal * along_normal);
    if (k1 == k2) return along_normal + 0.5f * k1 * tangential2;
    const float around = -e_.sin_phi[point] * motion.x() + e_.cos_phi[point] * motion.y();
    return along_normal + 0.5f * (k1 * std::max(0.0f, tangential2 - around * around) + k2 * around * around);
  }

 private:
  /// How much less the motion goes along the bent envelope's normal than along n: n_bent = n - sum over the surface
  /// directions e of e (d(shift)/de . n).
  float tilt_of(std::uint32_t point, std::uint32_t ring, std::uint32_t step, const Eigen::Vector3f& n,
                const Eigen::Vector3f& f) const {
    const auto steps = static_cast<std::uint32_t>(e_.steps_per_pitch);
    const auto& profile = e_.rings[ring].profile;
    const float sine = e_.rings[ring].sine;
    if (sine < 0.05f) return 0;
    const Eigen::Vector2f radial(e_.cos_phi[point], e_.sin_phi[point]);
    const float around = -radial.y() * f.x() + radial.x() * f.y();
    const float up = e_.rings[ring].cosine * radial.dot(f.head<2>()) + sine * f.z();
    const float per_rad = static_cast<float>(e_.steps / (4 * kPi));
    const float by_angle = per_rad * (shift(now_, ring, step + 1 == steps ? 0 : step + 1) -
                                      shift(now_, ring, step == 0 ? steps - 1 : step - 1))
                                         .dot(n.head<2>());
    const NodeWeight& w = weights_[ring];
    const float by_height = (at(now_, w.upper, step) - at(now_, w.lower, step)).dot(n.head<2>()) / node_step_;
    const float by_meridian = sine * (by_height - static_cast<float>(e_.lag_per_mm) * by_angle);
    const float most = kMostTilt * f.norm();
    return std::clamp(around * by_angle / static_cast<float>(profile.radius_mm) + up * by_meridian, -most, most);
  }
  Eigen::Vector2f at(const float* row, int node, std::uint32_t step) const {
    const float* v = row + 2 * (static_cast<std::size_t>(node) * e_.steps_per_pitch + step);
    return {v[0], v[1]};
  }
  Eigen::Vector2f shift(const float* row, std::uint32_t ring, std::uint32_t step) const {
    const NodeWeight& w = weights_[ring];
    const Eigen::Vector2f lower = at(row, w.lower, step);
    return lower + w.upper_share * (at(row, w.upper, step) - lower);
  }

  const EnvelopeGrid& e_;
  Eigen::Vector3f feed_;
  const std::vector<NodeWeight>& weights_;
  const float *now_, *before_;
  float node_step_ = 1;
};

}  // namespace

void Stretch::Impl::find_tiles(const ShiftTable* shifts) {
  if (stamps.empty()) return;
  const double reach = stock.band_mm() + (shifts ? 0.5 : 0.0) + envelope.shape.radius_mm;
  Vec3 lo = stamps.front().tip_mm, hi = lo;
  for (const auto& s : stamps) {
    lo = lo.cwiseMin(s.tip_mm);
    hi = hi.cwiseMax(s.tip_mm);
  }
  lo.head<2>().array() -= reach;
  hi.head<2>().array() += reach;
  lo.z() -= stock.band_mm() + 1e-6;
  hi.z() = stock.max_mm().z() + stock.band_mm();
  const Vec3 band = Vec3::Constant(stock.band_mm());
  lo = lo.cwiseMax(stock.min_mm() - band);
  hi = hi.cwiseMin(stock.max_mm() + band);
  slots.reset(tile_of(lo, tile_mm), tile_of(hi, tile_mm));
}

void Stretch::Impl::list_stamps(const ShiftTable* shifts) {
  tiles.clear();
  order = !options.engage ? StampOrder::one_batch(stamps.size())
          : shifts        ? StampOrder::one_by_one(stamps.size())
                          : StampOrder::of_path(stamps, envelope.shape);
  find_tiles(shifts);
  bends.assign(shifts ? stamps.size() : 0, {});
  tbb::parallel_for(std::size_t{0}, bends.size(),
                    [&](std::size_t k) { bends[k] = make_bend(envelope, *shifts, static_cast<std::ptrdiff_t>(k)); });
  constexpr std::int32_t kAir = -2;
  const double band = stock.band_mm();
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const Vec3& tip = stamps[k].tip_mm;
    const double slack = shifts ? bends[k].largest_mm : 0.0;
    const double reach = envelope.shape.radius_mm + band + slack;
    const Index3 lo = tile_of(tip - Vec3(reach, reach, band), tile_mm);
    const Index3 hi = tile_of(Vec3(tip.x() + reach, tip.y() + reach, stock.max_mm().z() + band), tile_mm);
    for (int i = lo[0]; i <= hi[0]; ++i)
      for (int j = lo[1]; j <= hi[1]; ++j)
        for (int l = lo[2]; l <= hi[2]; ++l) {
          if (!slots.contains(i, j, l)) continue;
          std::int32_t& slot = slots.at(i, j, l);
          if (slot == kAir || tile_distance_mm({i, j, l}, stock.voxel_mm(), envelope.shape, tip) > band + slack)
            continue;
          if (slot == -1) {
            if (stock.is_air({i, j, l})) {
              slot = kAir;
              continue;
            }
            slot = static_cast<std::int32_t>(tiles.size());
            tiles.emplace_back().index = {i, j, l};
          }
          tiles[static_cast<std::size_t>(slot)].stamps.push_back(static_cast<std::int32_t>(k));
        }
  }
}

void Stretch::Impl::runs_of_stamp(std::int32_t k, const ShiftTable* shifts, const std::vector<NodeWeight>& weights,
                                  std::vector<Run>& out) {
  const Stamp& stamp = stamps[static_cast<std::size_t>(k)];
  const PointReader reader(envelope, stamp, shifts, k, weights);
  const Stock::Probe probe(stock);
  std::vector<float>& cap_list = caps[static_cast<std::size_t>(k)];
  const double moved = shifts ? bends[static_cast<std::size_t>(k)].largest_mm : 0.0;
  const double before = !shifts ? 0.0
                        : k > 0 ? bends[static_cast<std::size_t>(k) - 1].largest_mm
                                : shifts->largest_mm(-1);
  const double slewed = moved + before;
  const double feed = stamp.feed_per_tooth_mm.norm();
  // What curvature, a change of shift and the bent envelope's tilt add to the chip at most.
  const double bulge =
      feed * feed / (2 * std::max(envelope.shape.corner_radius_mm, 0.1)) + slewed + (shifts ? kMostTilt * feed : 0.0);
  for (const auto& patch : envelope.patches) {
    if (stamp.feed_per_tooth_mm.dot(patch.normal) + feed * patch.normal_spread + bulge <= 0) continue;
    const double reach = std::min(patch.radius_mm + moved + 0.87 * stock.voxel_mm(), 0.999 * stock.band_mm());
    if (probe.nearest(stamp.tip_mm + patch.centre_from_tip) > reach) continue;
    for (int r = patch.ring_from; r < patch.ring_to; ++r) {
      const auto ring = static_cast<std::uint32_t>(r * envelope.steps);
      std::int32_t open = -1;
      for (std::uint32_t p = ring + static_cast<std::uint32_t>(patch.step_from);
           p < ring + static_cast<std::uint32_t>(patch.step_to); ++p) {
        Eigen::Vector3f place;
        std::int32_t slot = -1;
        const float cap = reader.cap(p, place);
        if (cap > 0) {
          const Index3 t = tile_of(stamp.tip_mm + place.cast<double>(), tile_mm);
          slot = slots.find(t[0], t[1], t[2]);
        }
        if (slot >= 0 && slot == open)
          ++out.back().count;
        else if (slot >= 0)
          out.push_back({slot, k, p, 1, static_cast<std::uint32_t>(cap_list.size())});
        if (slot >= 0) cap_list.push_back(cap);
        open = slot;
      }
    }
  }
}

void Stretch::Impl::list_runs(const ShiftTable* shifts) {
  std::vector<NodeWeight> weights;
  if (shifts)
    for (const auto& ring : envelope.rings)
      weights.push_back(node_weight(shifts->node_height_mm, ring.profile.height_mm));
  std::vector<std::vector<Run>> by_stamp(stamps.size());
  caps.assign(stamps.size(), {});
  if (options.engage)
    tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
      runs_of_stamp(static_cast<std::int32_t>(k), shifts, weights, by_stamp[k]);
    });
  for (const auto& runs : by_stamp)
    for (const Run& run : runs) tiles[static_cast<std::size_t>(run.slot)].runs.push_back(run);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) { work(tiles[i], shifts, weights); });
}

/// Thickness of the stock below a point, against the normal, from the fields that meet in its cell (see the
/// header): the thinnest of distance / slope, where slope is how fast a field falls along the normal.
float Stretch::Impl::thickness(const WorkBuffers& buffers, const Cell& cell, const Vec3& point, const Vec3& cell_corner,
                               const Vec3& normal, bool bent) const {
  const Tile& tile = *buffers.stock;
  const float below_blank = -trilinear(buffers.blank.distance, cell);
  if (below_blank <= 0) return 0;
  std::array<std::int32_t, 8> ids;
  for (int c = 0; c < 8; ++c) ids[c] = tile.stamp[cell.at + Cell::corner(c)] - options.first_id;
  float thinnest = std::numeric_limits<float>::infinity();
  for (int c = 0; c < 8; ++c) {
    if (ids[c] < 0 || std::find(ids.begin(), ids.begin() + c, ids[c]) != ids.begin() + c) continue;
    const Vec3& tip = all_stamps[static_cast<std::size_t>(ids[c])].tip_mm;
    double depth = envelope.shape.distance_mm(point - tip);
    if (bent) {
      double weight = 0, bend = 0;
      for (int o = c; o < 8; ++o) {
        if (ids[o] != ids[c]) continue;
        const Vec3 at = cell_corner + stock.voxel_mm() * Vec3(o & 1, o >> 1 & 1, o >> 2 & 1);
        const double w = cell.weight[o] + 1e-6;
        weight += w;
        bend += w * (tile.distance[cell.at + Cell::corner(o)] + envelope.shape.distance_mm(at - tip));
      }
      depth -= bend / weight;
    }
    if (depth <= 0) return 0;
    // A slope is at most 1: what is deeper than the thinnest so far cannot become thinner.
    if (static_cast<float>(depth) >= thinnest) continue;
    const double fall = envelope.shape.gradient(point - tip).dot(normal);
    thinnest = std::min(thinnest, static_cast<float>(depth) / slope(fall));
  }
  if (below_blank >= thinnest) return thinnest;
  return std::min(thinnest, below_blank / slope(-gradient(buffers.blank.distance, cell, stock.voxel_mm()).dot(normal)));
}

/// The same over stamps of the batch that are not in the tile yet.
float Stretch::Impl::thickness_over(std::span<const std::int32_t> earlier, const Vec3& point,
                                    const Vec3& normal) const {
  float thinnest = std::numeric_limits<float>::infinity();
  for (const std::int32_t j : earlier) {
    const Vec3 from_tip = point - stamps[static_cast<std::size_t>(j)].tip_mm;
    const auto depth = static_cast<float>(envelope.shape.distance_mm(from_tip));
    if (depth <= 0) return 0;
    if (depth < thinnest) thinnest = std::min(thinnest, depth / slope(envelope.shape.gradient(from_tip).dot(normal)));
  }
  return thinnest;
}

void Stretch::Impl::sample(const WorkBuffers& buffers, WorkTile& w, const Run& run, const ShiftTable* shifts,
                           const std::vector<NodeWeight>& weights) const {
  const Stamp& stamp = stamps[static_cast<std::size_t>(run.stamp)];
  const PointReader reader(envelope, stamp, shifts, run.stamp, weights);
  const std::vector<float>& cap_list = caps[static_cast<std::size_t>(run.stamp)];
  const auto earlier = order.earlier(run.stamp);
  const double voxel = stock.voxel_mm();
  const Vec3 origin(w.index[0] * Tile::kCore, w.index[1] * Tile::kCore, w.index[2] * Tile::kCore);
  for (std::uint32_t p = run.first; p < run.first + run.count; ++p) {
    const float cap = cap_list[run.cap + (p - run.first)];
    const Vec3 point = stamp.tip_mm + reader.place(p).cast<double>();
    const Vec3 g = point / voxel - origin;
    const Cell cell = cell_of(g);
    // The trilinear field is never below the ridge's, but for curvature: so it tells what is in air, and what is
    // deeper than the chip.
    const float field = trilinear(buffers.stock->distance, cell);
    if (field > 0.5f * static_cast<float>(voxel)) continue;
    if (-field > cap && earlier.empty()) {
      w.chips.push_back({run.stamp, {p, cap, true}});
      continue;
    }
    const Vec3 corner =
        voxel * (origin + Vec3(static_cast<int>(g.x()), static_cast<int>(g.y()), static_cast<int>(g.z())));
    const Vec3 normal(envelope.nx[p], envelope.ny[p], envelope.nz[p]);
    float depth = thickness_over(earlier, point, normal);
    if (-field <= cap && depth > 0)
      depth = std::min(depth, thickness(buffers, cell, point, corner, normal, shifts != nullptr));
    if (depth > 0) w.chips.push_back({run.stamp, {p, std::min(depth, cap), depth > kNearCap * cap}});
  }
}

void Stretch::Impl::work(WorkTile& w, const ShiftTable* shifts, const std::vector<NodeWeight>& weights) const {
  const auto buffers = std::make_unique<WorkBuffers>();
  Tile& tile = *buffers->stock;
  stock.load(w.index, tile);
  const double material = material_voxels(tile, stock.voxel_mm());
  bool changed = false;
  if (options.engage) blank->load(w.index, buffers->blank);
  auto run = w.runs.begin();
  ColumnCover cover(tile, w.index, stock.voxel_mm(), stock.band_mm(), envelope.shape,
                    [&](std::int32_t id, Vec3& tip_mm, double& bend_mm) {
                      if (id < options.first_id) return false;
                      tip_mm = all_stamps[static_cast<std::size_t>(id - options.first_id)].tip_mm;
                      bend_mm = options.bent_before_mm;
                      return true;
                    });
  const auto bend_of = [&](std::int32_t k) { return shifts ? bends[static_cast<std::size_t>(k)].largest_mm : 0.0; };
  const auto covers = [&](std::int32_t last, std::int32_t k) {
    return last >= 0 && !cover.changeable_after(stamps[static_cast<std::size_t>(last)].tip_mm, bend_of(last),
                                                stamps[static_cast<std::size_t>(k)].tip_mm, bend_of(k));
  };
  for (std::size_t from = 0; from < w.stamps.size() && !cover.all_air();) {
    std::size_t end = from + 1;
    while (end < w.stamps.size() && order.batch(w.stamps[end]) == order.batch(w.stamps[from])) ++end;
    for (; run != w.runs.end() && run->stamp <= w.stamps[end - 1]; ++run) sample(*buffers, w, *run, shifts, weights);
    const std::int32_t* batch = w.stamps.data() + from;
    for_each_coarse_to_fine(
        static_cast<std::int32_t>(end - from), [&](std::int32_t i, std::int32_t left, std::int32_t right) {
          const std::int32_t k = batch[i];
          // The neighbours of the batch are in the tile already; in the first of a batch the one before it.
          const std::int32_t before = left >= 0 ? batch[left] : from > 0 ? w.stamps[from - 1] : -1;
          if (covers(before, k) || (right >= 0 && covers(batch[right], k))) return;
          const Stamp& s = stamps[static_cast<std::size_t>(k)];
          const CarveStamp stamp{s.tip_mm, first_id + k, options.shrink_mm};
          if (bend_of(k) > 0)
            changed |= carve_bent(tile, cover, w.index, stock.voxel_mm(), stock.band_mm(), envelope, stamp, *shifts,
                                  bends[static_cast<std::size_t>(k)]);
          else
            changed |= removal::carve(tile, cover, w.index, stock.voxel_mm(), stock.band_mm(), envelope.shape, stamp);
        });
    from = end;
  }
  if (!changed) return;
  w.removed_mm3 = (material - material_voxels(tile, stock.voxel_mm())) * std::pow(stock.voxel_mm(), 3);
  w.result = std::move(buffers->stock);
}

Engagement Stretch::Impl::gather() const {
  Engagement out;
  out.first.assign(stamps.size() + 1, 0);
  for (const auto& tile : tiles)
    for (const auto& c : tile.chips) ++out.first[static_cast<std::size_t>(c.stamp) + 1];
  for (std::size_t k = 0; k < stamps.size(); ++k) out.first[k + 1] += out.first[k];
  out.chips.resize(out.first.back());
  std::vector<std::size_t> at(out.first.begin(), out.first.end() - 1);
  for (const auto& tile : tiles)
    for (const auto& c : tile.chips) out.chips[at[static_cast<std::size_t>(c.stamp)]++] = c.chip;
  return out;
}

Stretch::Stretch(Stock& stock, const Stock* blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
                 std::size_t from, std::size_t count, const StretchOptions& options)
    : impl_(std::make_unique<Impl>(Impl{stock,
                                        blank,
                                        envelope,
                                        stamps,
                                        stamps.subspan(from, count),
                                        options.first_id + static_cast<std::int32_t>(from),
                                        options,
                                        Tile::kCore * stock.voxel_mm(),
                                        {},
                                        {},
                                        {},
                                        {},
                                        {}})) {}
Stretch::~Stretch() = default;

Engagement Stretch::carve(const ShiftTable* shifts) {
  impl_->list_stamps(shifts);
  impl_->list_runs(shifts);
  return impl_->gather();
}

double Stretch::commit() {
  Impl& m = *impl_;
  double removed = 0;
  for (auto& w : m.tiles) {
    if (w.result) m.stock.store(w.index, *w.result);
    removed += w.removed_mm3;
  }
  m.tiles.clear();
  return removed;
}

double chip_volume_mm3(const EnvelopeGrid& e, std::span<const Chip> chips) {
  const double turn = 2 * kPi / e.steps;
  double volume = 0;
  for (const Chip& c : chips) {
    const auto& ring = e.rings[c.point / static_cast<std::uint32_t>(e.steps)];
    const double k1 = ring.profile.meridian_curvature_per_mm, k2 = ring.profile.parallel_curvature_per_mm;
    const double h = c.thickness_mm;
    volume += (h - 0.5 * (k1 + k2) * h * h + k1 * k2 * h * h * h / 3) * ring.width_mm * ring.profile.radius_mm * turn;
  }
  return volume;
}

}  // namespace camber::removal
