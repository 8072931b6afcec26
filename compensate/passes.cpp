#include "compensate/passes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

#include <fmt/format.h>

namespace camber::compensate {
namespace {

constexpr double kMinAllowance_mm = 0.02;
constexpr double kRapid_mm_per_s = 100;  // an estimate; the machine's own time counts in the end
constexpr double kSame_mm = 1e-6;

/// Time from the first to the last tooth passing of each move.
std::vector<double> times_of(const simulate::SimulatedProgram& program) {
  std::vector<double> out(program.moves_in_part().moves.size(), 0.0);
  const auto& stamps = program.path.stamps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (!stamps[i].first) out[stamps[i].move] += stamps[i].t_s - stamps[i - 1].t_s;
  return out;
}

double percentile95(std::vector<std::pair<double, double>>& value_and_area) {
  std::ranges::sort(value_and_area);
  double area = 0, run = 0;
  for (const auto& v : value_and_area) area += v.second;
  for (const auto& v : value_and_area)
    if ((run += v.second) >= 0.95 * area) return v.first;
  return 0;
}

bool same_move(const nc::Interpretation& a, const nc::Move& m, const nc::Interpretation& b, const nc::Move& n) {
  if (m.kind != n.kind || m.editable != n.editable || m.canned != n.canned) return false;
  if ((m.end_mm - n.end_mm).norm() > kSame_mm || std::abs(m.feed_mm_per_s - n.feed_mm_per_s) > kSame_mm) return false;
  nc::ModalState s = a.state_of(m), t = b.state_of(n);
  s.frame = t.frame = 0;
  if (!(s == t) || !(a.frame_of(m) == b.frame_of(n))) return false;
  if (m.kind != nc::MoveKind::arc) return true;
  return (a.arcs[m.arc].center_mm - b.arcs[n.arc].center_mm).norm() < kSame_mm &&
         std::abs(a.arcs[m.arc].sweep_rad - b.arcs[n.arc].sweep_rad) < kSame_mm;
}

}  // namespace

void check_passes(const simulate::SimulatedProgram& program, const std::vector<bool>& selected,
                  Diagnostics& diagnostics) {
  const auto runs = nc::cut_runs(program.text(), program.moves_in_part(), selected);
  const auto gap = [](const nc::CutRun& r) { return r.why_not != nc::RunGap::none; };
  const auto first = std::ranges::find_if(runs, gap);
  if (first == runs.end()) return;
  const auto count = static_cast<std::size_t>(std::ranges::count_if(runs, gap));
  const bool none = count == runs.size();
  const std::size_t offset = program.text().blocks[first->first_block].offset;
  if (none)
    diagnostics.add(program.text().source.diagnostic(
        Severity::error, offset,
        fmt::format("levers names \"passes\", but none of the cuts to compensate can be made twice: those from here on "
                    "{}; levers without \"passes\" were expected",
                    nc::to_string(first->why_not)),
        "lever-unusable"));
  else
    diagnostics.add(program.text().source.diagnostic(
        Severity::warning, offset,
        fmt::format("{} of {} runs of cuts between rapids cannot be made twice; the moves of the first, from here on, "
                    "{}",
                    count, runs.size(), nc::to_string(first->why_not)),
        "not-repeatable"));
}

std::vector<PassRun> pass_runs(const simulate::SimulatedProgram& given, const std::vector<bool>& selected,
                               const ShiftPath& path, std::span<const Observation> observations,
                               std::span<const double> left_mm) {
  std::vector<PassRun> out;
  const std::vector<double> times = times_of(given);
  std::vector<std::size_t> run_of(given.moves_in_part().moves.size(), 0);
  for (nc::CutRun& run : nc::cut_runs(given.text(), given.moves_in_part(), selected)) {
    if (run.why_not != nc::RunGap::none) continue;
    PassRun next{.run = std::move(run)};
    for (std::uint32_t m = next.run.first_move; m <= next.run.last_move; ++m) {
      run_of[m] = out.size() + 1;
      next.time_s += times[m];
    }
    next.time_s += next.run.way_back_mm / kRapid_mm_per_s;
    out.push_back(std::move(next));
  }
  std::vector<std::vector<std::pair<double, double>>> left(out.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const std::uint32_t move = path.points()[observations[i].place.lower + 1].move;
    if (run_of[move] > 0) left[run_of[move] - 1].emplace_back(std::abs(left_mm[i]), observations[i].area_mm2);
  }
  for (std::size_t r = 0; r < out.size(); ++r) out[r].left_mm = percentile95(left[r]);
  return out;
}

std::vector<std::size_t> choose_passes(std::span<const PassRun> runs, double budget_s, double wanted_mm, int most) {
  struct Next {
    double left_mm;
    std::size_t run;
    int cuts;  ///< that are chosen
    bool operator<(const Next& other) const {
      return left_mm != other.left_mm ? left_mm < other.left_mm : run > other.run;
    }
  };
  std::priority_queue<Next> queue;
  for (std::size_t r = 0; r < runs.size(); ++r) queue.push({runs[r].left_mm, r, 0});
  std::vector<std::size_t> out;
  double time = 0;
  while (!queue.empty() && queue.top().left_mm > wanted_mm) {
    const Next next = queue.top();
    queue.pop();
    if (time + runs[next.run].time_s > budget_s) continue;
    time += runs[next.run].time_s;
    out.push_back(next.run);
    if (next.cuts + 1 < most) queue.push({kLeftByCut * next.left_mm, next.run, next.cuts + 1});
  }
  std::ranges::sort(out);
  return out;
}

std::vector<double> left_after_passes_mm(std::span<const PassRun> runs, std::span<const std::size_t> chosen,
                                         const ShiftPath& path, std::span<const Observation> observations,
                                         std::span<const double> left_mm) {
  std::map<std::uint32_t, double> left_of_move;  // of what is left now
  for (const std::size_t r : chosen)
    for (std::uint32_t m = runs[r].run.first_move; m <= runs[r].run.last_move; ++m)
      left_of_move.try_emplace(m, 1.0).first->second *= kLeftByCut;
  std::vector<double> out(left_mm.begin(), left_mm.end());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto left = left_of_move.find(path.points()[observations[i].place.lower + 1].move);
    if (left != left_of_move.end()) out[i] *= left->second;
  }
  return out;
}

double pass_allowance_mm(double gouge_depth_mm, double tolerance_mm) {
  return std::max(kMinAllowance_mm, gouge_depth_mm + tolerance_mm / 2);
}

nc::RepeatedText with_first_cuts(const simulate::SimulatedProgram& given, std::span<const PassRun> runs,
                                 std::span<const std::size_t> chosen, const nc::Emission& first_cuts) {
  const SourceText text("", first_cuts.text);
  std::vector<nc::EarlierCut> cuts;
  std::size_t line = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (i > 0 && chosen[i] == chosen[i - 1]) {
      cuts.push_back(cuts.back());
      continue;
    }
    nc::EarlierCut cut{.run = runs[chosen[i]].run};
    for (; line < first_cuts.block_of_line.size(); ++line) {
      const std::uint32_t block = first_cuts.block_of_line[line];
      if (block == nc::Emission::kNoBlock || block < cut.run.first_block) continue;
      if (block > cut.run.last_block) break;
      cut.lines.emplace_back(text.line(line + 1));
      cut.block_of_lines.push_back(block);
    }
    cuts.push_back(std::move(cut));
  }
  return nc::repeat_runs(given.text(), given.moves_in_part(), cuts);
}

std::optional<std::vector<std::uint32_t>> moves_in_repeated(const nc::Interpretation& given,
                                                            const nc::Interpretation& repeated,
                                                            const nc::RepeatedText& text, std::uint32_t& wrong) {
  std::vector<std::uint32_t> out;
  out.reserve(given.moves.size());
  std::uint32_t r = 0;
  for (std::uint32_t m = 0; m < given.moves.size(); ++m) {
    while (r < repeated.moves.size() && text.added[repeated.moves[r].block]) ++r;
    wrong = m;
    const nc::Move& move = given.moves[m];
    if (r == repeated.moves.size() || text.block_of_line[repeated.moves[r].block] != move.block) return std::nullopt;
    if (!same_move(given, move, repeated, repeated.moves[r])) return std::nullopt;
    const bool cuts = move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc;
    if (cuts && (move.start_mm - repeated.moves[r].start_mm).norm() > kSame_mm) return std::nullopt;
    out.push_back(r++);
  }
  return out;
}

}  // namespace camber::compensate
