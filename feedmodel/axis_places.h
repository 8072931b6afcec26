#pragma once
// Where the axes are while a program goes to the reference point, whose place in the work frame it does not tell.
#include <array>
#include <cmath>

#include "base/geometry.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Follows the moves in order. While a program has not placed every axis (reference moves) an axis stands at the tool
/// change position until it is taken to another coordinate, and again after G28, G30 or G53 (which take it to 0).
class AxisPlaces {
 public:
  explicit AxisPlaces(const machine::ToolChange& change) : home_{change.x_mm, change.y_mm, change.z_mm} {}

  /// The way that the axes go in this move: axes that stand at, or go to, a place that is not known count for nothing.
  struct Way {
    Vec3 from_mm, to_mm;
    bool complete = true;
  };
  Way pass(const nc::Move& move) {
    Way way{move.start_mm, move.end_mm, true};
    at_mm_ = move.end_mm;
    if (!move.reference) {
      at_home_.fill(false);
      return way;
    }
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const bool stays = move.start_mm[i] == move.end_mm[i];
      const bool was_home = at_home_[axis];
      if (!stays) at_home_[axis] = move.end_mm[i] == 0.0;
      if (!was_home && !at_home_[axis]) continue;
      const bool known = std::isfinite(home_[i]);
      if (was_home) way.from_mm[i] = known ? home_[i] : way.to_mm[i];
      if (at_home_[axis]) way.to_mm[i] = known ? home_[i] : way.from_mm[i];
      way.complete = way.complete && (known || stays);
    }
    at_mm_ = way.to_mm;
    return way;
  }

  /// From where the axes stand to the tool change position.
  Vec3 way_to_change() const {
    Vec3 way = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      if (std::isfinite(home_[i]) && !at_home_[static_cast<std::size_t>(i)]) way[i] = home_[i] - at_mm_[i];
    return way;
  }

 private:
  Vec3 home_;
  std::array<bool, 3> at_home_{true, true, true};
  Vec3 at_mm_ = Vec3::Zero();
};

}  // namespace camber::feedmodel
