#include "repath/compress/corners.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "repath/compress/fit.h"

namespace camber::repath {

namespace {

/// The vertices that the legs of each vertex reach, and the turns between the legs.
struct Turns {
  struct Legs {
    std::size_t back = 0, ahead = 0;
  };
  std::vector<Legs> legs;
  std::vector<double> turn;
};

Turns turns_between_legs(std::span<const Vec3> points, double leg_mm) {
  const std::size_t n = points.size();
  std::vector<double> length(n, 0);
  Turns out{std::vector<Turns::Legs>(n), std::vector<double>(n, 0)};
  for (std::size_t k = 1; k < n; ++k) length[k] = length[k - 1] + (points[k] - points[k - 1]).norm();
  for (std::size_t k = 1, back = 0, ahead = 1; k + 1 < n; ++k) {
    while (back + 1 < k && length[k] - length[back + 1] >= leg_mm) ++back;
    ahead = std::max(ahead, k + 1);
    while (ahead + 1 < n && length[ahead] - length[k] < leg_mm) ++ahead;
    out.legs[k] = {back, ahead};
    const Vec3 in = points[k] - points[back], behind = points[ahead] - points[k];
    out.turn[k] = std::atan2(in.cross(behind).norm(), in.dot(behind));
  }
  return out;
}

}  // namespace

std::vector<double> turns_of(std::span<const Vec3> points, double leg_mm) {
  return turns_between_legs(points, leg_mm).turn;
}

std::vector<bool> corners_of(std::span<const Vec3> points, const CornerRule& rule) {
  const std::size_t n = points.size();
  std::vector<bool> corners(n, false);
  if (n < 3) return corners;
  const auto [legs, turn] = turns_between_legs(points, rule.leg_mm);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double beside = std::max(turn[legs[k].back], turn[legs[k].ahead]);
    const bool stands_out = turn[k] > rule.always_rad || turn[k] > rule.times_beside * beside;
    if (turn[k] <= rule.min_turn_rad || !stands_out) continue;
    bool sharpest = true;  // its neighbours within the legs see a part of the same turn
    for (std::size_t i = legs[k].back + 1; sharpest && i < legs[k].ahead; ++i)
      sharpest = turn[i] < turn[k] || (turn[i] == turn[k] && i >= k);
    corners[k] = sharpest;
  }
  return corners;
}

double corner_leg_mm(const FitOptions& options) { return 5 * options.tolerance_mm; }

std::vector<Vec3> in_space(const Polyline& path) {
  std::vector<Vec3> out;
  out.reserve(path.points.size());
  for (std::size_t k = 0; k < path.points.size(); ++k) out.push_back(path.at(k));
  return out;
}

std::vector<bool> ends_of(const Polyline& path, const std::vector<bool>& corners) {
  std::vector<bool> out = corners;
  for (const std::uint32_t end : path.ends) out[end] = true;
  return out;
}

std::vector<bool> corners_of(const Polyline& path, const FitOptions& options) {
  return corners_of(in_space(path), {.min_turn_rad = options.corner_rad, .leg_mm = corner_leg_mm(options)});
}

}  // namespace camber::repath
