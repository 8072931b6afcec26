#include "calib/logged_lines.h"

#include <algorithm>

namespace camber::calib {
namespace {

nc::Move rest_before(const nc::Move& move) {
  nc::Move rest = move;
  rest.kind = nc::MoveKind::dwell;
  rest.end_mm = rest.start_mm;
  rest.arc = nc::Move::kNoArc;
  rest.feed_mm_per_s = 0;
  return rest;
}

/// A stretch between the moves that surround it: a control may brake otherwise before a rapid than before a dwell.
void append_stretch(nc::Interpretation& program, const std::vector<nc::Move>& moves, const FeedStretch& s) {
  const auto is_rapid = [&](std::size_t i) { return moves[i].kind == nc::MoveKind::rapid && !moves[i].reference; };
  const bool rapid_before = s.move_first > 0 && is_rapid(s.move_first - 1);
  const bool rapid_after = s.move_end < moves.size() && is_rapid(s.move_end);
  const std::size_t from = s.move_first - (rapid_before ? 1 : 0), to = s.move_end + (rapid_after ? 1 : 0);
  program.moves.push_back(rest_before(moves[from]));
  program.moves.insert(program.moves.end(), moves.begin() + static_cast<std::ptrdiff_t>(from),
                       moves.begin() + static_cast<std::ptrdiff_t>(to));
}

LoggedLines lines_of(const StretchRun& run, int keep_back_every, std::size_t& count) {
  LoggedLines logged{run.program_name, std::make_unique<nc::Interpretation>(), {}};
  nc::Interpretation& program = *logged.program;
  program.arcs = run.program.arcs;
  program.states = run.program.states;
  TimedLines& lines = logged.lines;
  lines.program = &program;
  std::vector<TimedStretch> once = one_for_each_geometry(run.timed, run.program);
  std::ranges::sort(once, {}, [](const TimedStretch& t) { return t.stretch.move_first; });
  for (const TimedStretch& t : once) {
    append_stretch(program, run.program.moves, t.stretch);
    lines.parts.push_back(
        {t.stretch.line_first, t.stretch.line_last, run.program.moves[t.stretch.move_first].feed_mm_per_s});
    lines.time_s.push_back(t.time_s);
    lines.sigma_s.push_back(t.sigma_s);
    lines.kept_back.push_back(++count % static_cast<std::size_t>(keep_back_every) == 0);
    lines.group.push_back(static_cast<int>(count));
  }
  return logged;
}

}  // namespace

std::vector<LoggedLines> logged_lines(const std::vector<StretchRun>& runs, int keep_back_every, std::size_t& count) {
  std::vector<LoggedLines> all;
  for (const StretchRun& run : runs)
    if (!run.timed.empty()) all.push_back(lines_of(run, keep_back_every, count));
  return all;
}

}  // namespace camber::calib
