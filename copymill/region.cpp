#include "copymill/region.h"

namespace camber::copymill {

AxisRegion::AxisRegion(const machine::CopyRegion& region, const Vec2& stock_min, const Vec2& stock_max)
    : polygon_(region.polygon_mm), min_(stock_min), max_(stock_max) {
  if (region.box_mm) min_ = (*region.box_mm)[0], max_ = (*region.box_mm)[1];
  if (polygon_.empty()) return;
  min_ = max_ = polygon_.front();
  for (const Vec2& p : polygon_) min_ = min_.cwiseMin(p), max_ = max_.cwiseMax(p);
}

bool AxisRegion::contains(const Vec2& p) const {
  if ((p.array() < min_.array()).any() || (p.array() > max_.array()).any()) return false;
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
