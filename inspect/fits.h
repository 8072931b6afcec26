#pragma once
// Planes, circles and cylinders through measured points: least squares, minimum zone, inscribed and circumscribed.
//
// Definitions: ISO 14405-1 (sizes), ISO 1101 (zones), NIST SP 250-39 / ISO 10360-6 (what a fit's reference software
// must return: the parameters that minimize the sum of squares, or the largest magnitude, of the normal distances).
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/geometry.h"
#include "machine/features.h"

namespace camber::inspect {

using machine::FeatureFilter;

struct PlaneFit {
  Vec3 point_mm = Vec3::Zero();  ///< centroid of the points, moved along the normal onto the plane
  Vec3 normal = Vec3::UnitZ();   ///< unit
  double zone_mm = 0;            ///< flatness: greatest minus least distance
  bool converged = false;
};

struct CircleFit {
  Vec2 centre_mm = Vec2::Zero();
  double radius_mm = 0;
  double zone_mm = 0;  ///< roundness: greatest minus least distance from the centre
  bool converged = false;
};

struct CylinderFit {
  Vec3 point_mm = Vec3::Zero();  ///< point of the axis nearest to the centroid
  Vec3 axis = Vec3::UnitZ();     ///< unit
  double radius_mm = 0;
  double zone_mm = 0;  ///< cylindricity
  bool converged = false;
};

/// min_zone: the least distance between two parallel planes that hold all points, the plane halfway between; otherwise
/// least squares (the axis of least inertia, exact). Three points or more that are not in line.
PlaneFit fit_plane(std::span<const Vec3> points, FeatureFilter filter);

/// Least squares by Gauss-Newton from the centroid; the others from there by linear programs over linearized
/// distances, each step within a trust region, to 1e-12 mm. min_zone: two concentric circles, the radius halfway
/// between. max_inscribed is a local optimum, the one nearest to the least-squares circle. Three points or more;
/// `converged` is false where they do not determine a circle.
CircleFit fit_circle(std::span<const Vec2> points, FeatureFilter filter);

/// The same of a cylinder near `axis` (a direction within about 10 degrees). Five points or more.
CylinderFit fit_cylinder(std::span<const Vec3> points, const Vec3& axis, FeatureFilter filter);

// Small linear programs: few unknowns, many inequalities.

/// row . x <= bound.
struct Inequality {
  Eigen::VectorXd row;
  double bound = 0;
};

struct LinearOptimum {
  Eigen::VectorXd x;
  std::vector<std::size_t> active;  ///< inequalities that determine x, of those given
  bool optimal = false;             ///< false: no x fulfils all of them, or too many steps
};

/// Minimizes cost . x subject to the inequalities and |x_j| <= box_j, by the dual simplex method: starts at a corner of
/// the box, exchanges the most violated inequality for an active one, and ends where none is violated. box_j > 0.
/// Source: Chvatal, Linear Programming (1983), ch. 10. Exact to rounding (1e-12 of the numbers); for tens of unknowns.
LinearOptimum minimize(const Eigen::VectorXd& cost, const std::vector<Inequality>& inequalities,
                       const Eigen::VectorXd& box);

}  // namespace camber::inspect
