#pragma once
// Surroundings of the tool: gives the exact room between the tool and part, fixtures and stock.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "checks/machine_solids.h"
#include "machine/machine_model.h"
#include "machine/tool.h"

namespace camber::posture {

/// The parts of a tool that must stay clear: turned convex pieces in the tool's frame, origin at the tip, z along the
/// axis.
struct ToolShape {
  struct Piece {
    checks::TurnedSolid solid;
    double need_mm = 0;                               ///< least distance to the surroundings
    double radius_mm = 0, bottom_mm = 0, top_mm = 0;  ///< cylinder about the piece
  };
  std::vector<Piece> pieces;
  double pivot_mm = 0;  ///< height above the tip about which the tool is tilted
  double error_mm = 0;  ///< deflection of the tip by an ordinary force; 0: axis errors do not count (choose.h)

  void add(checks::TurnedSolid solid, double need_mm);
};

/// Returns neck, shank, holder and the bodies on the spindle (as cylinders about the axis) with `clearance_mm`, and the
/// flutes above the cutter's rounded end, which only must not cut: they may come within kCutterSlack_mm.
inline constexpr double kCutterSlack_mm = 0.02;
ToolShape tool_shape(const machine::Tool& tool, const machine::Machine& machine, double clearance_mm);

/// Kind of an obstacle: the flutes may cut stock, and must not cut the rest.
enum class Obstacle : std::uint8_t { solid, stock };

/// Triangles in trees of spheres.
class Surroundings {
 public:
  /// Adds an obstacle, in the frame of the program.
  void add(const TriangleMesh& mesh, const Vec3& shift_mm = Vec3::Zero(), Obstacle what = Obstacle::solid);
  void add(std::span<const std::array<Vec3, 3>> triangles, Obstacle what);
  void add_box(const Vec3& min_mm, const Vec3& max_mm, Obstacle what = Obstacle::solid);
  /// Builds the trees. Call it after the last add(), before anything else.
  void finish();

  /// Returns the room of the nearest piece beyond its least distance, at most `cap_mm`; negative: too near, the amount
  /// has no meaning. Never more than the true room, and less by at most the size of a triangle where it is positive;
  /// the sign is exact to 1e-4 mm or a thousandth of the distance. Quickest with a cap of 0.
  double room_mm(const ToolShape& tool, const Vec3& tip_mm, const Vec3& axis, double cap_mm) const;

  struct Inside {
    Vec3 point_mm;
    double from_axis_mm;
  };
  /// Finds the deepest of the corners and middles of triangles inside the cylinder of this radius about the axis, from
  /// `from_mm` above the tip on. Returns false if there is none.
  bool deepest_point(const Vec3& tip_mm, const Vec3& axis, double radius_mm, double from_mm, Inside& out) const;

 private:
  /// Holds triangles: a ball, and a slab across about their normal.
  struct Volume {
    Vec3 centre_mm = Vec3::Zero();
    double radius_mm = 0;
    Vec3 normal = Vec3::UnitZ();
    double low_mm = 0, high_mm = 0;  ///< along the normal
  };
  struct Node : Volume {
    std::uint32_t begin = 0, end = 0;  ///< triangles of a leaf; inner node: end is 0, children at begin and begin + 1
  };
  struct Tree {
    std::vector<std::array<Vec3, 3>> triangles;
    std::vector<Node> nodes;
    std::vector<Volume> volumes;  ///< spheres of the triangles
    bool stock = false;

    void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end);
    double room_mm(const ToolShape& tool, const Vec3& tip_mm, const Vec3& axis, double cap_mm) const;
    void deepest_point(const Vec3& tip_mm, const Vec3& axis, double from_mm, Inside& out) const;
  };
  struct Probe;
  static Volume volume_of(std::span<const std::array<Vec3, 3>> triangles);
  Tree& tree_of(Obstacle what) { return trees_[static_cast<std::size_t>(what)]; }

  std::array<Tree, 2> trees_;  ///< one per Obstacle
};

}  // namespace camber::posture
