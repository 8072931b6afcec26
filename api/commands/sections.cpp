#include "api/commands/sections.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace camber::api {

std::string with_sections(const std::string& json, const SectionFigures& figures) {
  auto out = nlohmann::ordered_json::parse(json);
  out["sections"] = {{"pieces", figures.pieces},
                     {"rounds", figures.rounds},
                     {"solved_again", figures.solved_again},
                     {"largest_change_um", figures.largest_change_um}};
  return out.dump(2) + "\n";
}

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

}  // namespace

MergedJob merge_parts(const machine::Job& job, const distribute::PartKey& key, int round, distribute::PartStore& store,
                      const PredictRequest& request, Diagnostics& found, Diagnostics& of_cut) {
  for (std::size_t s = 0; s < key.sections; ++s) store.check({distribute::PartStage::sweep, 1, s, key.sections});
  const distribute::EachSwept swept =
      each_part<distribute::SweptSection>(store, distribute::PartStage::sweep, 1, key.sections);
  const distribute::EachSolved solved =
      each_part<distribute::SolvedSection>(store, distribute::PartStage::solve, round, key.sections);
  SectionFigures figures;
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
  PredictRequest joined = request;
  joined.forces_at = key.forces_at;
  joined.work = distribute::joined_target(swept, solved);
  MergedJob out{prepare(job, joined, found), {}, figures, {}};
  simulate::Setup& setup = out.prepared.setup;
  out.prediction = distribute::merge_sections(job, setup.target, setup.program, swept, solved);
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
