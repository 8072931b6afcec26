#include "api/merged_sections.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "report/joined_json.h"

namespace camber::api {

namespace {

/// The parts of all sections as they are asked for, one after the other.
template <class Part>
auto each_part(distribute::PartStore& store, distribute::PartStage stage, int round, std::size_t sections) {
  return [&store, stage, round, sections](const auto& use) {
    for (std::size_t s = 0; s < sections; ++s) {
      Part part = distribute::part_of<Part>(store, {stage, round, s, sections});
      use(part);
    }
  };
}

report::SectionFigures figures_of(const distribute::EachSolved& solved, int round) {
  report::SectionFigures figures;
  figures.rounds = static_cast<std::size_t>(round);
  figures.solved_again.assign(static_cast<std::size_t>(round) - 1, 0);
  figures.largest_change_um.assign(static_cast<std::size_t>(round) - 1, 0);
  solved([&](const distribute::SolvedSection& part) {
    for (std::size_t r = 0; r < part.history.size() && r < figures.solved_again.size(); ++r) {
      figures.solved_again[r] += part.history[r].solved_again;
      figures.largest_change_um[r] = std::max(figures.largest_change_um[r], part.history[r].largest_change_um);
    }
    figures.pieces += part.cuts.size();
  });
  return figures;
}

/// About static coupling; empty: none.
std::string doubt_of(const machine::Job& job, const report::SectionFigures& figures, int round) {
  std::string doubt;
  if (job.simulation.coupling == machine::Coupling::static_ && figures.pieces > 1) {
    if (round == 1)
      doubt = "the first round of sections in static coupling begins from what an undeflected cutter leaves";
    else if (figures.solved_again.back() > 0)
      doubt = fmt::format("round {} has solved {} of {} pieces again for changes of up to {:.2f} um", round,
                          figures.solved_again.back(), figures.pieces, figures.largest_change_um.back());
    if (!doubt.empty())
      doubt +=
          fmt::format("; --stage solve --round {} of all sections, and then camber merge, was expected", round + 1);
  }
  return doubt;
}

}  // namespace

PredictResult merge_parts(const machine::Job& job, const distribute::PartKey& key, int round,
                          distribute::PartStore& store, const PredictOptions& options,
                          std::shared_ptr<simulate::ReadPrograms> programs, Run& run) {
  for (std::size_t s = 0; s < key.sections; ++s) store.check({distribute::PartStage::sweep, 1, s, key.sections});
  const distribute::EachSwept swept =
      each_part<distribute::SweptSection>(store, distribute::PartStage::sweep, 1, key.sections);
  const distribute::EachSolved solved =
      each_part<distribute::SolvedSection>(store, distribute::PartStage::solve, round, key.sections);
  const report::SectionFigures figures = figures_of(solved, round);
  PredictOptions joined = options;
  joined.forces_at = key.forces_at;
  Diagnostics found, of_cut;
  PreparedJob prepared = prepare(
      job, joined,
      {.progress = run.steps(), .work = distribute::joined_target(swept, solved), .programs = std::move(programs)},
      found);
  simulate::Setup& setup = prepared.setup;
  simulate::Prediction prediction = distribute::merge_sections(job, setup.target, setup.program, swept, solved);
  setup.target.surface.clear();
  setup.target.whole.reset();
  finish_prediction(job, prepared, prediction, of_cut);
  run.settle_first(found);
  run.settle(of_cut);
  found.append(of_cut);
  FinishedPrediction done{.job = job,
                          .prepared = prepared,
                          .prediction = prediction,
                          .doubts = doubts_of(job, setup.program, prediction),
                          .with_more = [&](const std::string& json) { return report::with_sections(json, figures); }};
  if (std::string doubt = doubt_of(job, figures, round); !doubt.empty()) done.doubts.push_back(std::move(doubt));
  PredictResult out;
  finish_result(done, joined, run, found, out);
  return out;
}

}  // namespace camber::api
