#pragma once
// A smooth curve through the points of a path, within a tolerance.
#include <span>
#include <vector>

#include "base/geometry.h"

namespace camber::repath {

/// A natural cubic spline over the points' chord length, from the first point to the last. The points in between are
/// moved by at most `tolerance_mm`, such that the integral of the squared second derivative becomes least for the
/// largest weight that the tolerance allows: the corners and the noise of the CAM system's chords go, the shape stays.
/// Source: Reinsch, Smoothing by spline functions, Numerische Mathematik 10 (1967), with the ends held fast.
class SmoothCurve {
 public:
  /// At least two points, no two that follow each other alike. Time and memory grow linearly with their number.
  SmoothCurve(std::span<const Vec3> points, double tolerance_mm);

  double length_mm() const { return knots_.back(); }  ///< of the chords
  const std::vector<double>& knots_mm() const { return knots_; }
  Vec3 at(double s_mm) const;
  double largest_move_mm() const { return largest_move_; }  ///< of a point

 private:
  void solve(std::span<const Vec3> points, double weight);
  std::vector<double> knots_;
  std::vector<Vec3> values_, second_;  ///< at the knots
  double largest_move_ = 0;
};

}  // namespace camber::repath
