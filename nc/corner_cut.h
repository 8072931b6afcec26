#pragma once
// Rounds or chamfers the corner between two moves in a plane.
#include <cstddef>
#include <optional>
#include <string>

#include "nc/arcs.h"
#include "nc/move.h"

namespace camber::nc {

struct CornerCut {
  std::size_t before = 0, after = 0;  ///< in Interpretation::moves: those that meet there, lines or arcs in the plane
  Plane plane = Plane::xy;
  std::string plane_name = "G17";  ///< name for messages
  bool chamfer = false;
  double size_mm = 0;       ///< radius; of a chamfer the distance from the corner
  std::string text;         ///< the words that ask for it, for messages
  bool may_shrink = false;  ///< made smaller where a side is too short
};

struct CornerCutResult {
  std::string error;            ///< not empty: nothing was changed
  std::optional<Move> between;  ///< goes before move `after`; none: the moves run on into each other
  bool shrunk = false;
};

/// Cuts both moves short, in the coordinates of their frame, and makes the line or the arc between them, which the
/// caller inserts.
CornerCutResult cut_corner(Interpretation& program, const CornerCut& corner);

}  // namespace camber::nc
