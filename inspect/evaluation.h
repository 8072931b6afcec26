#pragma once
// A feature being evaluated, and where an instrument reads it; private to inspect/.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "inspect/evaluate.h"
#include "machine/features.h"
#include "removal/form_error.h"

namespace camber::inspect {

/// A point of the surface beside a feature's nominal shape.
struct ChartPoint {
  double u_mm = 0, v_mm = 0;  ///< along the nominal shape
  double nominal_mm = 0;      ///< height of the programmed surface above the shape, along the chart's outward direction
  double contour_mm = 0, deflection_mm = 0;  ///< what lag and corners, and bending, add to it
  double area_mm2 = 0;
  bool valid = true;  ///< the model holds here
};

/// Heights at a place; their sum is that of the machined surface.
struct Reading {
  double nominal_mm = 0, contour_mm = 0, deflection_mm = 0;
  double machined_mm() const { return nominal_mm + contour_mm + deflection_mm; }
};

class SurfaceChart {
 public:
  /// `reach_mm`: half the width of what a reading averages over, about one and a half voxels. `period_mm` > 0: u goes
  /// round (a cylinder's circumference).
  SurfaceChart(double reach_mm, double period_mm = 0);
  void add(const ChartPoint& point);
  bool empty() const { return points_.empty(); }
  const std::vector<ChartPoint>& points() const { return points_; }
  /// Mean of the points nearby, weighted by area and falling off linearly to zero at the reach (twice that where there
  /// are none). Nothing where the surface has no point, or more than half of it is beyond the model.
  std::optional<Reading> at(double u_mm, double v_mm) const;

 private:
  std::int64_t cell(double u, double v) const;
  std::optional<Reading> within(double u, double v, double reach) const;

  double reach_mm_, period_mm_;
  std::vector<ChartPoint> points_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

/// Which of the three heights a size is worked out from.
enum class Layer { nominal, contour, machined };
double height_of(const Reading& reading, Layer layer);

/// A face of the nominal part: a cylinder about its axis, or a plane.
struct Face {
  Vec3 origin_mm = Vec3::Zero();
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitY();  ///< plane: along it. Cylinder: u where angles count from, v across both
  Vec3 w = Vec3::UnitZ();                     ///< plane: outward from the material. Cylinder: along the axis
  double radius_mm = 0;                       ///< 0: a plane
  bool hollow = false;                        ///< cylinder: the material is outside
  double reach_mm = 0;                        ///< plane: radius about the origin; 0: all of it
};

/// Cylinder of a bore or boss: origin axis_mm[0], w towards axis_mm[1]; angles are counter-clockwise as seen from +Z.
Face cylinder_face(const machine::Feature& feature);
/// Plane through `point` with the outward normal; u is level where the plane is not.
Face plane_face(const Vec3& point, const Vec3& outward, double reach_mm);

/// Points of the surface near the face (a quarter of a millimetre, less on small bores) whose normals agree with it.
/// Chart coordinates: plane u, v; cylinder radius times angle, and the distance along the axis. Heights: plane along w;
/// cylinder radially outward, from the nominal radius.
SurfaceChart chart_of(const Face& face, std::span<const removal::SurfacePoint> surface, double voxel_mm);

/// A reading with its place.
struct Probed {
  double u_mm = 0, v_mm = 0;
  Reading reading;
};
struct Probing {
  std::vector<Probed> readings;
  std::size_t missed = 0;
  bool enough() const { return readings.size() > missed; }
};
Probing probe(const SurfaceChart& chart, const std::vector<std::array<double, 2>>& places);

/// Where the surface is along a cylinder: the point of a reading.
Vec3 place_on(const Face& face, const Probed& probed, Layer layer);

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
