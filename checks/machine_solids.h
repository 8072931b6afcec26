#pragma once
// Tools and bodies of the machine as convex pieces, and their distances.
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "base/convex_distance.h"
#include "checks/tool_outline.h"
#include "machine/machine_model.h"
#include "machine/tool.h"

namespace camber::checks {

/// A turned solid: the convex hull of circles about the z axis.
class TurnedSolid : public ConvexSolid {
 public:
  explicit TurnedSolid(OutlineRing::Part part) : part_(part) {}
  void add(double radius_mm, double height_mm) { circles_.push_back({radius_mm, height_mm}); }
  Vec3 support(const Vec3& direction) const override;
  OutlineRing::Part part() const { return part_; }
  double radius_mm() const;
  double bottom_mm() const { return circles_.front().height_mm; }
  double top_mm() const { return circles_.back().height_mm; }

  struct Circle {
    double radius_mm, height_mm;
  };
  const std::vector<Circle>& circles() const { return circles_; }

 private:
  OutlineRing::Part part_;
  std::vector<Circle> circles_;  ///< upwards
};

/// Cutter, shank and holder in the tool's frame (origin at the tip, z along the axis), smaller by kContact_mm all
/// round: less than that is no collision.
inline constexpr double kContact_mm = 0.01;
std::vector<TurnedSolid> solids_of(const machine::Tool& tool);

/// A body as hulls of a few points each, in a tree of spheres. Machine frame with all axes at 0.
class BodySolid {
 public:
  /// Throws InputError as read_stl does.
  explicit BodySolid(const machine::Body& body);

  struct Sphere {
    Vec3 centre_mm = Vec3::Zero();
    double radius_mm = 0;
  };
  /// The children of an inner node are `first` and `first + 1`; a leaf has `count` hulls from `first` on.
  struct Node {
    Sphere sphere;
    std::size_t first = 0, count = 0;
    bool leaf() const { return count > 0; }
  };
  const std::vector<Node>& nodes() const { return nodes_; }
  std::span<const Vec3> hull(std::size_t i) const { return std::span(points_).subspan(i * hull_size_, hull_size_); }
  const Vec3& min_mm() const { return min_mm_; }
  const Vec3& max_mm() const { return max_mm_; }
  /// Inside a mesh with a closed surface, by the solid angle of its triangles.
  bool mesh_holds(const Vec3& point) const;

 private:
  void split(std::size_t node, std::size_t first, std::size_t count, std::vector<std::size_t>& order);

  std::size_t hull_size_ = 3;
  std::vector<Vec3> points_;
  std::vector<Node> nodes_;
  Vec3 min_mm_, max_mm_;
};

struct SolidDistance {
  double at_least_mm = 0;  ///< 0: they overlap; else a lower bound, three quarters of the distance or more
  std::size_t piece = 0;   ///< of the tool, nearest
};

SolidDistance distance(const std::vector<TurnedSolid>& tool, const Eigen::Isometry3d& body_from_tool,
                       const BodySolid& body);
double distance_mm(const BodySolid& a, const Eigen::Isometry3d& a_from_b, const BodySolid& b);

}  // namespace camber::checks
