#include "feedmodel/summary.h"

namespace camber::feedmodel {
namespace {

std::size_t count_blocks(const nc::Interpretation& program) {
  std::size_t blocks = 0, next_turn = 0;
  std::uint32_t last = nc::Move::kNoArc;
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& move = program.moves[i];
    while (next_turn < program.rotary.size() && program.rotary[next_turn].move < i) ++next_turn;
    const bool turns = next_turn < program.rotary.size() && program.rotary[next_turn].move == i;
    if (move.kind == nc::MoveKind::dwell || move.block == last || (!turns && length_mm(program, move) == 0)) continue;
    ++blocks;
    last = move.block;
  }
  return blocks;
}

}  // namespace

FeedSum::FeedSum(const nc::Interpretation& program) { summary_.blocks = count_blocks(program); }

void FeedSum::add(const SegmentTime& time) {
  if (time.cutting) summary_.cutting_time_s += time.end_s() - summary_.time_s;
  summary_.time_s = time.end_s();
}

}  // namespace camber::feedmodel
