#include "copymill/pass.h"

#include <algorithm>
#include <cmath>

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

}  // namespace camber::copymill
