#include "removal/field/tilted/carve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vector_clones.h"
#include "removal/field/rounded_cutter.h"
#include "removal/field/upright/carve.h"
#include "removal/simd/upright_kernels.h"

namespace camber::removal::tilted {
namespace {

constexpr int kPadded = 24;            ///< voxels of a row, filled up to whole vectors
constexpr double kRounding_mm = 1e-4;  ///< rounding of distances in single precision

/// The plane under a cutter may lie lower by this without a change: rounding of heights in single precision.
constexpr double kPlaneRounding_mm = 1e-5;

/// The voxels of a row in the tool's frame: the first, and from each to the next.
struct Row {
  Eigen::Vector3f start, step;
};

/// The voxels of a tile in the tool's frame.
struct Grid {
  Eigen::Vector3f origin, by_i, by_j, by_k;

  Grid(const Index3& tile, const Carving& stamp) {
    const Vec3 first = Tile::kCore * stamp.voxel_mm * Vec3(tile[0], tile[1], tile[2]);
    const Mat3 steps = stamp.voxel_mm * stamp.frame.to_part.transpose();
    origin = stamp.frame.in_tool(first).cast<float>();
    by_i = steps.col(0).cast<float>(), by_j = steps.col(1).cast<float>(), by_k = steps.col(2).cast<float>();
  }
  /// Along z.
  Row row(int i, int j) const { return {origin + static_cast<float>(i) * by_i + static_cast<float>(j) * by_j, by_k}; }
  /// The middles of the rows of one i.
  Row middles(int i) const {
    return {origin + static_cast<float>(i) * by_i + 0.5f * static_cast<float>(Tile::kCore) * by_k, by_j};
  }
};

CAMBER_VECTOR_CLONES
void rounded_distances(const Row& row, float flat, float corner, float shrink, float* __restrict out) {
  const RoundedCutter<float> cutter{flat, corner};
  for (int k = 0; k < kPadded; ++k) {
    const auto n = static_cast<float>(k);
    const float x = row.start.x() + n * row.step.x(), y = row.start.y() + n * row.step.y();
    out[k] = cutter.distance(std::sqrt(x * x + y * y), row.start.z() + n * row.step.z()) + shrink;
  }
}

CAMBER_VECTOR_CLONES
void meridian_places(const Row& row, float* __restrict radius, float* __restrict height) {
  for (int k = 0; k < kPadded; ++k) {
    const auto n = static_cast<float>(k);
    const float x = row.start.x() + n * row.step.x(), y = row.start.y() + n * row.step.y();
    radius[k] = std::sqrt(x * x + y * y);
    height[k] = row.start.z() + n * row.step.z();
  }
}

void distances(const Carving& stamp, const Row& row, float* out) {
  static_assert(kPadded <= ProfileRows::kMost);
  const auto shrink = static_cast<float>(stamp.shrink_mm);
  if (!stamp.shape.general)
    return rounded_distances(row, static_cast<float>(stamp.shape.bottom_length_mm()),
                             static_cast<float>(stamp.shape.corner_radius_mm), shrink, out);
  alignas(64) std::array<float, kPadded> radius, height;
  meridian_places(row, radius.data(), height.data());
  stamp.profile.distances(radius.data(), height.data(), kPadded, out);
  for (int k = 0; k < kPadded; ++k) out[k] += shrink;
}

/// How far the voxels of a row that are not air lie above what the cutter would leave: the nearest; infinity if all are
/// air.
CAMBER_VECTOR_CLONES
float above_mm(const float* __restrict value, const float* __restrict distance, float band) {
  constexpr float kAir = 1e30f;
  float least = kAir;
  for (int k = 0; k < Tile::kSide; ++k) {
    const float above = value[k] < band ? value[k] + distance[k] : kAir;
    least = std::min(least, above);
  }
  return least;
}

/// How far the voxels of a row that are not air lie above what the cutter's lowest plane would leave.
CAMBER_VECTOR_CLONES
float above_plane_mm(const float* __restrict value, const Row& row, float shrink, float band) {
  constexpr float kAir = 1e30f;
  float least = kAir;
  for (int k = 0; k < Tile::kSide; ++k) {
    const float height = row.start.z() + static_cast<float>(k) * row.step.z() - shrink;
    least = std::min(least, value[k] < band ? value[k] - height : kAir);
  }
  return least;
}

float reach_mm(const StampDeflection& deflection) { return static_cast<float>(deflection.largest_mm + kRounding_mm); }

RowsDue::Now now_of(const Carving& stamp, const StampDeflection& deflection) {
  return {static_cast<float>(stamp.way.any_mm) + reach_mm(deflection),
          stamp.way.up_mm + deflection.axial_mm - kPlaneRounding_mm};
}

/// Calls cut(first voxel, row, distance) for the rows that the stamp may change.
template <class Cut>
void for_rows(Tile& tile, RowsDue& rows, const Index3& index, const Carving& stamp, const StampDeflection& deflection,
              Cut cut) {
  const auto band = static_cast<float>(stamp.band_mm), shrink = static_cast<float>(stamp.shrink_mm),
             reach = reach_mm(deflection);
  const float half_and_band = 0.5f * Tile::kCore * static_cast<float>(stamp.voxel_mm) + band;
  const RowsDue::Now now = now_of(stamp, deflection);
  if (!rows.due(now)) return;
  const Grid grid(index, stamp);
  alignas(64) std::array<float, kPadded> middle, distance;
  for (int i = 0; i < Tile::kSide; ++i) {
    if (!rows.due(now, i)) continue;
    distances(stamp, grid.middles(i), middle.data());
    for (int j = 0; j < Tile::kSide; ++j) {
      if (!rows.due(now, i, j)) continue;
      const float nearest = middle[static_cast<std::size_t>(j)] - half_and_band;
      if (nearest >= reach) {
        rows.set_above(i, j, stamp.way, nearest);
        continue;
      }
      const Row row = grid.row(i, j);
      const float* value = tile.distance.data() + Tile::offset(i, j, 0);
      distances(stamp, row, distance.data());
      const float above = above_mm(value, distance.data(), band);
      rows.set_above(i, j, stamp.way, above);
      if (above >= reach) continue;
      cut(Tile::offset(i, j, 0), row, distance.data());
      rows.set_above_plane(i, j, stamp.way, above_plane_mm(value, row, shrink, band));
    }
    rows.gather(i, now);
  }
  rows.gather();
}

}  // namespace

std::vector<Way> ways(std::span<const Stamp> stamps, const Vec3& lo, const Vec3& hi) {
  std::vector<Way> out(stamps.size());
  double farthest = 0;
  for (const Stamp& s : stamps)
    farthest = std::max(farthest, (lo - s.pose.tip_mm).cwiseAbs().cwiseMax((hi - s.pose.tip_mm).cwiseAbs()).norm());
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    const ToolPose &a = stamps[k - 1].pose, &b = stamps[k].pose;
    const Vec3 move = b.tip_mm - a.tip_mm;
    const double half = std::min(1.0, (b.axis - a.axis).norm() / 2), turn = 2 * std::asin(half) * farthest;
    out[k].any_mm = out[k - 1].any_mm + move.norm() + turn;
    out[k].up_mm = out[k - 1].up_mm - move.dot(b.axis) + turn;
  }
  return out;
}

void RowsDue::gather(int i, const Now& now) {
  First first{std::numeric_limits<float>::infinity(), std::numeric_limits<double>::infinity()};
  for (std::size_t row = at(i, 0); row < at(i + 1, 0); ++row) {
    if (up_[row] >= now.up_mm)
      first.up = std::min(first.up, up_[row]);
    else
      first.any = std::min(first.any, any_[row]);
  }
  of_i_[static_cast<std::size_t>(i)] = first;
}

void RowsDue::gather() {
  First first{std::numeric_limits<float>::infinity(), std::numeric_limits<double>::infinity()};
  for (const First& f : of_i_) first = {std::min(first.any, f.any), std::min(first.up, f.up)};
  tile_ = first;
}

bool is_due(const RowsDue& rows, const Carving& stamp, const StampDeflection& deflection) {
  return rows.due(now_of(stamp, deflection));
}

bool carve(Tile& tile, RowsDue& rows, const Index3& index, const Carving& stamp) {
  const auto band = static_cast<float>(stamp.band_mm);
  bool changed = false;
  for_rows(tile, rows, index, stamp, {}, [&](int first, const Row&, const float* distance) {
    float* value = tile.distance.data() + first;
    std::int32_t* id = tile.stamp.data() + first;
    for (int k = 0; k < Tile::kSide; ++k) {
      const float v = std::min(-distance[k], band);
      if (v <= value[k]) continue;
      value[k] = v, id[k] = stamp.id;
      changed = true;
    }
  });
  return changed;
}

bool DeflectedCarver::carve(Tile& tile, RowsDue& rows, const Index3& index, const Carving& stamp,
                            const StampDeflection& deflection) {
  if (deflection.largest_mm == 0) return tilted::carve(tile, rows, index, stamp);
  const auto band = static_cast<float>(stamp.band_mm), largest = static_cast<float>(deflection.largest_mm);
  voxel_.clear(), x_.clear(), y_.clear(), z_.clear();
  for_rows(tile, rows, index, stamp, deflection, [&](int first, const Row& row, const float* distance) {
    const float* value = tile.distance.data() + first;
    for (int k = 0; k < Tile::kSide; ++k) {
      if (std::min(largest - distance[k], band) <= value[k]) continue;
      const Eigen::Vector3f p = row.start + static_cast<float>(k) * row.step;
      voxel_.push_back(first + k);
      x_.push_back(p.x()), y_.push_back(p.y()), z_.push_back(p.z());
    }
  });
  if (voxel_.empty()) return false;
  settle(deflection);
  bool changed = false;
  for (std::size_t i = 0; i < voxel_.size(); ++i) {
    const auto at = static_cast<std::size_t>(voxel_[i]);
    const Vec3 settled(static_cast<double>(x_[i]), static_cast<double>(y_[i]), static_cast<double>(z_[i]));
    const float v = std::min(-static_cast<float>(stamp.shape.distance_mm(settled) + stamp.shrink_mm), band);
    if (v <= tile.distance[at]) continue;
    tile.distance[at] = v, tile.stamp[at] = stamp.id;
    changed = true;
  }
  return changed;
}

/// Takes the deflections of the envelope's points that are displaced to the places off them.
void DeflectedCarver::settle(const StampDeflection& deflection) {
  constexpr std::size_t kVector = 8;
  if (envelope_.shape.general) {
    for (std::size_t i = 0; i < voxel_.size(); ++i) {
      const Vec3 at(static_cast<double>(x_[i]), static_cast<double>(y_[i]), static_cast<double>(z_[i]));
      const Vec3 settled = at - upright::settled_deflection(envelope_, deflections_, deflection.row, at, Vec3::Zero());
      x_[i] = static_cast<float>(settled.x()), y_[i] = static_cast<float>(settled.y());
      z_[i] = static_cast<float>(settled.z());
    }
    return;
  }
  while (x_.size() % kVector != 0) x_.push_back(x_.back()), y_.push_back(y_.back()), z_.push_back(z_.back());
  zero_.assign(x_.size(), 0.0f), one_.assign(x_.size(), 1.0f), row_.assign(x_.size(), 0);
  thickness_.resize(x_.size());
  const upright::DeflectionRow row{deflection.row,
                                   nullptr,
                                   static_cast<int>(deflections_.nodes()),
                                   deflections_.steps,
                                   deflections_.nodes() > 1 ? static_cast<float>(deflections_.node_height_mm[1]) : 1.0f,
                                   deflections_.axial};
  upright::kernels().thin_pairs(
      {static_cast<int>(x_.size()), x_.data(), y_.data(), z_.data(), one_.data(), zero_.data(), zero_.data(),
       zero_.data(), zero_.data(), zero_.data(), one_.data(), row_.data(), zero_.data(), row,
       static_cast<float>(envelope_.lag_per_mm), static_cast<float>(envelope_.steps / (2 * kPi)), thickness_.data()},
      static_cast<float>(envelope_.shape.bottom_length_mm()), static_cast<float>(envelope_.shape.corner_radius_mm),
      0.05f);
}

}  // namespace camber::removal::tilted
