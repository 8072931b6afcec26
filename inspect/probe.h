#pragma once
// Where an instrument reads a feature: places on its nominal shape, and what the predicted surface is there.
#include <span>
#include <vector>

#include "inspect/surface_chart.h"
#include "machine/features.h"
#include "removal/form_error.h"

namespace camber::inspect {

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

}  // namespace camber::inspect
