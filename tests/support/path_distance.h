#pragma once
// How far two tool paths are apart, by points laid densely on both: nothing of repath/ is used.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "nc/move.h"

namespace camber::tests {

/// Points of the cutting moves at most `step_mm` apart, in order.
inline std::vector<Vec3> sampled(const nc::Interpretation& program, double step_mm) {
  std::vector<Vec3> points;
  for (const nc::Move& m : program.moves) {
    if (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) continue;
    const int n = std::max(1, static_cast<int>(std::ceil(nc::length_mm(program, m) / step_mm)));
    for (int i = 0; i <= n; ++i) points.push_back(nc::point_at(program, m, static_cast<double>(i) / n));
  }
  return points;
}

/// Greatest distance from a point of `from` to the nearest of `to`, looked up in cells. Distances above `cell_mm` come
/// out as infinite.
inline double farthest_from(const std::vector<Vec3>& from, const std::vector<Vec3>& to, double cell_mm) {
  std::map<std::array<long, 3>, std::vector<const Vec3*>> cells;
  const auto cell = [&](const Vec3& p) {
    return std::array<long, 3>{std::lround(std::floor(p.x() / cell_mm)), std::lround(std::floor(p.y() / cell_mm)),
                               std::lround(std::floor(p.z() / cell_mm))};
  };
  for (const Vec3& p : to) cells[cell(p)].push_back(&p);
  double worst = 0;
  for (const Vec3& p : from) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto c = cell(p);
    for (long dx = -1; dx <= 1; ++dx)
      for (long dy = -1; dy <= 1; ++dy)
        for (long dz = -1; dz <= 1; ++dz)
          if (const auto found = cells.find({c[0] + dx, c[1] + dy, c[2] + dz}); found != cells.end())
            for (const Vec3* q : found->second) nearest = std::min(nearest, (p - *q).norm());
    worst = std::max(worst, nearest);
  }
  return worst;
}

/// Both ways. The samples lie `step_mm` apart, so the result may be too large by a half of it squared over twice the
/// distance; and it misses what happens between them by less.
inline double hausdorff_mm(const nc::Interpretation& a, const nc::Interpretation& b, double step_mm) {
  const auto pa = sampled(a, step_mm), pb = sampled(b, step_mm);
  return std::max(farthest_from(pa, pb, 20 * step_mm), farthest_from(pb, pa, 20 * step_mm));
}

}  // namespace camber::tests
