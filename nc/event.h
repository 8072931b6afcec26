#pragma once
// Events of a program other than moves: tools, spindle, M, S and T codes, index table, pallet.
#include <cstdint>

namespace camber::nc {

enum class EventKind : std::uint8_t {
  tool_select,                ///< T; value: tool number
  tool_change,                ///< M6; value: tool number
  spindle_speed,              ///< S; value: rpm
  spindle_clockwise,          ///< M3, M13
  spindle_counter_clockwise,  ///< M4, M14
  spindle_stop,               ///< M5
  spindle_orient,             ///< M19
  m_code,                     ///< every other M code but M60
  index,                      ///< B of an index table; value: degrees, as programmed
  pallet                      ///< M60
};

/// Events are in the order of execution. One of the same block as the move `before_move` acts
/// together with it; one whose block has no move, or whose code acts at the block's end (M0 M1 M2 M5 M9 M30 M60),
/// acts alone, before that move. `before_move` is Interpretation::moves.size() behind the last move.
struct Event {
  double value = 0;  ///< value of the word, where the kind does not say otherwise: the code's number (M8: 8)
  std::uint32_t block = 0;
  std::uint32_t before_move = 0;
  EventKind kind = EventKind::m_code;
  bool incremental = false;  ///< index: the value is a step (G91)
};

}  // namespace camber::nc
