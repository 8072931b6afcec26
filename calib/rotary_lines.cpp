#include "calib/rotary_lines.h"

#include "base/units.h"
#include "feedmodel/move_turns.h"
#include "kinematics/feed_meaning.h"

namespace camber::calib {
namespace {

constexpr double kNoLengthMm = 1e-9;

LineFeed line_feed(const nc::Interpretation& program, const machine::Machine& machine, const nc::Move& move,
                   feedmodel::MoveTurns& turns) {
  const Vec3 turn_rad = turns.now().end_rad - turns.now().start_rad;
  const double linear_mm = nc::length_mm(program, move), turn_deg = deg_from_rad(turn_rad.norm());
  LineFeed line;
  line.turn = turns.rest(false);
  line.rotary_alone = linear_mm < kNoLengthMm && turn_deg > 0;
  line.turns = turn_deg > 0;
  line.cutting = move.kind != nc::MoveKind::rapid;
  if (line.cutting)
    line.feed_per_s = kinematics::feed_along_path(program, move, turn_rad, turns.now().g93_time_s, machine.control);
  line.length = line.rotary_alone ? turn_deg : linear_mm;
  for (int i = 0; i < 3; ++i)
    if (turn_rad[i] != 0)
      line.asked_deg_per_s[i] =
          line.cutting ? std::abs(deg_from_rad(turn_rad[i])) / line.length * line.feed_per_s : machine::kNoLimit;
  return line;
}

}  // namespace

std::vector<LineFeed> feeds_of_lines(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<LineFeed> lines;
  feedmodel::MoveTurns turns(program, machine);
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& move = program.moves[i];
    turns.at(i);
    if (move.kind == nc::MoveKind::dwell) continue;
    if (lines.size() <= move.block + 1) lines.resize(move.block + 2);
    lines[move.block + 1] = line_feed(program, machine, move, turns);
  }
  return lines;
}

}  // namespace camber::calib
