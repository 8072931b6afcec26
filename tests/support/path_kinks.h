#pragma once
// How much a tool path kinks from move to move, measured on the moves themselves: nothing of repath/ is used.
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "nc/move.h"

namespace camber::tests {

struct PathKink {
  Vec3 at_mm = Vec3::Zero();
  bool arc_before = false, arc_behind = false;
  double rad = 0;
};

/// Between cutting moves that follow each other. Directions are differences over a millionth of a move.
inline std::vector<PathKink> kinks_between_moves(const nc::Interpretation& program) {
  constexpr double kFraction = 1e-6;
  const auto cuts = [](const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; };
  std::vector<PathKink> out;
  for (std::size_t k = 0; k + 1 < program.moves.size(); ++k) {
    const nc::Move &before = program.moves[k], &behind = program.moves[k + 1];
    if (!cuts(before) || !cuts(behind)) continue;
    const Vec3 in = before.end_mm - nc::point_at(program, before, 1 - kFraction);
    const Vec3 forth = nc::point_at(program, behind, kFraction) - behind.start_mm;
    out.push_back({before.end_mm, before.kind == nc::MoveKind::arc, behind.kind == nc::MoveKind::arc,
                   std::atan2(in.cross(forth).norm(), in.dot(forth))});
  }
  return out;
}

}  // namespace camber::tests
