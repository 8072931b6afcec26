#pragma once
// Where a cutter has room among what stays.
#include <functional>
#include <vector>

#include "plan/triangle_solid.h"

namespace camber::plan {

/// Upright, seen from above.
struct Rect {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  double distance(double x, double y) const;
  double distance(const Rect& other) const;
  bool holds(double x, double y) const { return x >= x0 && x <= x1 && y >= y0 && y <= y1; }
};

/// A grid over a window, with the places where something stands.
class Room {
 public:
  /// Obstacles are the places of `middles` and a radius round it where `stays` is higher than `above_mm`. Steps are a
  /// twelfth of the radius where that makes 200 to 800 of them along the longer side.
  Room(const TriangleSolid& stays, const Rect& middles, double radius_mm, double above_mm);

  /// Area of the places that `wanted` names and where nothing stands, but which no cutter covers whose middle is within
  /// `middles` and which touches no obstacle. Exact to about a step along the outlines.
  double unreached_mm2(const std::function<bool(double, double)>& wanted) const;
  /// Area of what stands where `wanted` says.
  double standing_mm2(const std::function<bool(double, double)>& wanted) const;

 private:
  double x(int i) const { return low_.x() + (i + 0.5) * step_mm_; }
  double y(int j) const { return low_.y() + (j + 0.5) * step_mm_; }
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(j);
  }
  void stand(const TriangleSolid& stays, const Triangle& t, double above_mm);

  Rect middles_;
  double radius_mm_, step_mm_;
  Vec2 low_;
  int nx_, ny_;
  std::vector<char> stands_;
};

}  // namespace camber::plan
