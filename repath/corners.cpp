#include "repath/corners.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "repath/fit.h"

namespace camber::repath {

std::vector<bool> corners_of(std::span<const Vec3> points, const CornerRule& rule) {
  const std::size_t n = points.size();
  std::vector<bool> corners(n, false);
  if (n < 3) return corners;
  struct Legs {
    std::size_t back = 0, ahead = 0;
  };
  std::vector<double> length(n, 0), turn(n, 0);
  std::vector<Legs> legs(n);
  for (std::size_t k = 1; k < n; ++k) length[k] = length[k - 1] + (points[k] - points[k - 1]).norm();
  for (std::size_t k = 1, back = 0, ahead = 1; k + 1 < n; ++k) {
    while (back + 1 < k && length[k] - length[back + 1] >= rule.leg_mm) ++back;
    ahead = std::max(ahead, k + 1);
    while (ahead + 1 < n && length[ahead] - length[k] < rule.leg_mm) ++ahead;
    legs[k] = {back, ahead};
    const Vec3 in = points[k] - points[back], out = points[ahead] - points[k];
    turn[k] = std::atan2(in.cross(out).norm(), in.dot(out));
  }
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double beside = std::max(turn[legs[k].back], turn[legs[k].ahead]);
    const bool stands_out = turn[k] > rule.always_rad || turn[k] > rule.times_beside * beside;
    if (turn[k] <= rule.least_rad || !stands_out) continue;
    bool sharpest = true;  // its neighbours within the legs see a part of the same turn
    for (std::size_t i = legs[k].back + 1; sharpest && i < legs[k].ahead; ++i)
      sharpest = turn[i] < turn[k] || (turn[i] == turn[k] && i >= k);
    corners[k] = sharpest;
  }
  return corners;
}

std::vector<bool> corners_of(const Polyline& path, const FitOptions& options) {
  std::vector<Vec3> in_space;
  in_space.reserve(path.points.size());
  for (std::size_t k = 0; k < path.points.size(); ++k) in_space.push_back(path.at(k));
  return corners_of(in_space, {.least_rad = options.corner_rad, .leg_mm = 5 * options.tolerance_mm});
}

}  // namespace camber::repath
