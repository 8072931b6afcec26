// Programs in which runs are cut twice: how they are made, and which one the rounds shift.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "compensate/loop.h"
#include "simulate/collisions.h"
#include "simulate/operations.h"

namespace camber::compensate {

using simulate::SimulatedProgram;

namespace {

constexpr std::size_t kDropped = 10;  // where the chosen runs take too long, one in so many is left as it is

/// Removes the run that contains the given program's move, or the last run before it.
std::vector<std::size_t> without_run_at(const std::vector<PassRun>& runs, std::vector<std::size_t> chosen,
                                        std::uint32_t move) {
  auto last = chosen.begin();
  for (auto r = chosen.begin(); r != chosen.end(); ++r)
    if (runs[*r].run.first_move <= move) last = r;
  chosen.erase(last);
  return chosen;
}

/// Removes some of the runs with the least error.
std::vector<std::size_t> without_least(const std::vector<PassRun>& runs, std::vector<std::size_t> chosen) {
  std::ranges::stable_sort(chosen, [&](std::size_t a, std::size_t b) { return runs[a].left_mm > runs[b].left_mm; });
  chosen.resize(chosen.size() - (chosen.size() + kDropped - 1) / kDropped);
  std::ranges::sort(chosen);
  return chosen;
}

/// The given program's block before which a rapid between two cuts collides.
std::optional<std::uint32_t> block_behind_collision(const machine::Job& job, const Version& version,
                                                    const removal::Stock& blank) {
  if (job.simulation.collisions == machine::Collisions::off) return std::nullopt;
  const nc::RepeatedText& text = *version.repeated;
  for (const simulate::Collision& c : simulate::find_collisions(job, version.program, blank)) {
    std::size_t line = version.program.moves_in_part().moves[c.move].block;
    if (!text.added[line] || text.block_of_line[line] != nc::Emission::kNoBlock) continue;
    while (text.added[line]) ++line;
    return text.block_of_line[line];
  }
  return std::nullopt;
}

}  // namespace

/// The given program with the chosen runs cut twice, within the time allowed; nothing where none of them can be. The
/// given one is active.
std::unique_ptr<Version> Loop::version_with(const std::vector<PassRun>& runs, std::vector<std::size_t> chosen,
                                            const nc::Emission& first_cuts) {
  const SimulatedProgram& given = setup_.program;
  while (!chosen.empty()) {
    auto out = std::make_unique<Version>();
    out->repeated = with_first_cuts(given, runs, chosen, first_cuts);
    out->operations = moved_ranges(simulate::as_lines(job_.operations, given.text(), given.moves_in_part()),
                                   out->repeated->block_of_line);
    machine::Job job = job_;
    job.operations = out->operations;
    Diagnostics repeated;  // the given program's
    out->program = simulate::simulate_motion(SourceText(job_.program, out->repeated->text), job, {}, repeated);
    std::uint32_t wrong = 0;
    const auto moves = moves_in_repeated(given.moves_in_part(), out->program.moves_in_part(), *out->repeated, wrong);
    if (!moves) {
      warn_of_run(given.moves_in_part().moves[wrong].block, nc::to_string(nc::RunGap::modal), "not-repeatable");
      chosen = without_run_at(runs, chosen, wrong);
      continue;
    }
    if (out->program.feed.time_s > allowed_s_) {
      too_slow_ = true;
      if (!options_.time_budget_percent) return nullptr;  // all of them within the next step of time
      chosen = without_least(runs, chosen);
      continue;
    }
    if (const auto block = block_behind_collision(job, *out, setup_.target.blank)) {
      warn_of_run(*block, "cannot be reached again by a rapid through the stock that is left", "pass-collision");
      std::erase_if(chosen, [&](std::size_t r) { return runs[r].run.first_block == *block; });
      continue;
    }
    out->passes = chosen;
    fill_moves(*moves, *out);
    return out;
  }
  return nullptr;
}

void Loop::warn_of_run(std::uint32_t block, const std::string& why, const char* check) {
  const nc::Program& text = setup_.program.text();
  diagnostics_.add(text.source.diagnostic(Severity::warning, text.blocks[block].offset,
                                          fmt::format("the cuts here are made once: the moves {}", why), check));
}

/// Fills in what a version takes over from the given program, which is active. `moves`: one per move of the given
/// program.
void Loop::fill_moves(const std::vector<std::uint32_t>& moves, Version& out) const {
  const std::size_t count = out.program.moves_in_part().moves.size();
  out.moves = moves;
  out.compensated.assign(count, false);
  for (std::size_t m = 0; m < moves.size(); ++m) out.compensated[moves[m]] = now_->compensated[m];
  out.first_cuts.resize(count);
  for (std::size_t m = 0; m < count; ++m)
    out.first_cuts[m] = out.repeated->added[out.program.moves_in_part().moves[m].block];
  out.stamps = setup_.target.stamps;
  if (setup_.own_target())
    for (simulate::PathFraction& stamp : out.stamps) stamp.move = moves[stamp.move];
  // What the nominal chip bends is not what the second cut's does: of hidden rows only the offset of the axes counts.
  out.bending.assign(trials_.bending.size(), Vec3::Zero());
}

void Loop::activate(std::size_t version) {
  if (version == active_) return;
  const auto exchange = [&](Version& v) {
    std::swap(v.program, setup_.program);
    std::swap(v.stamps, setup_.target.stamps);
    std::swap(v.operations, job_.operations);
    std::swap(v.bending, trials_.bending);
  };
  exchange(*now_);  // what the set-up has of it goes back
  active_ = version;
  now_ = versions_[version].get();
  exchange(*now_);
  trials_.first_cuts = now_->first_cuts;
}

/// The active version's first prediction.
void Loop::predict_version(CompensationResult& out) {
  begin_version(*now_);
  auto made = std::make_shared<Trial>();
  predict_trial(*made, fmt::format("round {}", out.rounds.size()));
  last_ = made;
  first_round_ = out.rounds.size();
  record(out, {});
  take(out);
}

}  // namespace camber::compensate
