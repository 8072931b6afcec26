#pragma once
// Rounds the words of arcs such that the arcs still close.
#include <optional>

#include "base/geometry.h"
#include "nc/arcs.h"

namespace camber::nc {

/// An arc after rounding of its ends in the text.
struct WantedArc {
  Vec3 start_mm, end_mm;  ///< points as the text says them
  Vec3 center_mm;         ///< wished; moved along the line that keeps both radii equal
  double sweep_rad = 0;   ///< sweep of the arc that it replaces: tells a small arc from nearly a full turn
  Plane plane = Plane::xy;
  int turns = 1;           ///< P
  bool full_turn = false;  ///< start and end coincide in the plane
  bool by_radius = false;  ///< R rather than I J K
  bool absolute_centre = false;
};

/// Words in millimetres: the first and the second centre word of the plane, or R alone.
struct RoundedArc {
  double first_mm = 0, second_mm = 0, r_mm = 0;
};

/// The words rounded to `decimals` of a unit of `unit_mm`; nothing when they would not make the arc (radii that differ
/// by more than one unit of the last decimal, or a sweep that jumps by a turn).
std::optional<RoundedArc> round_arc(const WantedArc& arc, double unit_mm, int decimals);

}  // namespace camber::nc
