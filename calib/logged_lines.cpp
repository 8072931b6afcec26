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
    const auto& moves = run.program.moves;
    program.moves.push_back(rest_before(moves[t.stretch.move_first]));
    program.moves.insert(program.moves.end(), moves.begin() + static_cast<std::ptrdiff_t>(t.stretch.move_first),
                         moves.begin() + static_cast<std::ptrdiff_t>(t.stretch.move_end));
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
