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
/// A piece has the moves of its run around it instead. Returns where it is in the program.
std::pair<std::size_t, std::size_t> append_stretch(nc::Interpretation& program, const nc::Interpretation& whole,
                                                   const TimedStretch& timed) {
  const FeedStretch& s = timed.stretch;
  const std::vector<nc::Move>& moves = whole.moves;
  const auto is_rapid = [&](std::size_t i) { return moves[i].kind == nc::MoveKind::rapid && !moves[i].reference; };
  const StretchContext context = context_of(s, whole);
  const bool rapid_before = context.first > 0 && context.first == s.run_first && is_rapid(context.first - 1);
  const bool rapid_after = context.end < moves.size() && context.end == s.run_end && is_rapid(context.end);
  const std::size_t from = context.first - (rapid_before ? 1 : 0), to = context.end + (rapid_after ? 1 : 0);
  program.moves.push_back(rest_before(moves[from]));
  const std::size_t shift = program.moves.size() - from;
  const auto cut = moves_at_override(whole, from, to, timed.feed_factor);
  program.moves.insert(program.moves.end(), cut.begin(), cut.end());
  return {s.move_first + shift, s.move_end + shift};
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
    lines.moves.push_back(append_stretch(program, run.program, t));
    lines.ends_in_motion.push_back(t.stretch.ends_in_motion());
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
