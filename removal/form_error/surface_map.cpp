#include "base/cancel.h"
#include "base/process_memory.h"
#include "base/stage.h"
#include "removal/form_error.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "removal/field/upright/carve.h"
#include "removal/form_error/deflected_envelope.h"
#include "removal/form_error/mark_queue.h"
#include "removal/form_error/tilted_stamps.h"
#include "removal/simd/upright_distances.h"
#include "removal/simd/upright_mark_kernels.h"

namespace camber::removal {
namespace {

constexpr double kRounding_mm = 3e-4;  ///< rounding of distances in single precision, within a metre
constexpr int kBlock = 4;              ///< voxels a side of the cubes whose points are passed over together

/// Points first ... first + count - 1 within `radius` of `centre`, `across` of it along the surface and `thick` above
/// and below.
struct Group {
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();
  double radius = 0, across = 0, thick = 0;
  std::size_t first = 0, count = 0;
  double highest = 0;  ///< largest of its points' errors

  /// A straight cutter must be as near as this to reach one of the points, or one above it by its error, when
  /// deflected.
  double reach_mm() const { return std::max(highest, 0.0) + kRounding_mm; }
};

/// The points of one of the stock's tiles.
struct TilePoints {
  Group all;
  std::vector<Group> blocks;
  bool marked = false;  ///< cutters came near since the map had no marks
};

Group group_of(std::span<const SurfacePoint> points, std::size_t first, std::size_t count, double highest) {
  Vec3 lo = points[first].place_mm, hi = lo;
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = first; i < first + count; ++i) {
    lo = lo.cwiseMin(points[i].place_mm);
    hi = hi.cwiseMax(points[i].place_mm);
    normal += points[i].normal;
  }
  Group out{.centre = (lo + hi) / 2, .first = first, .count = count, .highest = highest};
  if (normal.norm() > 0) out.normal = normal.normalized();
  for (std::size_t i = first; i < first + count; ++i) {
    const Vec3 from = points[i].place_mm - out.centre;
    const double above = from.dot(out.normal);
    out.radius = std::max(out.radius, from.norm());
    out.thick = std::max(out.thick, std::abs(above));
    out.across = std::max(out.across, (from - above * out.normal).norm());
  }
  return out;
}

/// Number of the cube of `side` voxels that a point lies in.
Index3 cube_of(const Vec3& p, double side_mm) {
  return {static_cast<int>(std::floor(p.x() / side_mm)), static_cast<int>(std::floor(p.y() / side_mm)),
          static_cast<int>(std::floor(p.z() / side_mm))};
}

/// Tips of upright stamps, from the first one, side by side.
class UprightTips {
 public:
  void add(const Vec3& tip) {
    if (x_.empty()) origin_ = tip;
    x_.push_back(static_cast<float>(tip.x() - origin_.x()));
    y_.push_back(static_cast<float>(tip.y() - origin_.y()));
    z_.push_back(static_cast<float>(tip.z() - origin_.z()));
  }
  /// How far a place is from the straight cutter at each.
  void distances(const CutterShape& shape, const Vec3& place, std::vector<float>& out) const {
    const Eigen::Vector3f p = (place - origin_).cast<float>();
    for (std::size_t k = 0; k < x_.size(); ++k)
      out[k] = static_cast<float>(shape.distance_mm((p - Eigen::Vector3f(x_[k], y_[k], z_[k])).cast<double>()));
  }
  /// The cutters as MarkKernels has them; rounded cutters alone. `reach_mm`: of each, and whole vectors of them.
  upright::CutterLanes lanes(const CutterShape& shape, const std::vector<float>& reach_mm, bool lateral) const {
    return {static_cast<int>(x_.size()),
            x_.data(),
            y_.data(),
            z_.data(),
            reach_mm.data(),
            static_cast<float>(shape.bottom_length_mm()),
            static_cast<float>(shape.corner_radius_mm),
            lateral};
  }
  Eigen::Vector3f from_origin(const Vec3& place) const { return (place - origin_).cast<float>(); }
  std::size_t size() const { return x_.size(); }
  void clear() {
    for (auto* v : {&x_, &y_, &z_}) v->clear();
  }
  /// How near the straight cutter at each can come to a place of a group, at least.
  void distances_to(const CutterShape& shape, const Group& group, std::vector<float>& out) const {
    out.resize(x_.size());
    if (shape.general) {
      distances(shape, group.centre, out);
      for (float& d : out) d -= static_cast<float>(group.radius);
      return;
    }
    const Eigen::Vector3f p = (group.centre - origin_).cast<float>(), n = group.normal.cast<float>();
    upright::rounded_distances_to(x_.data(), y_.data(), z_.data(), x_.size(),
                                  {{p.x(), p.y(), p.z()},
                                   {n.x(), n.y(), n.z()},
                                   static_cast<float>(group.across),
                                   static_cast<float>(group.thick)},
                                  static_cast<float>(shape.bottom_length_mm()),
                                  static_cast<float>(shape.corner_radius_mm), out.data());
  }

 private:
  Vec3 origin_ = Vec3::Zero();
  std::vector<float> x_, y_, z_;
};

/// Upright stamps of a stretch, some of the path's neighbours together.
class UprightStampGroups {
 public:
  UprightStampGroups(std::span<const Stamp> stamps, const std::vector<StampDeflection>& deflections) {
    constexpr std::size_t kTogether = 32;
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      if (k % kTogether == 0)
        groups_.push_back({stamps[k].pose.tip_mm.head<2>(), stamps[k].pose.tip_mm.head<2>(), 0, {}});
      Together& g = groups_.back();
      g.lo = g.lo.cwiseMin(stamps[k].pose.tip_mm.head<2>());
      g.hi = g.hi.cwiseMax(stamps[k].pose.tip_mm.head<2>());
      g.max_deflection_mm = std::max(g.max_deflection_mm, deflections[k].largest_mm);
      g.tips.add(stamps[k].pose.tip_mm);
      deflection_mm_.push_back(static_cast<float>(deflections[k].largest_mm));
    }
  }

  /// Lists the stamps that may reach a place of `points`; `distance` is working room.
  void find_near(const CutterShape& shape, const Group& points, std::vector<float>& distance,
                 std::vector<std::size_t>& near) const {
    const auto reach = static_cast<float>(points.reach_mm());
    const Vec2 centre = points.centre.head<2>();
    std::size_t first = 0;
    for (const Together& g : groups_) {
      const double around = shape.radius_mm + points.radius + points.reach_mm() + g.max_deflection_mm;
      const Vec2 gap = (g.lo - centre).cwiseMax(centre - g.hi).cwiseMax(0.0);
      if (gap.squaredNorm() <= around * around) {
        g.tips.distances_to(shape, points, distance);
        for (std::size_t k = 0; k < g.tips.size(); ++k)
          if (distance[k] <= reach + deflection_mm_[first + k]) near.push_back(first + k);
      }
      first += g.tips.size();
    }
  }

 private:
  struct Together {
    Vec2 lo, hi;
    double max_deflection_mm;
    UprightTips tips;
  };
  std::vector<Together> groups_;
  std::vector<float> deflection_mm_;
};

/// Deflected upright stamps that may lower points of one block.
class UprightCloseStamps {
 public:
  UprightCloseStamps(const EnvelopeGrid& envelope, const DeflectionTable& deflections)
      : e_(envelope), deflections_(deflections), queue_(envelope, deflections) {}
  void clear() {
    tips_.clear();
    stamps_.clear();
    reach_mm_.clear();
  }
  void add(const ToolPose& pose, const StampDeflection& deflection, std::int32_t id) {
    tips_.add(pose.tip_mm);
    stamps_.push_back({DeflectedEnvelope(e_, deflections_, deflection, pose), id});
    reach_mm_.push_back(static_cast<float>(deflection.largest_mm + kRounding_mm));
  }
  bool empty() const { return stamps_.empty(); }

  /// Lowers points to the deepest of them. The stamp that goes deepest where it is straight comes first: most others
  /// are then too high to look at.
  void mark(std::span<SurfacePoint> points) {
    if (e_.shape.general)
      mark_general(points);
    else
      mark_rounded(points);
  }

 private:
  struct DeflectedStamp {
    DeflectedEnvelope envelope;
    std::int32_t id;
  };

  void mark_general(std::span<SurfacePoint> points) {
    distance_.resize(stamps_.size());
    for (SurfacePoint& p : points) {
      tips_.distances(e_.shape, p.place_mm + p.error_mm * p.normal, distance_);
      const auto first = static_cast<std::size_t>(std::ranges::min_element(distance_) - distance_.begin());
      lower(p, first);
      for (std::size_t k = 0; k < stamps_.size(); ++k)
        if (k != first) lower(p, k);
    }
  }
  void lower(SurfacePoint& p, std::size_t k) const {
    if (distance_[k] > reach_mm_[k]) return;
    if (p.place_mm.z() - stamps_[k].envelope.pose().tip_mm.z() > deflections_.edges_end_mm) return;
    const double h = stamps_[k].envelope.height_mm(p.place_mm, p.normal, p.error_mm);
    if (h >= p.error_mm) return;
    p.error_mm = h;
    p.machined_stamp = stamps_[k].id;
  }

  void mark_rounded(std::span<SurfacePoint> points) {
    const auto settle = [&] {
      queue_.settle([&](const MarkQueue::Pair& pair, double height_mm) {
        SurfacePoint& p = points[pair.point];
        if (height_mm >= p.error_mm) return;
        p.error_mm = height_mm;
        p.machined_stamp = stamps_[pair.stamp].id;
      });
    };
    fill_lanes();
    const upright::CutterLanes lanes = tips_.lanes(e_.shape, reach_mm_, !deflections_.axial);
    near_.clear();
    within_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto found = static_cast<std::ptrdiff_t>(within_.size());
      within_.resize(within_.size() + reach_mm_.size());
      upright::NearCutters near{-1, 0, within_.data() + found};
      const Eigen::Vector3f p = place_of(points[i]);
      upright::mark_kernels().find_near(lanes, p.x(), p.y(), p.z(), near);
      within_.resize(static_cast<std::size_t>(found + (near.count + upright::MarkLanes::kLanes - 1) /
                                                          upright::MarkLanes::kLanes * upright::MarkLanes::kLanes));
      near_.push_back({near.count, found});
      if (near.nearest >= 0) take(points, i, near.nearest);
    }
    settle();
    // A place farther down is farther from every cutter that cuts towards it: the nearest ones first, then the rest.
    // Many flat bottoms pass over a place, each a little lower or as low.
    const int nearest = lanes.flat > 0 ? 2 : 0;
    for (int round = 0; round <= nearest; ++round) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (near_[i].count == 0) continue;
        const Eigen::Vector3f p = place_of(points[i]);
        upright::NearCutters near{-1, near_[i].count, within_.data() + near_[i].from};
        upright::mark_kernels().keep_near(lanes, p.x(), p.y(), p.z(), near);
        near_[i].count = near.count;
        if (round < nearest && near.count > 0) take(points, i, near.nearest);
        for (int n = 0; round == nearest && n < near.count; ++n) add_to_queue(points, i, near.within[n]);
      }
      settle();
    }
  }
  /// One of the stamps that are near a point.
  void take(std::span<const SurfacePoint> points, std::size_t point, int stamp) {
    add_to_queue(points, point, stamp);
    Near& near = near_[point];
    std::int32_t* const first = within_.data() + near.from;
    near.count = static_cast<int>(std::remove(first, first + near.count, stamp) - first);
  }
  void fill_lanes() {
    constexpr float kNever = -1;
    while (reach_mm_.size() % upright::MarkLanes::kLanes != 0) {
      tips_.add(stamps_.back().envelope.pose().tip_mm);
      reach_mm_.push_back(kNever);
    }
  }
  Eigen::Vector3f place_of(const SurfacePoint& p) const {
    return tips_.from_origin(p.place_mm + p.error_mm * p.normal);
  }
  void add_to_queue(std::span<const SurfacePoint> points, std::size_t point, int stamp) {
    const auto k = static_cast<std::size_t>(stamp);
    const SurfacePoint& p = points[point];
    const DeflectedEnvelope& deflected = stamps_[k].envelope;
    if (p.place_mm.z() - deflected.pose().tip_mm.z() > deflections_.edges_end_mm) return;
    queue_.add({point, k}, (p.place_mm - deflected.pose().tip_mm).cast<float>(), p.normal.cast<float>(), p.error_mm,
               deflected.deflection());
  }

  const EnvelopeGrid& e_;
  const DeflectionTable& deflections_;
  MarkQueue queue_;
  UprightTips tips_;
  std::vector<DeflectedStamp> stamps_;
  std::vector<float> reach_mm_, distance_;
  /// Stamps within reach of a point that are yet to be looked at: how many, and where in within_.
  struct Near {
    int count;
    std::ptrdiff_t from;
  };
  std::vector<Near> near_;
  std::vector<std::int32_t> within_;
};

}  // namespace

struct SurfaceMap::Impl {
  std::vector<SurfacePoint> points;  ///< tile by tile
  std::vector<float> left_mm;        ///< height of the blank above each
  std::vector<TilePoints> tiles;
  double band_mm = 0;

  /// Where the deflected cutters do not reach, the blank itself is the surface.
  void add_blank() {
    for (std::size_t i = 0; i < points.size(); ++i) {
      SurfacePoint& p = points[i];
      if (p.error_mm <= 0 || static_cast<double>(left_mm[i]) >= p.error_mm) continue;
      p.error_mm = static_cast<double>(left_mm[i]);
      p.machined_stamp = Stock::kUncut;
    }
  }
  void clear_marks(TilePoints& tile) {
    for (SurfacePoint& p : of(tile)) {
      p.error_mm = band_mm;
      p.machined_stamp = Stock::kUncut;
    }
    tile.all.highest = band_mm;
    for (Group& block : tile.blocks) block.highest = band_mm;
    tile.marked = false;
  }
  std::span<SurfacePoint> of(const TilePoints& tile) {
    return std::span(points).subspan(tile.all.first, tile.all.count);
  }
};

SurfaceMap::SurfaceMap(const Stock& target, const CutterPlaces& places, const Stock& blank, const Stock* solid)
    : impl_(std::make_unique<Impl>()) {
  assert(blank.voxel_mm() == target.voxel_mm() && (!solid || solid->voxel_mm() == target.voxel_mm()));
  const double block_mm = kBlock * target.voxel_mm(), band = target.band_mm();
  const auto block_of = [&](const SurfacePoint& p) { return cube_of(p.place_mm, block_mm); };
  auto& points = impl_->points;
  auto parts = surface_points(target, places, solid, &unseen_mm2_);
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  constexpr std::size_t kReturns = 8;
  std::size_t returned = 0;
  points.reserve(count);
  for (auto& part : parts) {
    if (part.empty()) continue;
    impl_->tiles.emplace_back().all = {.first = points.size(), .count = part.size()};
    points.insert(points.end(), part.begin(), part.end());
    std::vector<SurfacePoint>().swap(part);  // part = {} would keep its memory
    // Now and then, so that the points are not in memory twice.
    if (points.size() - returned < count / kReturns) continue;
    return_freed_memory();
    returned = points.size();
  }
  impl_->band_mm = band;
  impl_->left_mm.resize(count);
  Stage stage("sorting the surface's points", impl_->tiles.size());
  tbb::parallel_for(std::size_t{0}, impl_->tiles.size(), [&](std::size_t t) {
    stage.advance();
    TilePoints& tile = impl_->tiles[t];
    const std::size_t first = tile.all.first, end = first + tile.all.count;
    const std::span<SurfacePoint> own(points.data() + first, tile.all.count);
    for (auto& p : own) p.error_mm = band;
    std::stable_sort(own.begin(), own.end(), [&](const auto& a, const auto& b) { return block_of(a) < block_of(b); });
    const Stock::Probe probe(blank);
    for (std::size_t i = first; i < end; ++i)
      impl_->left_mm[i] = static_cast<float>(-probe.distance_mm(points[i].place_mm));
    tile.all = group_of(points, first, own.size(), band);
    for (std::size_t at = first, next = first; at < end; at = next) {
      while (next < end && block_of(points[next]) == block_of(points[at])) ++next;
      tile.blocks.push_back(group_of(points, at, next - at, band));
    }
  });
}

SurfaceMap::SurfaceMap(const SurfaceMap& o) : impl_(std::make_unique<Impl>(*o.impl_)), unseen_mm2_(o.unseen_mm2_) {}
SurfaceMap::SurfaceMap(SurfaceMap&&) noexcept = default;
SurfaceMap::~SurfaceMap() = default;

void SurfaceMap::mark(const EnvelopeGrid& envelope, std::span<const Stamp> stamps, const DeflectionTable& deflections,
                      std::int32_t first_id) {
  if (stamps.empty()) return;
  std::vector<StampDeflection> bounds(stamps.size());
  const StampDeflections all(envelope, deflections);
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    const auto row = static_cast<std::ptrdiff_t>(k);
    // MarkKernels ask for no directions.
    bounds[k] =
        envelope.shape.general ? all.of(row) : StampDeflection{deflections.row(row), deflections.largest_mm(row), {}};
  });
  if (!all_upright(stamps)) return mark_tilted({envelope, stamps, deflections, bounds, first_id});
  const UprightStampGroups groups(stamps, bounds);
  struct Room {
    UprightCloseStamps close;
    UprightTips near_tips{};
    std::vector<float> distance{};
    std::vector<std::size_t> near{};
  };
  tbb::enumerable_thread_specific<Room> rooms([&] { return Room{UprightCloseStamps(envelope, deflections)}; });
  tbb::parallel_for(std::size_t{0}, impl_->tiles.size(), [&](std::size_t t) {
    cancellation_point();
    TilePoints& tile = impl_->tiles[t];
    auto& [close, near_tips, distance, near] = rooms.local();
    near.clear();
    groups.find_near(envelope.shape, tile.all, distance, near);
    near_tips.clear();
    for (const std::size_t k : near) near_tips.add(stamps[k].pose.tip_mm);
    if (near.empty()) return;
    tile.marked = true;
    tile.all.highest = -std::numeric_limits<double>::infinity();
    for (Group& block : tile.blocks) {
      near_tips.distances_to(envelope.shape, block, distance);
      close.clear();
      for (std::size_t n = 0; n < near.size(); ++n) {
        const StampDeflection& deflection = bounds[near[n]];
        if (distance[n] <= block.reach_mm() + deflection.largest_mm)
          close.add(stamps[near[n]].pose, deflection, first_id + static_cast<std::int32_t>(near[n]));
      }
      if (!close.empty()) {
        block.highest = -std::numeric_limits<double>::infinity();
        const std::span<SurfacePoint> own(impl_->points.data() + block.first, block.count);
        close.mark(own);
        for (const SurfacePoint& p : own) block.highest = std::max(block.highest, p.error_mm);
      }
      tile.all.highest = std::max(tile.all.highest, block.highest);
    }
  });
}

/// The same for stamps of any pose.
void SurfaceMap::mark_tilted(const TiltedStamps& stamps) {
  struct Room {
    TiltedMarks marks;
    std::vector<std::size_t> near_tile{}, near_block{};
  };
  tbb::enumerable_thread_specific<Room> rooms([&] { return Room{TiltedMarks(stamps)}; });
  tbb::parallel_for(std::size_t{0}, impl_->tiles.size(), [&](std::size_t t) {
    cancellation_point();
    TilePoints& tile = impl_->tiles[t];
    auto& [marks, near_tile, near_block] = rooms.local();
    stamps.find_near(tile.all.centre, tile.all.radius + tile.all.reach_mm(), near_tile);
    if (near_tile.empty()) return;
    tile.marked = true;
    tile.all.highest = -std::numeric_limits<double>::infinity();
    for (Group& block : tile.blocks) {
      near_block = near_tile;
      stamps.keep_near(block.centre, block.radius + block.reach_mm(), near_block);
      if (!near_block.empty()) {
        const std::span<SurfacePoint> own(impl_->points.data() + block.first, block.count);
        marks.mark(own, near_block);
        block.highest = -std::numeric_limits<double>::infinity();
        for (const SurfacePoint& p : own) block.highest = std::max(block.highest, p.error_mm);
      }
      tile.all.highest = std::max(tile.all.highest, block.highest);
    }
  });
}

std::vector<SurfacePoint> SurfaceMap::take() {
  impl_->add_blank();
  std::vector<SurfacePoint> out = std::move(impl_->points);
  *impl_ = {};
  return out;
}

std::vector<float> SurfaceMap::take_errors_mm() {
  impl_->add_blank();
  std::vector<float> out;
  out.reserve(impl_->points.size());
  for (const SurfacePoint& p : impl_->points) out.push_back(static_cast<float>(p.error_mm));
  for (TilePoints& tile : impl_->tiles) impl_->clear_marks(tile);
  return out;
}

std::vector<PointMark> SurfaceMap::take_marks() {
  std::vector<PointMark> out;
  for (TilePoints& tile : impl_->tiles) {
    if (!tile.marked) continue;
    auto index = static_cast<std::uint32_t>(tile.all.first);
    for (const SurfacePoint& p : impl_->of(tile)) {
      if (p.machined_stamp != Stock::kUncut) out.push_back({p.error_mm, index, p.machined_stamp});
      ++index;
    }
    impl_->clear_marks(tile);
  }
  return out;
}

std::span<const SurfacePoint> SurfaceMap::points() const { return impl_->points; }

}  // namespace camber::removal
