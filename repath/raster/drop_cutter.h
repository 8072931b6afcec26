#pragma once
// Lowers a ball, flat or bull-nose cutter onto a triangle mesh: the offset surface, exactly.
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "removal/cutter.h"

namespace camber::repath {

// How low a rounded cylinder (ball, flat, bull-nose) can be lowered onto one triangle: closed forms.

/// The underside of a ball, flat or bull-nose cutter: a disc of `flat_mm` with a rounding of `corner_mm` around it, and
/// the wall above.
struct Underside {
  double flat_mm = 0, corner_mm = 0;
  double radius_mm() const { return flat_mm + corner_mm; }
  /// Above the tip, at a distance from the axis of at most radius_mm().
  double height_mm(double from_axis_mm) const;
};
/// Requires a shape that is not general.
Underside underside_of(const removal::CutterShape& shape);

enum class ContactKind { facet, edge, vertex };

/// Where the cutter rests.
struct DropContact {
  double tip_mm = 0;          ///< height of the tip
  Vec3 point = Vec3::Zero();  ///< of the mesh, that it touches
  ContactKind kind = ContactKind::facet;
  std::uint32_t triangle = 0;  ///< that the point belongs to
};

/// Where on a line that passes the axis `distance_mm` away and rises by `slope` (0 or more) the cutter rests: mm from
/// the point beside the axis. Nothing where the line passes outside the cutter.
///
/// Greatest of slope l - height(sqrt(d^2 + l^2)), which is concave in l. Flat: at the rim, l = sqrt(R^2 - d^2); ball:
/// l = slope sqrt(R^2 - d^2) / sqrt(1 + slope^2); bull-nose: the root of slope r cos t = l sin t over the angle t of
/// the rounding, r = flat + corner sin t, to machine accuracy.
std::optional<double> place_on_line(const Underside& cutter, double distance_mm, double slope);

/// By how much a line of any slope at a distance lifts the cutter above where it passes the axis; nothing outside. The
/// other way round: a cutter that moves along a slope leaves a groove whose profile, `distance_mm` beside the path and
/// in the vertical plane across it, is the path's height there minus this.
std::optional<double> rise_on_line(const Underside& cutter, double distance_mm, double slope);

/// A triangle with what the contact needs of it.
struct Facet {
  Facet() = default;
  Facet(const Vec3& a, const Vec3& b, const Vec3& c);
  std::array<Vec3, 3> corner;
  Vec3 normal;  ///< unit, z not negative; zero for a triangle that is a line when seen from above
};

/// The lowest place of the tip above `axis` at which the inside of the cutter meets nothing of the triangle; nothing
/// where the triangle lies beside the cutter. What only touches the wall does not count.
///
/// The greatest of z - height(distance from the axis) over the triangle, a concave function: inside, where the facet's
/// slope is the cutter's; else on an edge, or at its end.
std::optional<DropContact> contact_with(const Underside& cutter, const Facet& facet, const Vec2& axis);

/// The tip's lowest place above a point, over all triangles: exact but for rounding (some 1e-12 mm), nothing is
/// sampled. The triangles stand in a tree of boxes as seen from above, each with a plane that lies over its points; a
/// box that could not lift the cutter any higher is passed over.
class DropCutter {
 public:
  /// Requires a shape that is not general. Memory: about 200 bytes a triangle.
  DropCutter(const TriangleMesh& mesh, const removal::CutterShape& shape);

  /// Nothing where no triangle lies under the cutter. `near`: a triangle to begin with, as that of the place before;
  /// saves time and changes no height (of places that it touches at once it may name another).
  std::optional<DropContact> at(const Vec2& axis, std::optional<std::uint32_t> near = std::nullopt) const;

  const Underside& cutter() const { return cutter_; }
  const Vec3& min_mm() const { return min_; }  ///< of the mesh
  const Vec3& max_mm() const { return max_; }

 private:
  struct Node {
    Vec2 min = Vec2::Zero(), max = Vec2::Zero();
    double top = 0;                    ///< highest point
    Vec2 slope = Vec2::Zero();         ///< of the plane, which rises with the facets
    double plane = 0;                  ///< its height above the origin
    std::uint32_t begin = 0, end = 0;  ///< of a leaf's facets; an inner node's end is 0 and its children are begin and
                                       ///< begin + 1
  };
  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end);
  double upper_bound_mm(const Node& node, const Vec2& axis) const;
  void search(std::uint32_t node, const Vec2& axis, std::optional<DropContact>& best) const;
  void offer(std::uint32_t facet, const Vec2& axis, std::optional<DropContact>& best) const;

  Underside cutter_;
  Vec3 min_ = Vec3::Zero(), max_ = Vec3::Zero();
  std::vector<Facet> facets_;
  std::vector<Node> nodes_;
};

}  // namespace camber::repath
