#include "copymill/axis_region.h"

#include <algorithm>

namespace camber::copymill {
namespace {

bool over(const machine::CopyRegion::Box& box, const Vec2& p) {
  return (p.array() >= box[0].head<2>().array()).all() && (p.array() <= box[1].head<2>().array()).all();
}

}  // namespace

AxisRegion::AxisRegion(const machine::CopyRegion& region, const Vec2& stock_min, const Vec2& stock_max)
    : polygon_(region.polygon_mm), boxes_(region.boxes_mm), min_(stock_min), max_(stock_max) {
  if (region.box_mm) min_ = (*region.box_mm)[0], max_ = (*region.box_mm)[1];
  if (!boxes_.empty()) {
    min_ = boxes_.front()[0].head<2>(), max_ = boxes_.front()[1].head<2>();
    for (const auto& b : boxes_) min_ = min_.cwiseMin(b[0].head<2>()), max_ = max_.cwiseMax(b[1].head<2>());
  }
  if (polygon_.empty()) return;
  min_ = max_ = polygon_.front();
  for (const Vec2& p : polygon_) min_ = min_.cwiseMin(p), max_ = max_.cwiseMax(p);
}

bool AxisRegion::contains(const Vec2& p, double z) const {
  if (boxes_.empty()) return contains(p);
  constexpr double kRounding_mm = 1e-4;
  return std::ranges::any_of(
      boxes_, [&](const auto& b) { return z >= b[0].z() - kRounding_mm && z < b[1].z() - kRounding_mm && over(b, p); });
}

bool AxisRegion::contains(const Vec2& p) const {
  if ((p.array() < min_.array()).any() || (p.array() > max_.array()).any()) return false;
  if (!boxes_.empty()) return std::ranges::any_of(boxes_, [&](const auto& b) { return over(b, p); });
  if (polygon_.empty()) return true;
  bool in = false;
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    const Vec2 &a = polygon_[k], &b = polygon_[(k + 1) % polygon_.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) in = !in;
  }
  return in;
}

}  // namespace camber::copymill
