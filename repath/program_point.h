#pragma once
// Places of a path as the program's text says them.
#include <cmath>

#include "nc/move.h"

namespace camber::repath {

/// A place on a move in the coordinates of the text. Sums of increments (G91) and inches leave noise: points at one
/// place become equal.
inline Vec3 program_point(const nc::Interpretation& moves, const nc::Move& move, const Vec3& place_mm) {
  return moves.frame_of(move).to_program(place_mm).unaryExpr([](double mm) { return std::round(mm * 1e7) * 1e-7; });
}

}  // namespace camber::repath
