#include "removal/hole_moves.h"

#include <cmath>

#include "removal/stamp_path.h"

namespace camber::removal {
namespace {

constexpr double kSame_mm = 1e-6;  // rounding of a turned frame

bool same_place(const Vec3& a, const Vec3& b) { return (a - b).head<2>().norm() <= kSame_mm; }

/// Down (-1) or up (1) along the tool's axis; 0: not along it.
int straight(const nc::Move& m) {
  if (!same_place(m.start_mm, m.end_mm) || m.start_mm.z() == m.end_mm.z()) return 0;
  return m.end_mm.z() < m.start_mm.z() ? -1 : 1;
}

bool taps(const nc::Move& m) { return m.cycle == 74 || m.cycle == 84; }

}  // namespace

std::vector<HoleMove> hole_moves(const nc::Interpretation& program, const machine::Operations& operations,
                                 const std::map<int, machine::Tool>& tools) {
  std::vector<HoleMove> out(program.moves.size(), HoleMove::none);
  const nc::Move* hole = nullptr;  // the last move down
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& m = program.moves[i];
    if (m.kind != nc::MoveKind::linear || m.reference || !in_operations(program, m, operations)) continue;
    const int way = straight(m);
    if (m.cycle == 0) {
      const auto tool = tools.find(program.state_of(m).tool);
      if (way == 0 || tool == tools.end() || tool->second.type != machine::ToolType::drill) continue;
      out[i] = way < 0 ? HoleMove::drilled : HoleMove::way_out;
    } else if (way < 0) {
      out[i] = taps(m) ? HoleMove::tapped : HoleMove::drilled;
    } else if (way > 0 && hole && hole->block == m.block && same_place(hole->end_mm, m.start_mm)) {
      out[i] = HoleMove::way_out;
    } else {
      out[i] = HoleMove::not_carved;
    }
    if (makes_hole(out[i])) hole = &m;
  }
  return out;
}

HoleCount count_holes(const nc::Interpretation& program, const std::vector<HoleMove>& holes) {
  HoleCount count;
  const nc::Move* last = nullptr;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    if (!makes_hole(holes[i])) continue;
    const nc::Move& m = program.moves[i];
    const bool deeper = last && same_place(last->end_mm, m.start_mm) &&
                        program.state_of(*last).tool == program.state_of(m).tool &&
                        (m.cycle == 0 || last->block == m.block);
    if (!deeper) ++(holes[i] == HoleMove::tapped ? count.tapped : count.drilled);
    last = &m;
  }
  return count;
}

}  // namespace camber::removal
