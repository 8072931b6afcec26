#pragma once
// Points along a finishing program: where the cutter touches the part, and where the tip is for a direction of the
// tool.
#include <cstdint>
#include <span>
#include <vector>

#include "base/triangle_mesh.h"
#include "machine/tool.h"
#include "nc/move.h"

namespace camber::posture {

struct PathPoint {
  std::uint32_t move = 0;         ///< index into Interpretation::moves
  double to = 1;                  ///< share of the move at its end
  Vec3 centre_mm = Vec3::Zero();  ///< centre of the rounding that touches: of the ball, or of the section of the torus
  Vec3 normal = Vec3::UnitZ();    ///< unit normal of the part there
  double corner_mm = 0, flat_mm = 0;  ///< rounding, and distance of its centre from the axis
  bool contact = false;
  bool rapid = false;
  double way_mm = 0;  ///< way from the point before
  double time_s = 0;  ///< time at the programmed feed; 0: a rapid

  /// Returns the tip, for this direction of the tool, with which the contact stays.
  Vec3 tip_mm(const Vec3& axis) const;
};

/// Returns points of the moves [first, end), `step_mm` apart, in rapids five times as far. A cutter that is less than
/// kContactMm above the part touches it. Requires a ball or a bull-nose cutter; the mesh in the frame of the moves.
inline constexpr double kContactMm = 0.3;
std::vector<PathPoint> path_points(const nc::Interpretation& moves, std::size_t first, std::size_t end,
                                   const machine::Tool& tool, const TriangleMesh& part, double step_mm);

}  // namespace camber::posture
