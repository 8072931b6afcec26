#pragma once
// Rotary axes of a program: words A, B, C, tool-centre-point control, tilted frames.
#include <cstdint>

#include "base/geometry.h"

namespace camber::nc {

/// Tool-centre-point control: X Y Z are the tip in the part's frame, which a rotary table carries along.
enum class TipControl : std::uint8_t {
  off,        ///< X Y Z belong to the linear axes
  angles,     ///< G43.4, G234, M428: rotary words are positions of the axes
  directions  ///< G43.5: I J K are the tool's direction in the part's frame
};

/// Reference of X Y Z without tool-centre-point control.
enum class WorkFrame : std::uint8_t {
  machine,  ///< the linear axes: the frame does not follow the rotary axes
  tilted,   ///< G68.2: a frame fixed to the part, with the tool along its Z (G53.1)
  dynamic   ///< G254: parallel to the machine; its origin turns with the table
};

/// A rotary axis of the machine.
struct RotaryOption {
  char letter = 'A';          ///< A, B or C
  bool on_table = true;       ///< it carries the part, not the spindle
  bool shortest_way = false;  ///< absolute words count modulo one turn; the axis turns by at most half a turn
  int clamp_m = 0;            ///< M code that clamps the axis; 0: none
  int unclamp_m = 0;          ///< and the one that releases it
};

/// Positions of the rotary axes at the end of a move. Moves without an entry leave them where they are. A table of its
/// own, so that moves of three-axis programs need no memory for it.
struct RotaryTarget {
  Vec3 end = Vec3::Zero();    ///< A, B, C, rad, with their winding; or the tool's direction (unit) in the part's frame
  double time_s = 0;          ///< duration that G93 asks for; 0: not G93
  std::uint32_t move = 0;     ///< index into Interpretation::moves
  std::uint8_t given = 0;     ///< bit i: the block has a word of axis A, B, C
  std::uint8_t shortest = 0;  ///< bit i: the axis turns to the nearest winding of `end`, from wherever it is
  bool is_direction = false;
};

/// Linear axes that a move takes to machine coordinates (G53, G28, G30); the others stay. Only for machines with rotary
/// axes.
struct MachineTarget {
  Vec3 end_mm = Vec3::Zero();  ///< NaN: a reference point that is not known
  std::uint32_t move = 0;      ///< index into Interpretation::moves
  std::uint8_t given = 0;      ///< bit i: axis X, Y, Z
};

}  // namespace camber::nc
