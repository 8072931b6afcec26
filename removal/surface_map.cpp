#include "removal/surface_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "removal/carve.h"
#include "removal/rounded_distance.h"

namespace camber::removal {
namespace {

constexpr double kRounding_mm = 3e-4;  ///< of distances in single precision, within a metre
constexpr int kBlock = 4;              ///< voxels a side of the cubes whose points are passed over together

/// Points first ... first + count - 1 within `radius` of `centre`, `across` of it along the surface and `thick` above
/// and below.
struct Group {
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();
  double radius = 0, across = 0, thick = 0;
  std::size_t first = 0, count = 0;
  double highest = 0;  ///< of its points' errors

  /// What a straight cutter must be as near as to reach one of the points, or one above it by its error, when bent.
  double reach_mm() const { return std::max(highest, 0.0) + kRounding_mm; }
};

/// The points of one of the stock's tiles.
struct TilePoints {
  Group all;
  std::vector<Group> blocks;
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

/// Tips of stamps, from the first one, side by side.
class Tips {
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
    if (!shape.general) {
      rounded_distances(x_.data(), y_.data(), z_.data(), x_.size(), p.x(), p.y(), p.z(),
                        static_cast<float>(shape.bottom_length_mm()), static_cast<float>(shape.corner_radius_mm),
                        out.data());
      return;
    }
    for (std::size_t k = 0; k < x_.size(); ++k)
      out[k] = static_cast<float>(shape.distance_mm((p - Eigen::Vector3f(x_[k], y_[k], z_[k])).cast<double>()));
  }
  /// How near the straight cutter at each can come to a place of a group, at least.
  void distances_to(const CutterShape& shape, const Group& group, std::vector<float>& out) const {
    if (shape.general) {
      distances(shape, group.centre, out);
      for (float& d : out) d -= static_cast<float>(group.radius);
      return;
    }
    const Eigen::Vector3f p = (group.centre - origin_).cast<float>(), n = group.normal.cast<float>();
    rounded_distances_to(x_.data(), y_.data(), z_.data(), x_.size(),
                         {{p.x(), p.y(), p.z()},
                          {n.x(), n.y(), n.z()},
                          static_cast<float>(group.across),
                          static_cast<float>(group.thick)},
                         static_cast<float>(shape.bottom_length_mm()), static_cast<float>(shape.corner_radius_mm),
                         out.data());
  }

 private:
  Vec3 origin_ = Vec3::Zero();
  std::vector<float> x_, y_, z_;
};

/// One bent stamp.
class BentEnvelope {
 public:
  BentEnvelope(const EnvelopeGrid& envelope, const ShiftTable& shifts, const CarveBend& bend, const Vec3& tip)
      : e_(envelope), shifts_(shifts), bend_(bend), tip_(tip) {}

  /// Height above q along n at which q + height n lies on the bent envelope, if that is under `highest`; else
  /// `highest`.
  double height_mm(const Vec3& q, const Vec3& n, double highest) const {
    const Vec3 above = q + highest * n - tip_;
    const double outside = e_.shape.distance_mm(above);
    if (outside > bend_.largest_mm || (outside > 0 && outside > outward_mm(above))) return highest;
    // Where the deflection jumps along with the edge, two points of the envelope may lie on one line: the lower counts.
    return std::min(settled_mm(q, n, highest, Vec3::Zero()), settled_mm(q, n, highest, shift(above - shift(above))));
  }

 private:
  /// Where the deflection jumps against the motion of the edge, the envelope is torn, and the tooth draws the gap while
  /// it bends: there plain steps swing between both sides, and smaller ones find the place between them.
  static constexpr double share_of(int step) { return step < 5 ? 1.0 : step < 16 ? 0.3 : 0.1; }

  /// From a guess of the deflection to the height at which place and deflection agree.
  double settled_mm(const Vec3& q, const Vec3& n, double highest, Vec3 bend) const {
    double h = highest;
    for (int step = 0; step < kSteps; ++step) {
      const Vec3 x = q + h * n - tip_;
      const double s = e_.shape.distance_mm(x - bend);
      if (step == 0 && s >= 0) return highest;
      const double change = s / std::clamp(-e_.shape.gradient(x - bend).dot(n), kFlattest, 1.0);
      h += change;
      const Vec3 turned = shift(q + h * n - tip_ - bend) - bend;
      if (std::abs(change) < kClose_mm && turned.squaredNorm() < kClose_mm * kClose_mm) break;
      bend += share_of(step) * turned;
    }
    return std::min(h, highest);
  }

  double outward_mm(const Vec3& from_tip) const {
    const double rho = from_tip.head<2>().norm();
    if (rho <= 5 * bend_.largest_mm) return bend_.largest_mm;  // near the axis a shift turns a place to another side
    const double sector = (std::atan2(from_tip.y(), from_tip.x()) + kPi) * CarveBend::kSectors / (2 * kPi);
    const int i = std::clamp(static_cast<int>(sector), 0, CarveBend::kSectors - 1);
    return std::min(bend_.largest_mm, static_cast<double>(bend_.outward_mm[static_cast<std::size_t>(i)]));
  }

  /// Height of the envelope's point nearest to a place.
  double envelope_height_mm(const Vec3& p) const {
    const CutterShape& shape = e_.shape;
    const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
    if (shape.general) return shape.profile.nearest({rho, p.z()}).place.y();
    const double qx = rho - shape.bottom_length_mm(), qz = shape.corner_radius_mm - p.z();
    if (qx > 0 && qz > 0) return shape.corner_radius_mm * (1 - qz / std::sqrt(qx * qx + qz * qz));
    return qx > qz ? std::max(p.z(), 0.0) : 0.0;
  }

  Vec3 shift(const Vec3& from_tip) const {
    const double height = envelope_height_mm(from_tip);
    double step =
        (std::atan2(from_tip.y(), from_tip.x()) - height * e_.lag_per_mm) * shifts_.steps * e_.flutes / (2 * kPi);
    step -= shifts_.steps * std::floor(step / shifts_.steps);
    const int m0 = static_cast<int>(step) % shifts_.steps, m1 = m0 + 1 == shifts_.steps ? 0 : m0 + 1;
    const double f = step - std::floor(step);
    const NodeWeight w = node_weight(shifts_.node_height_mm, height);
    Vec3 sum = Vec3::Zero();
    const auto add = [&](int node, int m, double weight) {
      const float* v = bend_.row + 2 * (node * shifts_.steps + m);
      sum.x() += weight * v[0];
      sum.y() += weight * v[1];
    };
    add(w.lower, m0, (1 - w.upper_share) * (1 - f));
    add(w.lower, m1, (1 - w.upper_share) * f);
    add(w.upper, m0, w.upper_share * (1 - f));
    add(w.upper, m1, w.upper_share * f);
    return sum;
  }

  static constexpr int kSteps = 32;
  static constexpr double kClose_mm = 1e-5, kFlattest = 0.3;
  const EnvelopeGrid& e_;
  const ShiftTable& shifts_;
  const CarveBend& bend_;
  Vec3 tip_;
};

/// Bent stamps that may lower points of one block.
class CloseStamps {
 public:
  CloseStamps(const EnvelopeGrid& envelope, const ShiftTable& shifts) : e_(envelope), shifts_(shifts) {}
  void clear() {
    tips_ = {};
    stamps_.clear();
    reach_mm_.clear();
  }
  void add(const Vec3& tip, const CarveBend& bend, std::int32_t id) {
    tips_.add(tip);
    stamps_.push_back({BentEnvelope(e_, shifts_, bend, tip), id});
    reach_mm_.push_back(static_cast<float>(bend.largest_mm + kRounding_mm));
  }
  bool empty() const { return stamps_.empty(); }

  /// Lowers a point to the deepest of them.
  void mark(SurfacePoint& p) {
    distance_.resize(stamps_.size());
    within_.resize(stamps_.size());
    measure(p);
    // The stamp that goes deepest first: most others are then too high to look at.
    const auto first =
        static_cast<std::size_t>(std::min_element(distance_.begin(), distance_.end()) - distance_.begin());
    if (distance_[first] > reach_mm_[first] && find_within() == 0) return;
    lower(p, first);
    if (!e_.shape.general) measure(p);
    const std::size_t count = find_within();
    for (std::size_t n = 0; n < count; ++n)
      if (within_[n] != first) lower(p, within_[n]);
  }

 private:
  struct Bent {
    BentEnvelope envelope;
    std::int32_t id;
  };

  void measure(const SurfacePoint& p) { tips_.distances(e_.shape, p.place_mm + p.error_mm * p.normal, distance_); }
  /// Lists the stamps that are as near as their bend reaches.
  std::size_t find_within() {
    std::size_t count = 0;
    for (std::size_t k = 0; k < distance_.size(); ++k) {
      within_[count] = k;
      count += distance_[k] <= reach_mm_[k] ? 1 : 0;
    }
    return count;
  }
  void lower(SurfacePoint& p, std::size_t k) const {
    if (distance_[k] > reach_mm_[k]) return;
    const double h = stamps_[k].envelope.height_mm(p.place_mm, p.normal, p.error_mm);
    if (h >= p.error_mm) return;
    p.error_mm = h;
    p.machined_stamp = stamps_[k].id;
  }

  const EnvelopeGrid& e_;
  const ShiftTable& shifts_;
  Tips tips_;
  std::vector<Bent> stamps_;
  std::vector<float> reach_mm_, distance_;
  std::vector<std::size_t> within_;
};

}  // namespace

struct SurfaceMap::Impl {
  std::vector<SurfacePoint> points;  ///< tile by tile
  std::vector<float> left_mm;        ///< of the blank above each
  std::vector<TilePoints> tiles;
};

SurfaceMap::SurfaceMap(const Stock& target, const CutterPlaces& places, const Stock& blank, const Stock* solid)
    : impl_(std::make_unique<Impl>()) {
  const double block_mm = kBlock * target.voxel_mm(), band = target.band_mm();
  const auto block_of = [&](const SurfacePoint& p) { return cube_of(p.place_mm, block_mm); };
  auto& points = impl_->points;
  auto parts = surface_points(target, places, solid);
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  points.reserve(count);
  for (auto& part : parts) {
    if (part.empty()) continue;
    impl_->tiles.emplace_back().all = {.first = points.size(), .count = part.size()};
    points.insert(points.end(), part.begin(), part.end());
    part = {};
  }
  impl_->left_mm.resize(count);
  tbb::parallel_for(std::size_t{0}, impl_->tiles.size(), [&](std::size_t t) {
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

SurfaceMap::~SurfaceMap() = default;

void SurfaceMap::mark(const EnvelopeGrid& envelope, std::span<const Stamp> stamps, const ShiftTable& shifts,
                      std::int32_t first_id) {
  if (stamps.empty()) return;
  std::vector<CarveBend> bends(stamps.size());
  const Bends all(envelope, shifts);
  tbb::parallel_for(std::size_t{0}, stamps.size(),
                    [&](std::size_t k) { bends[k] = all.of(static_cast<std::ptrdiff_t>(k)); });
  Vec3 lo = stamps.front().tip_mm, hi = lo;
  double most_bent = 0;
  Tips tips;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    tips.add(stamps[k].tip_mm);
    lo = lo.cwiseMin(stamps[k].tip_mm);
    hi = hi.cwiseMax(stamps[k].tip_mm);
    most_bent = std::max(most_bent, bends[k].largest_mm);
  }
  tbb::parallel_for(std::size_t{0}, impl_->tiles.size(), [&](std::size_t t) {
    TilePoints& tile = impl_->tiles[t];
    const double reach = envelope.shape.radius_mm + tile.all.radius + tile.all.reach_mm() + most_bent;
    for (int a = 0; a < 2; ++a)
      if (tile.all.centre[a] < lo[a] - reach || tile.all.centre[a] > hi[a] + reach) return;
    std::vector<float> distance(stamps.size());
    tips.distances_to(envelope.shape, tile.all, distance);
    Tips near_tips;
    std::vector<std::size_t> near;
    for (std::size_t k = 0; k < stamps.size(); ++k)
      if (distance[k] <= tile.all.reach_mm() + bends[k].largest_mm) {
        near.push_back(k);
        near_tips.add(stamps[k].tip_mm);
      }
    if (near.empty()) return;
    distance.resize(near.size());
    tile.all.highest = -std::numeric_limits<double>::infinity();
    CloseStamps close(envelope, shifts);
    for (Group& block : tile.blocks) {
      near_tips.distances_to(envelope.shape, block, distance);
      close.clear();
      for (std::size_t n = 0; n < near.size(); ++n) {
        const CarveBend& bend = bends[near[n]];
        if (distance[n] <= block.reach_mm() + bend.largest_mm)
          close.add(stamps[near[n]].tip_mm, bend, first_id + static_cast<std::int32_t>(near[n]));
      }
      if (!close.empty()) {
        block.highest = -std::numeric_limits<double>::infinity();
        for (std::size_t i = block.first; i < block.first + block.count; ++i) {
          close.mark(impl_->points[i]);
          block.highest = std::max(block.highest, impl_->points[i].error_mm);
        }
      }
      tile.all.highest = std::max(tile.all.highest, block.highest);
    }
  });
}

std::vector<SurfacePoint> SurfaceMap::take() {
  for (std::size_t i = 0; i < impl_->points.size(); ++i) {
    SurfacePoint& p = impl_->points[i];
    // Where the bent cutters do not reach, the blank itself is the surface.
    if (p.error_mm <= 0 || static_cast<double>(impl_->left_mm[i]) >= p.error_mm) continue;
    p.error_mm = static_cast<double>(impl_->left_mm[i]);
    p.machined_stamp = Stock::kUncut;
  }
  std::vector<SurfacePoint> out = std::move(impl_->points);
  *impl_ = {};
  return out;
}

}  // namespace camber::removal
