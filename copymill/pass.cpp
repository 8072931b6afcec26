#include "copymill/pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::copymill {

Pass at_height(const FlatPass& pass, double z_mm) {
  Pass out{.points = {}, .closed = pass.closed};
  for (const Vec2& p : pass.points) out.points.emplace_back(p.x(), p.y(), z_mm);
  return out;
}

FlatPass reversed(FlatPass pass) {
  std::ranges::reverse(pass.points);
  return pass;
}

Pass reversed(Pass pass) {
  std::ranges::reverse(pass.points);
  return pass;
}

void start_near(Pass& pass, const Vec3& place) {
  if (!pass.closed) return;
  const auto nearest =
      std::ranges::min_element(pass.points, {}, [&](const Vec3& p) { return (p - place).head<2>().squaredNorm(); });
  std::ranges::rotate(pass.points, nearest);
}

double length_mm(const Pass& pass) {
  double out = 0;
  for (std::size_t k = 1; k < pass.points.size(); ++k) out += (pass.points[k] - pass.points[k - 1]).norm();
  if (pass.closed && !pass.points.empty()) out += (pass.points.front() - pass.points.back()).norm();
  return out;
}

std::vector<Vec3> dense(const Pass& pass, double step_mm) {
  std::vector<Vec3> out;
  const std::size_t n = pass.points.size(), legs = pass.closed ? n : n - 1;
  for (std::size_t k = 0; k < legs; ++k) {
    const Vec3 &a = pass.points[k], &b = pass.points[(k + 1) % n];
    const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step_mm)));
    for (int i = 0; i < parts; ++i) out.push_back(a + static_cast<double>(i) / parts * (b - a));
  }
  if (!pass.closed && n > 0) out.push_back(pass.points.back());
  return out;
}

std::vector<Pass> stretches(const Pass& pass, double step, const std::function<bool(const Vec3&)>& wanted, double lead,
                            double join) {
  const std::vector<Vec3> points = dense(pass, step);
  const std::size_t n = points.size();
  std::vector<char> in(n);
  for (std::size_t k = 0; k < n; ++k) in[k] = wanted(points[k]) ? 1 : 0;
  if (std::ranges::find(in, 0) == in.end()) return {pass};
  if (std::ranges::find(in, 1) == in.end()) return {};
  // From a place that is not wanted on; an open pass from its beginning.
  const std::size_t first = pass.closed ? static_cast<std::size_t>(std::ranges::find(in, 0) - in.begin()) : 0;
  const auto leads = static_cast<std::ptrdiff_t>(std::ceil(lead / step));
  const auto joins = static_cast<std::ptrdiff_t>(std::ceil(join / step)) + 2 * leads;
  struct Range {
    std::ptrdiff_t from, to;
  };
  std::vector<Range> ranges;
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(n); ++i) {
    if (!in[(first + static_cast<std::size_t>(i)) % n]) continue;
    if (!ranges.empty() && i - ranges.back().to <= joins)
      ranges.back().to = i;
    else
      ranges.push_back({i, i});
  }
  std::vector<Pass> out;
  const auto last = static_cast<std::ptrdiff_t>(n) - 1;
  for (const Range& r : ranges) {
    Pass piece;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, r.from - leads);
         i <= std::min(last + (pass.closed ? 1 : 0), r.to + leads); ++i)
      piece.points.push_back(points[(first + static_cast<std::size_t>(i)) % n]);
    if (piece.points.size() >= 2) out.push_back(std::move(piece));
  }
  if (pass.closed && out.size() == 1 && out[0].points.size() + static_cast<std::size_t>(joins) >= n) return {pass};
  return out;
}

double distance_mm(const std::vector<Vec3>& line, const Vec3& place) {
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Vec3 &a = line[k], way = line[std::min(k + 1, line.size() - 1)] - a;
    const double t = way.squaredNorm() > 0 ? std::clamp((place - a).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
    least2 = std::min(least2, (a + t * way - place).squaredNorm());
  }
  return std::sqrt(least2);
}

}  // namespace camber::copymill
