#include "removal/field/upright/stamp_order.h"

#include <algorithm>
#include <cmath>

namespace camber::removal::upright {
namespace {

constexpr std::size_t kLongestBatch = 64;
constexpr std::size_t kMaxEarlier = 6;  ///< more than these: a new batch is cheaper

/// The inequality of the header, for spheres, or for circles when the vectors are level.
bool spheres_covered(const Vec3& f, const Vec3& u, double radius) {
  const double step = f.norm(), along = u.dot(f) / step;
  if (!(step > 0) || along >= 0) return false;
  const double across = (u - along / step * f).norm();
  // Points that still cut may lean back by step / 2R.
  return along * step - 0.5 * u.squaredNorm() + radius * across - 0.5 * along * step <= 0;
}

/// True where stamp `before` (right before `tip`) leaves less than `earlier` wherever the cutter moves into material.
bool covers(const Vec3& tip, const Vec3& before, const Vec3& earlier, const CutterShape& shape) {
  const Vec3 f = tip - before, u = earlier - before;
  constexpr double kStraight = 1e-6;
  if (u.dot(f) < 0 && (u - u.dot(f) / f.squaredNorm() * f).norm() <= kStraight) return true;
  const bool level = std::abs(f.z()) < kStraight && std::abs(u.z()) < kStraight;
  // The distance to a flat end mill grows with the distance from its axis and with the height of its tip, and its
  // bottom cuts where it descends: under the disc of the one right before, or in front of it, like the wall.
  const bool sharp = !shape.general && shape.corner_radius_mm == 0;
  if (sharp && (before.z() <= earlier.z() || f.z() >= 0))
    return spheres_covered({f.x(), f.y(), 0}, {u.x(), u.y(), 0}, shape.radius_mm);
  // Between bottom and wall of other cutters with a flat there is more than spheres and circles.
  if (!level && (shape.bottom_length_mm() > 0 || !spheres_covered(f, u, shape.radius_mm))) return false;
  return spheres_covered({f.x(), f.y(), 0}, {u.x(), u.y(), 0}, shape.radius_mm);
}

}  // namespace

StampOrder StampOrder::of_path(std::span<const Stamp> stamps, const CutterShape& shape) {
  StampOrder order;
  std::int32_t batch = -1;
  std::size_t begin = 0;
  std::vector<std::int32_t> earlier;
  order.first_.push_back(0);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    earlier.clear();
    bool fresh = k == 0 || stamps[k].first || k - begin >= kLongestBatch;
    for (std::size_t j = begin; !fresh && j + 1 < k; ++j) {
      if (!covers(stamps[k].pose.tip_mm, stamps[k - 1].pose.tip_mm, stamps[j].pose.tip_mm, shape))
        earlier.push_back(static_cast<std::int32_t>(j));
      fresh = earlier.size() > kMaxEarlier;
    }
    if (fresh) {
      begin = k;
      ++batch;
      earlier.clear();
    }
    order.batch_.push_back(batch);
    order.earlier_.insert(order.earlier_.end(), earlier.begin(), earlier.end());
    order.first_.push_back(order.earlier_.size());
  }
  return order;
}

}  // namespace camber::removal::upright
