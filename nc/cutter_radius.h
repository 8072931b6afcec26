#pragma once
// Cutter radius compensation (G41, G42): from the programmed contour to the path of the cutter's centre.
#include <cstdint>
#include <string>
#include <vector>

#include "nc/arcs.h"
#include "nc/move.h"

namespace camber::nc {

struct CutterRadius {
  double radius_mm = 0;  ///< negative: the other side
  bool left = true;      ///< G41, seen along the path against the plane's normal
  Plane plane = Plane::xy;
  /// Outside corners: false: an arc about the corner (LinuxCNC); true: the offset lines are drawn out until they meet,
  /// where the path turns by more than 90 degrees by one radius each with a line between them (Fanuc).
  bool corner_lines = false;
  /// The entry move ends: false: as every other corner, beside its own end (LinuxCNC); true: square to the start of
  /// the next move (Fanuc, type A).
  bool entry_square_to_next = false;
  int moves_without_plane_motion = 1;  ///< maximum number between two moves in the plane: the lookahead of the control
  std::string name = "G41";            ///< for messages
};

struct CutterRadiusProblem {
  std::uint32_t block = 0;
  std::string message;
};

struct CutterRadiusResult {
  Vec3 end_mm = Vec3::Zero();                 ///< centre of the cutter at the end
  std::vector<CutterRadiusProblem> problems;  ///< not empty: the moves are as they were
};

/// Rewrites the moves from `first` to the end as the path of the cutter's centre and marks them as not editable: the
/// text has other coordinates. The first move in the plane is the entry: from where the tool stands to beside its
/// programmed end. Inside corners are cut short where the offset lines or arcs meet; the move that follows the last one
/// (after G40) starts from `end_mm`. Reported as problems: an entry on an arc or not longer than the radius, inside
/// corners and arcs too small for the radius, a spiral, more moves without motion in the plane than the control looks
/// ahead. Only neighbouring moves are examined: a slot narrower than the cutter with several moves at its bottom is not
/// detected.
CutterRadiusResult compensate_radius(Interpretation& program, std::size_t first, const CutterRadius& cutter);

}  // namespace camber::nc
