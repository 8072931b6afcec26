// Which vertices are corners.
#include <algorithm>
#include <cmath>

#include "repath/fit.h"

namespace camber::repath {
namespace {

/// A vertex with legs to both sides that are at least so long, or end with the polyline.
struct Legs {
  std::uint32_t back = 0, ahead = 0;
};

double turn_at(std::span<const Vec2> points, std::uint32_t k, const Legs& legs) {
  const Vec2 in = points[k] - points[legs.back], out = points[legs.ahead] - points[k];
  return std::abs(std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out)));
}

}  // namespace

std::vector<bool> corners_of(std::span<const Vec2> points, const FitOptions& options) {
  const auto n = static_cast<std::uint32_t>(points.size());
  std::vector<bool> corners(n, false);
  if (n < 3) return corners;
  const double leg_mm = 5 * options.tolerance_mm;
  std::vector<double> length(n, 0), turn(n, 0);
  std::vector<Legs> legs(n);
  for (std::uint32_t k = 1; k < n; ++k) length[k] = length[k - 1] + (points[k] - points[k - 1]).norm();
  for (std::uint32_t k = 1, back = 0, ahead = 1; k + 1 < n; ++k) {
    while (back + 1 < k && length[k] - length[back + 1] >= leg_mm) ++back;
    ahead = std::max(ahead, k + 1);
    while (ahead + 1 < n && length[ahead] - length[k] < leg_mm) ++ahead;
    legs[k] = {back, ahead};
    turn[k] = turn_at(points, k, legs[k]);
  }
  for (std::uint32_t k = 1; k + 1 < n; ++k) {
    if (turn[k] <= options.corner_rad || turn[k] <= 2 * std::max(turn[legs[k].back], turn[legs[k].ahead])) continue;
    bool sharpest = true;  // its neighbours within the legs see a part of the same turn
    for (std::uint32_t i = legs[k].back + 1; sharpest && i < legs[k].ahead; ++i)
      sharpest = turn[i] < turn[k] || (turn[i] == turn[k] && i >= k);
    corners[k] = sharpest;
  }
  return corners;
}

}  // namespace camber::repath
