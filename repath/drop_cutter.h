#pragma once
// Lowers a ball, flat or bull-nose cutter onto a triangle mesh: the offset surface, exactly.
#include <cstdint>
#include <optional>
#include <vector>

#include "base/triangle_mesh.h"
#include "repath/contact.h"

namespace camber::repath {

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
