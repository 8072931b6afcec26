#include "api/commands/sections.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/bytes.h"
#include "base/stage.h"
#include "simulate/turn.h"

namespace camber::api {
namespace {

template <class Part>
std::string bytes_of(const Part& part) {
  ByteWriter out;
  part.write(out);
  return out.take();
}

template <class Part>
Part part_of(PartStore& store, const PartName& name) {
  const std::string bytes = store.take(name);
  ByteReader in(bytes);
  return Part::read(in);
}

void add(const simulate::SectionWork& more, simulate::SectionWork& work) {
  work.stamps += more.stamps;
  work.voxels += more.voxels;
}

}  // namespace

SectionRun::SectionRun(const machine::Job& job, PartKey key, PartStore& store, StepProgress progress,
                       Diagnostics& diagnostics)
    : job_(job), key_(std::move(key)), store_(store), progress_(std::move(progress)), diagnostics_(diagnostics) {
  const StageScope stages(progress_);
  const auto check = [&](const simulate::SimulatedProgram& program) {
    simulate::check_program(job, program, diagnostics);
    diagnostics.throw_if_errors();
  };
  Diagnostics of_original;
  programs_ = simulate::read_programs(job, {.check = check},
                                      {.program = diagnostics, .original = of_original, .target = diagnostics});
  if (key_.forces_at > 0) turn_from_ = simulate::turn_at_line(programs_.program, job, key_.forces_at, diagnostics);
  diagnostics.throw_if_errors();
}

bool SectionRun::sweep(std::size_t section) {
  const PartName name{PartStage::sweep, 1, section, key_.sections};
  if (store_.has(name)) return false;
  const StageScope stages(progress_);
  const simulate::SweptSection part = simulate::sweep_section(job_, programs_, section, key_.sections, diagnostics_);
  add(part.work, work_);
  store_.give(name, bytes_of(part));
  return true;
}

std::vector<simulate::SolvedSection> SectionRun::solved_stocks(int round, std::size_t section,
                                                               const removal::Region& region) {
  std::vector<simulate::SolvedSection> out;
  for (std::size_t s = 0; s < key_.sections; ++s) {
    out.push_back(part_of<simulate::SolvedSection>(store_, {PartStage::solve, round, s, key_.sections}));
    if (s != section) simulate::keep_stock_within(out.back(), region, job_.simulation.voxel_mm);
  }
  return out;
}

bool SectionRun::solve(std::size_t section, int round) {
  const PartName name{PartStage::solve, round, section, key_.sections};
  if (store_.has(name)) return false;
  const StageScope stages(progress_);
  const removal::Region region = simulate::section_region(job_, programs_, section, key_.sections);
  simulate::SectionParts parts;
  for (std::size_t s = 0; s < key_.sections; ++s) {
    parts.swept.push_back(part_of<simulate::SweptSection>(store_, {PartStage::sweep, 1, s, key_.sections}));
    simulate::keep_within(parts.swept.back(), region, job_.simulation.voxel_mm);
  }
  if (round > 1) parts.last = solved_stocks(round - 1, section, region);
  if (round > 2) parts.before_last = solved_stocks(round - 2, section, region);
  const simulate::SolvedSection part = simulate::solve_section(job_, programs_, parts,
                                                               {.section = section,
                                                                .sections = key_.sections,
                                                                .turn_from = turn_from_,
                                                                .progress =
                                                                    [&](double share) {
                                                                      if (progress_) progress_("cutting", share);
                                                                    }},
                                                               diagnostics_);
  add(part.work, work_);
  store_.give(name, bytes_of(part));
  return true;
}

std::size_t SectionRun::solved_again(int round) {
  std::size_t out = 0;
  for (std::size_t s = 0; s < key_.sections && round > 1; ++s) {
    const auto part = part_of<simulate::SolvedSection>(store_, {PartStage::solve, round, s, key_.sections});
    if (!part.history.empty()) out += part.history.back().solved_again;
  }
  return out;
}

std::string with_sections(const std::string& json, const SectionFigures& figures) {
  auto out = nlohmann::ordered_json::parse(json);
  out["sections"] = {{"pieces", figures.pieces},
                     {"rounds", figures.rounds},
                     {"solved_again", figures.solved_again},
                     {"largest_change_um", figures.largest_change_um}};
  return out.dump(2) + "\n";
}

MergedJob merge_parts(const machine::Job& job, const PartKey& key, int round, PartStore& store,
                      const PredictRequest& request, Diagnostics& found, Diagnostics& of_cut) {
  simulate::SectionParts parts;
  SectionFigures figures;
  for (std::size_t s = 0; s < key.sections; ++s)
    parts.swept.push_back(part_of<simulate::SweptSection>(store, {PartStage::sweep, 1, s, key.sections}));
  figures.rounds = static_cast<std::size_t>(round);
  figures.solved_again.assign(static_cast<std::size_t>(round) - 1, 0);
  figures.largest_change_um.assign(static_cast<std::size_t>(round) - 1, 0);
  for (std::size_t s = 0; s < key.sections; ++s) {
    parts.last.push_back(part_of<simulate::SolvedSection>(store, {PartStage::solve, round, s, key.sections}));
    const simulate::SolvedSection& part = parts.last.back();
    for (std::size_t r = 0; r < part.history.size() && r < figures.solved_again.size(); ++r) {
      figures.solved_again[r] += part.history[r].solved_again;
      figures.largest_change_um[r] = std::max(figures.largest_change_um[r], part.history[r].largest_change_um);
    }
    figures.pieces += part.pieces.size();
  }
  PredictRequest joined = request;
  joined.forces_at = key.forces_at;
  joined.work = simulate::joined_target(parts);
  MergedJob out{prepare(job, joined, found), {}, figures, {}};
  simulate::Setup& setup = out.prepared.setup;
  out.prediction = simulate::merge_sections(job, setup.target, setup.program, parts);
  setup.target.surface.clear();
  setup.target.whole.reset();
  finish_prediction(job, out.prepared, out.prediction, of_cut);
  if (job.simulation.coupling == machine::Coupling::static_ && figures.pieces > 1) {
    if (round == 1)
      out.doubt = "the first round of sections in static coupling begins from what an undeflected cutter leaves";
    else if (figures.solved_again.back() > 0)
      out.doubt = fmt::format("round {} has solved {} of {} pieces again for changes of up to {:.2f} um", round,
                              figures.solved_again.back(), figures.pieces, figures.largest_change_um.back());
    if (!out.doubt.empty())
      out.doubt +=
          fmt::format("; --stage solve --round {} of all sections, and then camber merge, was expected", round + 1);
  }
  return out;
}

}  // namespace camber::api
