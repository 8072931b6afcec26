#pragma once
// The faces of a solid: planes along the axes, upright round holes, inner corners; what else there is is free-form.
#include <array>
#include <vector>

#include "plan/triangle_solid.h"

namespace camber::plan {

struct FaceOptions {
  double plane_tolerance_mm = 0.01;   ///< planes nearer to each other are one
  double circle_tolerance_mm = 0.02;  ///< tolerance of the corners of a hole's facets
  double min_face_mm2 = 0.2;          ///< smaller planes are not looked at
};

struct AxisPlane {
  double at_mm = 0, area_mm2 = 0;
  bool face = true;          ///< false: a bound of a face that is no plane along the axes
  double length_mm = 1e300;  ///< length of upright walls: of the longest one, seen from above
};

/// An upright round hole.
struct Hole {
  Vec2 centre_mm = Vec2::Zero();
  double diameter_mm = 0;
  double top_mm = 0;      ///< where it opens
  double bottom_mm = 0;   ///< lower end of the cylinder
  double tip_mm = 0;      ///< lowest point of the bottom: below bottom_mm where a drill's cone is left
  double volume_mm3 = 0;  ///< volume within the facets, with the bottom's cone
};

/// An upright inner edge: the tool that finishes there has at most this radius.
struct InnerCorner {
  Vec2 at_mm = Vec2::Zero();
  double from_mm = 0, to_mm = 0;  ///< heights
  double radius_mm = 0;           ///< 0: sharp
};

struct Faces {
  std::array<std::vector<AxisPlane>, 3> planes;  ///< x, y, z; ascending
  std::vector<Hole> holes;                       ///< by x, then y, then top
  std::vector<InnerCorner> corners;
  double free_form_mm2 = 0;
  TriangleSolid plugged;  ///< the solid with its holes filled
};

/// A plane is a connected patch of triangles whose normals are within 0.1 degrees of an axis; patches within the
/// tolerance are one plane, at their mean weighted by area. A small patch in the middle of a curved surface (smooth to
/// its neighbours, and not larger than three of them) is none. Triangles that are neither upright nor along an axis are
/// free-form. The bounds of their patches, and in x and y those of other upright walls, come as planes that are no
/// faces; but not the lines at which the rounded inner corner of a pocket goes over into a wall along an axis: that
/// corner is the pocket's.
///
/// A hole is a closed ring of upright facets, ten or more, with the material outside, whose corners lie on one circle.
/// Its diameter is that of the corners. The radius of an inner corner follows from the turn between neighbouring
/// facets, whose corners are on it: r = w / (2 sin(turn / 2)) with the mean w of their widths, of which the wider
/// counts at most as twice the narrower: beside a round corner stands a long wall. Facets of one round wall have one
/// radius, the median.
Faces find_faces(const TriangleSolid& solid, const FaceOptions& options);

/// Only the planes, of a solid that is no part: faces of the blank.
std::array<std::vector<AxisPlane>, 3> find_planes(const TriangleSolid& solid, const FaceOptions& options);

/// Joins planes within the tolerance; a face and a bound are a face.
std::vector<AxisPlane> joined(std::vector<AxisPlane> planes, double tolerance_mm);

/// Without the planes of walls shorter than `narrowest_mm` that are nearer than that to another plane: no mill gets
/// between them. Planes are ascending; longer walls come first, then larger faces.
std::vector<AxisPlane> without_slivers(const std::vector<AxisPlane>& planes, double narrowest_mm);

// Upright round holes of a mesh.

struct FoundHoles {
  std::vector<Hole> holes;
  std::vector<bool> of_hole;     ///< whether each triangle belongs to a hole
  std::vector<Triangle> caps;    ///< what closes the solid where the holes' triangles are taken away
  std::vector<Vec3> new_points;  ///< middles of the caps, numbered after those of the solid
};

/// See find_faces.
FoundHoles find_holes(const TriangleSolid& solid, const MeshEdges& edges, const FaceOptions& options);

/// Normal of a triangle, of length 1; zero where it has no area.
Vec3 unit_normal(const TriangleSolid& solid, std::size_t triangle);
bool is_upright(const Vec3& unit_normal);

}  // namespace camber::plan
