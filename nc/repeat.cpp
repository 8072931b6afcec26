#include "nc/repeat.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/units.h"
#include "nc/emit.h"
#include "nc/emit/number_style.h"

namespace camber::nc {
namespace {

constexpr double kSame_mm = 1e-6;
constexpr int kMinDecimals = 3;  // millimetres; inches one more

bool cuts(const Move& m) { return m.kind == MoveKind::linear || m.kind == MoveKind::arc; }
bool goes_rapidly(const Move& m) { return m.kind == MoveKind::rapid && !m.reference && !m.canned; }

bool has_other_codes(const Program& program, const CutRun& run) {
  for (std::uint32_t b = run.first_block; b <= run.last_block; ++b)
    for (const Word& w : program.words_of(b))
      if (w.letter == 'M' || w.letter == 'S' || w.letter == 'T' || w.letter == 'H') return true;
  return false;
}

/// The moves are those of the blocks, in the order of the text.
bool stands_in_text(const Program& program, const Interpretation& moves, const CutRun& run) {
  std::uint32_t block = run.first_block;
  for (std::uint32_t m = run.first_move; m <= run.last_move; ++m) {
    const Move& move = moves.moves[m];
    if ((cuts(move) && !move.editable) || move.canned || move.block < block) return false;
    block = move.block;
  }
  for (std::uint32_t b = run.first_block; b <= run.last_block; ++b)
    if (program.blocks[b].flow || program.blocks[b].skip != 0) return false;
  return true;
}

bool any_state(const Interpretation& moves, const CutRun& run, auto predicate) {
  for (std::uint32_t m = run.first_move; m <= run.last_move; ++m)
    if (predicate(moves.state_of(moves.moves[m]))) return true;
  return false;
}

double highest_of(const Interpretation& moves, const CutRun& run) {
  double z = moves.moves[run.first_move].start_mm.z();
  for (std::uint32_t m = run.first_move; m <= run.last_move; ++m)
    for (const double u : {0.25, 0.5, 0.75, 1.0}) z = std::max(z, point_at(moves, moves.moves[m], u).z());
  return z;
}

/// Finds the way from the highest end of the rapids before the run, the last one at that height, and on by their ends;
/// nothing where none of them lies above the run.
void find_way_back(const Interpretation& moves, CutRun& run) {
  const auto& all = moves.moves;
  const bool per_minute = moves.state_of(all[run.last_move]).feed_mode == FeedMode::per_minute;
  run.closed = per_minute && (all[run.last_move].end_mm - all[run.first_move].start_mm).norm() < kSame_mm;
  if (run.closed) return;
  std::uint32_t from = run.first_move;
  while (from > 0 && goes_rapidly(all[from - 1]) && all[from - 1].state == all[run.first_move - 1].state) --from;
  std::vector<Vec3> points;
  for (std::uint32_t m = from; m < run.first_move; ++m) points.push_back(all[m].end_mm);
  // The first rapid goes up and across or down: where it starts counts where the program goes straight down from there.
  const Move& first = all[from];
  if ((first.end_mm - first.start_mm).head<2>().norm() < kSame_mm && first.start_mm.z() > first.end_mm.z())
    points.insert(points.begin(), first.start_mm);
  const auto top = std::max_element(points.rbegin(), points.rend(),
                                    [](const Vec3& a, const Vec3& b) { return a.z() < b.z() - kSame_mm; });
  double height = top->z();
  if (run.last_move + 1 < all.size() && goes_rapidly(all[run.last_move + 1]))
    height = std::max(height, all[run.last_move + 1].end_mm.z());
  if (height <= highest_of(moves, run) + kSame_mm) {
    run.why_not = RunGap::no_height;
    return;
  }
  Vec3 at = all[run.last_move].end_mm;
  const auto go = [&](const Vec3& to) {
    const double length = (to - at).norm();
    if (length < kSame_mm) return;
    run.way_back.push_back(to);
    run.way_back_mm += length;
    at = to;
  };
  go({at.x(), at.y(), height});
  go({top->x(), top->y(), height});
  auto down = top.base();  // behind it; a rapid that goes on straight down may begin higher
  if (down != points.end() && (*down - *top).head<2>().norm() > kSame_mm) go(*top);
  for (; down != points.end(); ++down) go(*down);
}

RunGap gap_of(const Program& program, const Interpretation& moves, const CutRun& run) {
  const auto& all = moves.moves;
  if (any_state(moves, run, [](const ModalState& s) { return s.cutter_radius; })) return RunGap::cutter_radius;
  if (!stands_in_text(program, moves, run)) return RunGap::not_in_text;
  if (any_state(moves, run, [](const ModalState& s) { return s.incremental; })) return RunGap::incremental;
  if (has_other_codes(program, run)) return RunGap::other_codes;
  if (run.first_move == 0 || !goes_rapidly(all[run.first_move - 1]) || all[run.first_move - 1].block >= run.first_block)
    return RunGap::no_rapid_before;
  const bool last = run.last_move + 1 == all.size();
  if (!last && (all[run.last_move + 1].kind != MoveKind::rapid || all[run.last_move + 1].canned))
    return RunGap::no_rapid_behind;
  return RunGap::none;
}

/// The lines from the end of a run to its start, in the program's own coordinates and style.
class WayBackWriter {
 public:
  WayBackWriter(const Program& program, const Interpretation& moves, const CutRun& run)
      : program_(program), moves_(moves), run_(run), style_(style_of(program)) {}

  std::vector<std::string> lines() const {
    const Move &first = moves_.moves[run_.first_move], &last = moves_.moves[run_.last_move];
    std::vector<std::string> out;
    if (run_.closed) out.push_back(to_start());
    Vec3 at = in_program(last.end_mm);  // the earlier cut ends a little beside: the second line names all axes
    for (const Vec3& point : run_.way_back) {
      const Vec3 to = in_program(point);
      std::string line = "G0";
      for (int axis = 0; axis < 3; ++axis)
        if (std::abs(to[axis] - at[axis]) > kSame_mm || out.size() == 1) line += word("XYZ"[axis], to[axis]);
      out.push_back(line);
      at = to;
    }
    const int plane = moves_.state_of(first).plane_g;
    if (plane != moves_.state_of(last).plane_g && !out.empty())
      out.front().insert(0, "G" + std::to_string(plane) + gap());
    if (const double feed = feed_to_restore(); feed > 0 && !out.empty()) out.back() += feed_word(feed);
    return out;
  }

 private:
  /// The earlier cut ends a little beside.
  std::string to_start() const {
    const Vec3 to = in_program(moves_.moves[run_.first_move].start_mm);
    return "G1" + word('X', to.x()) + word('Y', to.y()) + word('Z', to.z());
  }
  Vec3 in_program(const Vec3& p) const { return moves_.frame_of(moves_.moves[run_.first_move]).to_program(p); }
  bool inch() const { return moves_.state_of(moves_.moves[run_.first_move]).inch; }
  std::string gap() const { return style_.blanks ? " " : ""; }
  std::string word(char letter, double mm) const {
    const int least = kMinDecimals + (inch() ? 1 : 0);
    const int decimals = std::max(least, coordinate_decimals_of(program_));
    return gap() + letter + format_number(inch() ? mm / kMmPerInch : mm, decimals, style_);
  }
  /// Returns the modal feed to restore, where the run's first cutting move relies on it and another feed is modal
  /// behind the run; else 0.
  double feed_to_restore() const {
    const auto& all = moves_.moves;
    if (moves_.state_of(all[run_.first_move]).feed_mode != FeedMode::per_minute) return 0;
    std::uint32_t first = run_.first_move, last = run_.last_move;
    while (first < last && !cuts(all[first])) ++first;
    while (last > first && !cuts(all[last])) --last;
    for (std::uint32_t b = run_.first_block; b <= all[first].block; ++b)
      for (const Word& w : program_.words_of(b))
        if (w.letter == 'F') return 0;
    return all[first].feed_mm_per_s == all[last].feed_mm_per_s ? 0 : all[first].feed_mm_per_s;
  }
  std::string feed_word(double feed_mm_per_s) const {
    const double per_minute = mm_per_min_from_mm_per_s(feed_mm_per_s) / (inch() ? kMmPerInch : 1);
    return gap() + 'F' + format_number(per_minute, std::max(3, feed_decimals_of(program_)), feed_style_of(program_));
  }

  const Program& program_;
  const Interpretation& moves_;
  const CutRun& run_;
  NumberStyle style_;
};

/// The line without its block number.
std::string without_number(std::string line) {
  std::size_t at = line.find_first_not_of(" \t");
  if (at == std::string::npos || (line[at] != 'N' && line[at] != 'n')) return line;
  std::size_t end = at + 1;
  while (end < line.size() && (std::isdigit(static_cast<unsigned char>(line[end])) || line[end] == ' ')) ++end;
  return line.erase(at, end - at);
}

}  // namespace

std::string to_string(RunGap why) {
  constexpr std::array<const char*, 10> kTexts{
      // in the order of the enum
      "can be repeated",
      "are made by a loop, an expression, a subprogram or a drilling cycle, or may be skipped",
      "run under cutter radius compensation (G41, G42)",
      "are incremental (G91)",
      "have M, S, T or H words among them",
      "do not begin behind a rapid",
      "do not end before a rapid",
      "have no rapid above them beside them",
      "hold moves that are not compensated",
      "leave a modal state behind in which they would be other moves"};
  static_assert(kTexts.size() == static_cast<std::size_t>(RunGap::modal) + 1);
  return kTexts[static_cast<std::size_t>(why)];
}

std::vector<CutRun> cut_runs(const Program& program, const Interpretation& moves, const std::vector<bool>& wanted) {
  std::vector<CutRun> out;
  const auto& all = moves.moves;
  for (std::uint32_t m = 0; m < all.size();) {
    if (!cuts(all[m]) || all[m].canned) {
      ++m;
      continue;
    }
    std::uint32_t end = m;
    while (end < all.size() && all[end].kind != MoveKind::rapid && !all[end].canned) ++end;
    CutRun run{.first_move = m, .last_move = end - 1};
    while (!cuts(all[run.last_move])) --run.last_move;
    run.first_block = all[m].block;
    run.last_block = all[run.last_move].block;
    bool some = false, every = true;
    for (std::uint32_t i = m; i <= run.last_move; ++i) {
      some = some || wanted[i];
      every = every && (wanted[i] || !cuts(all[i]) || length_mm(moves, all[i]) <= 0);
    }
    if (some) {
      run.why_not = gap_of(program, moves, run);
      if (run.why_not == RunGap::none && !every) run.why_not = RunGap::others;
      if (run.why_not == RunGap::none) find_way_back(moves, run);
      out.push_back(std::move(run));
    }
    m = end;
  }
  return out;
}

RepeatedText repeat_runs(const Program& program, const Interpretation& moves, std::span<const EarlierCut> cuts) {
  RepeatedText out;
  std::vector<BlockReplacement> replacements;
  std::uint32_t block = 0;
  const auto copy_to = [&](std::uint32_t end) {
    for (; block < end; ++block) {
      out.block_of_line.push_back(block);
      out.added.push_back(false);
    }
  };
  for (const EarlierCut& cut : cuts) {
    const std::uint32_t first = cut.run.first_block;
    copy_to(first);
    if (replacements.empty() || replacements.back().first != first) replacements.push_back({first, first, {}});
    auto& lines = replacements.back().lines;
    const auto add = [&](std::string line, std::uint32_t of_block) {
      lines.push_back(std::move(line));
      out.block_of_line.push_back(of_block);
      out.added.push_back(true);
    };
    for (std::size_t i = 0; i < cut.lines.size(); ++i) add(without_number(cut.lines[i]), cut.block_of_lines[i]);
    for (std::string& line : WayBackWriter(program, moves, cut.run).lines()) add(std::move(line), Emission::kNoBlock);
  }
  copy_to(static_cast<std::uint32_t>(program.blocks.size()));
  for (BlockReplacement& r : replacements) {
    const Block& b = program.blocks[r.first];
    r.lines.push_back(program.source.text().substr(b.offset, b.length));
  }
  out.text = replace_blocks(program, replacements);
  return out;
}

}  // namespace camber::nc
