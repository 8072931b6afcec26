#pragma once
// A feature being evaluated; private to inspect/.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "inspect/evaluate.h"
#include "inspect/probe.h"

namespace camber::inspect {

using machine::Feature;
using machine::FeatureFilter;
using machine::FeatureKind;
using Places = std::vector<std::array<double, 2>>;

inline constexpr int kCircles = 9;  ///< along an axis, or a depth

/// A feature being evaluated.
struct Evaluation {
  const Feature& feature;
  std::span<const removal::SurfacePoint> surface;
  double voxel_mm;
  FeatureResult& out;
  std::array<Vec3, 3> middle_mm{};  ///< middle of the feature as programmed, with contour error, and machined (Layer)
  std::vector<Vec3> constrained{};  ///< unit directions along which its place is known
  bool placed = false;

  const Vec3& machined_middle_mm() const { return middle_mm[2]; }
  /// Counts the readings; true, and a reason, where there are too few.
  bool failed(const Probing& probing);
  void set_sizes(double nominal, double contour, double machined);
};

/// `count` places from `from` to `to`, both among them.
std::vector<double> spread(double from, double to, int count);
/// The same within a length, a tenth of it away from its ends: nobody measures at an edge.
std::vector<double> within_margins(double length, int count);

struct Line {
  double at_zero = 0, slope = 0;
};
/// Least squares y = at_zero + slope x; level where there are fewer than two different x.
Line fit_line(const std::vector<double>& x, const std::vector<double>& y);

double spread_of(const std::vector<double>& values);  ///< greatest minus least
/// min_zone: the least one; otherwise the mean.
double size_by(const std::vector<double>& sizes, FeatureFilter filter);

// What a feature is made of, by its kind.
void evaluate_cylinder(Evaluation& e);  ///< bore, boss
void evaluate_plane(Evaluation& e);
void evaluate_slot(Evaluation& e);
void evaluate_wall(Evaluation& e);
void evaluate_points(Evaluation& e);
void evaluate_point_distance(Evaluation& e);  ///< between surfaces that face along the line through two points
/// Evaluates the distance of the middles of two features, along the line between their nominal places and across
/// their axes.
void evaluate_distance_of(Evaluation& e, const Evaluation& a, const Evaluation& b);

}  // namespace camber::inspect
