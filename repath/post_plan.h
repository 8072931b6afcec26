#pragma once
// Which of the solutions of the machine a program under tool-centre-point control runs with, from its start to its end.
//
// A choice is kept as long as travel allows: a stretch of motion is followed without a jump in every choice. Choices
// differ by whole turns of the rotary axes and, on chains whose tool comes to lie along the first rotary axis, by the
// other branch, which leads from the other side to that pole (rotary_choice.h). Both give the tool the same direction
// everywhere along the stretch. Where no choice lasts, a shortest path through (stretch, choice) decides where the axes
// turn back: in air rather than in a cut.
#include <cstdint>
#include <span>
#include <vector>

#include "machine/machine.h"
#include "repath/rotary_choice.h"
#include "repath/tip_motion.h"

namespace camber::repath {

/// A part of a motion that is run with one choice.
struct PlannedStretch {
  std::size_t motion = 0;
  double from = 0, to = 1;
  RotaryChoice choice;
  RotaryChoice before;  ///< of the stretch before; another one: the axes turn back before this stretch
  bool turns_back = false;
  bool in_air = true;  ///< where the axes turn back: next to a rapid
};

/// What a move that is not rewritten asks of the choice about it.
enum class Barrier : std::uint8_t {
  none,
  pose,       ///< linear axes move as programmed: whole turns alone may differ
  programmed  ///< rotary axes are programmed: the choice should be that of the program
};

/// `before[i]`: what stands between motion i - 1 and motion i; one more than motions.
std::vector<PlannedStretch> plan_choices(std::span<const TipMotion> motions, std::span<const Barrier> before,
                                         const MotionFrame& frame, const machine::Machine& machine);

}  // namespace camber::repath
