#pragma once
// Tracks where the axes are while a program moves to reference points, whose place in the work frame may be unknown.
#include <array>
#include <cmath>

#include "base/geometry.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// For programs with rotary motion: kinematics::place_moves has given this move a start and an end, also where they are
/// not known (Move::reference). As it was read, a move with unknown ends has open ones.
inline bool has_placed_ends(const nc::Move& move) { return move.open_axes == 0 && !move.start_open; }

/// Follows the moves in order. While a program has not placed every axis (reference moves) an axis stands at the tool
/// change position until it is taken to another coordinate, and again after G28, G30 or G53 (which take it to 0).
class AxisPlaces {
 public:
  /// rotary_motion: has_rotary_motion (joint_map.h); its moves may be placed.
  explicit AxisPlaces(const machine::Machine& machine, bool rotary_motion = false) : rotary_motion_(rotary_motion) {
    const machine::ToolChange& change = machine.tool_change;
    home_.fill(Vec3(change.x_mm, change.y_mm, change.z_mm));
    for (std::size_t k = 0; k < machine.reference_points.size(); ++k) {
      const machine::ReferencePoint& point = machine.reference_points[k];
      const Vec3 given(point.x_mm, point.y_mm, point.z_mm);
      for (int i = 0; i < 3; ++i)
        if (std::isfinite(given[i])) home_[k + 1][i] = given[i];
    }
  }

  /// Axis displacements of this move; axes at, or moving to, an unknown position are ignored.
  struct Way {
    Vec3 from_mm, to_mm;
    bool complete = true;
  };
  Way pass(const nc::Move& move) {
    Way way{move.start_mm, move.end_mm, true};
    at_mm_ = move.end_mm;
    if (rotary_motion_ && has_placed_ends(move)) {
      at_home_.fill(false);
      way.complete = !move.reference;
      return way;
    }
    if (!move.reference) {
      at_home_.fill(false);
      return way;
    }
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const bool stays = move.start_mm[i] == move.end_mm[i];
      const bool was_home = at_home_[axis];
      const double old_home = home_[point_[axis]][i];
      const bool goes = (move.reference_axes >> i & 1) != 0;
      if (!stays || goes) {
        at_home_[axis] = move.end_mm[i] == 0.0;
        point_[axis] = move.reference_point;
      }
      if (!was_home && !at_home_[axis]) continue;
      const double home = home_[point_[axis]][i];
      const bool known = std::isfinite(was_home ? old_home : home) && std::isfinite(home);
      if (was_home) way.from_mm[i] = known ? old_home : way.to_mm[i];
      if (at_home_[axis]) way.to_mm[i] = known ? home : way.from_mm[i];
      way.complete = way.complete && (known || stays);
    }
    at_mm_ = way.to_mm;
    return way;
  }

  /// Move from the present place of the axes to the tool change position.
  Vec3 way_to_change() const {
    Vec3 way = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      if (std::isfinite(home_[0][i]) && !at_home_[static_cast<std::size_t>(i)]) way[i] = home_[0][i] - at_mm_[i];
    return way;
  }

 private:
  std::array<Vec3, 4> home_;             ///< tool change position and first reference point, then the other points
  std::array<std::uint8_t, 3> point_{};  ///< reference point at which an axis stands, where it is at one
  std::array<bool, 3> at_home_{true, true, true};
  bool rotary_motion_;
  Vec3 at_mm_ = Vec3::Zero();
};

}  // namespace camber::feedmodel
