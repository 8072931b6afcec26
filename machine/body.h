#pragma once
// Solids of a machine ([[body]] of machine.toml): table, fixture, spindle nose, for the search for collisions.
#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "base/geometry.h"

namespace camber::machine {

/// A box or a mesh as it stands with all axes at 0, in the machine frame.
struct Body {
  std::string name;
  std::string on;        ///< what carries it: "part", an axis, "bed" or "spindle"
  std::size_t axes = 0;  ///< between the part and it; without [kinematics] x, y and z are between part and spindle
  std::optional<std::array<Vec3, 2>> box_mm{};  ///< least and greatest corner
  std::string mesh{};                           ///< STL file, absolute; empty: a box
};

}  // namespace camber::machine
