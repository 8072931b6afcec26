#include "nc/durations.h"

#include <fmt/format.h>

namespace camber::nc {
namespace {

bool cuts(const Move& move) { return move.kind == MoveKind::linear || move.kind == MoveKind::arc; }

std::string too_long(const Interpretation& program, const Move& move, double time_s) {
  constexpr double kDay_h = kMaxMove_s / 3600;
  if (!cuts(move)) return fmt::format("a dwell of {:g} s; a day ({:g} s) at most was expected", time_s, kMaxMove_s);
  return fmt::format("{:g} mm at {:g} mm/min take {:.3g} h; a feed that needs a day ({:g} h) at most was expected",
                     length_mm(program, move), move.feed_mm_per_s * 60, time_s / 3600, kDay_h);
}

}  // namespace

double programmed_time_s(const Interpretation& program, const Move& move) {
  if (move.kind == MoveKind::dwell) return move.dwell_s;
  if (!cuts(move) || move.feed_mm_per_s <= 0) return 0;
  return length_mm(program, move) / move.feed_mm_per_s;
}

double programmed_time_s(const Interpretation& program) {
  double sum = 0;
  for (const Move& move : program.moves) sum += programmed_time_s(program, move);
  return sum;
}

void check_durations(const Program& text, const Interpretation& program, Reporter& report) {
  for (const Move& move : program.moves) {
    const double time_s = programmed_time_s(program, move);
    if (time_s <= kMaxMove_s) continue;
    report.error(text.blocks[move.block].offset, "block-time", too_long(program, move, time_s), "block-time");
    if (report.full()) return;
  }
}

}  // namespace camber::nc
