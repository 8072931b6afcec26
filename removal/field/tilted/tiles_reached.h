#pragma once
// Which tiles of the stock a tilted cutter comes near.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/tool_pose.h"
#include "removal/cutter.h"
#include "removal/field/slot_map.h"
#include "removal/field/tile.h"

namespace camber::removal::tilted {

/// Box around the part of a cutter that is within `reach_mm` of a box of the part's frame; a cutter has no upper end.
struct ReachedBox {
  Vec3 lo, hi;
};
inline ReachedBox bounds_in(const CutterShape& shape, const ToolPose& pose, double reach_mm, const ReachedBox& box) {
  const double around = shape.radius_mm + reach_mm;
  // Beyond `up` above the tip the axis is farther from the box than the cutter is wide.
  const Vec3 farthest = (box.lo - pose.tip_mm).cwiseAbs().cwiseMax((box.hi - pose.tip_mm).cwiseAbs());
  const Vec3 end = pose.tip_mm + (farthest.norm() + around) * pose.axis;
  const Vec3 margin = Vec3::Constant(around);
  return {(pose.tip_mm.cwiseMin(end) - margin).cwiseMax(box.lo), (pose.tip_mm.cwiseMax(end) + margin).cwiseMin(box.hi)};
}

/// Calls f(place in slots.all()) for every tile of `slots` that the cutter comes within `reach_mm` of, and for some
/// around them: a tile counts as the sphere about it.
template <class Function>
void for_each_tile_reached(const SlotMap& slots, double voxel_mm, const CutterShape& shape, const ToolPose& pose,
                           double reach_mm, Function f) {
  const double tile_mm = Tile::kCore * voxel_mm, sphere = std::sqrt(3.0) / 2 * tile_mm;
  const Mat3 frame = tool_frame(pose);
  int major = 0;
  pose.axis.cwiseAbs().maxCoeff(&major);
  const int a = (major + 1) % 3, b = (major + 2) % 3;
  const double slope_a = pose.axis[a] / pose.axis[major], slope_b = pose.axis[b] / pose.axis[major];
  const double around = (shape.radius_mm + reach_mm) / std::abs(pose.axis[major]) + tile_mm;
  const Index3 first = slots.first(), n = slots.extent();
  const auto at = [&](int axis) { return static_cast<std::size_t>(axis); };
  // Slab by slab along the axis' largest component: there the cutter is an ellipse about the axis.
  for (int s = first[at(major)]; s < first[at(major)] + n[at(major)]; ++s) {
    const double up = (s + 0.5) * tile_mm - pose.tip_mm[major];
    if (up * pose.axis[major] < -(shape.radius_mm + reach_mm + tile_mm)) continue;
    const auto range = [&](int axis, double slope) {
      const double middle = pose.tip_mm[axis] + up * slope;
      return std::array<int, 2>{
          std::max(static_cast<int>(std::floor((middle - around) / tile_mm)), first[at(axis)]),
          std::min(static_cast<int>(std::floor((middle + around) / tile_mm)), first[at(axis)] + n[at(axis)] - 1)};
    };
    const auto range_a = range(a, slope_a), range_b = range(b, slope_b);
    Index3 tile;
    tile[at(major)] = s;
    for (tile[at(a)] = range_a[0]; tile[at(a)] <= range_a[1]; ++tile[at(a)])
      for (tile[at(b)] = range_b[0]; tile[at(b)] <= range_b[1]; ++tile[at(b)]) {
        const Vec3 centre = tile_mm * (Vec3(tile[0], tile[1], tile[2]) + Vec3::Constant(0.5));
        if (shape.distance_mm(frame.transpose() * (centre - pose.tip_mm)) <= reach_mm + sphere)
          f(slots.place(tile[0], tile[1], tile[2]));
      }
  }
}

}  // namespace camber::removal::tilted
