#pragma once
// Rotary axes of a program: words A, B, C, and tool-centre-point control.
#include <cstdint>

#include "base/geometry.h"

namespace camber::nc {

/// Tool-centre-point control: X Y Z are the tip in the part's frame, which a rotary table carries along.
enum class TipControl : std::uint8_t {
  off,        ///< X Y Z belong to the linear axes
  angles,     ///< G43.4, G234, M428: rotary words are positions of the axes
  directions  ///< G43.5: I J K are the tool's direction in the part's frame
};

/// A rotary axis of the machine.
struct RotaryOption {
  char letter = 'A';          ///< A, B or C
  bool shortest_way = false;  ///< absolute words count modulo one turn; the axis turns by at most half a turn
  int clamp_m = 0;            ///< M code that clamps the axis; 0: none
  int unclamp_m = 0;          ///< and the one that releases it
};

/// Where the rotary axes are at the end of a move. Moves without an entry leave them where they are. A table of its
/// own, so that moves of three-axis programs need no memory for it.
struct RotaryTarget {
  Vec3 end = Vec3::Zero();  ///< A, B, C, rad, with their winding; or the tool's direction (unit) in the part's frame
  double time_s = 0;        ///< duration that G93 asks for; 0: not G93
  std::uint32_t move = 0;   ///< index into Interpretation::moves
  std::uint8_t given = 0;   ///< bit i: the block has a word of axis A, B, C
  bool is_direction = false;
};

}  // namespace camber::nc
