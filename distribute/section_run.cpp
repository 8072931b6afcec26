#include "distribute/section_run.h"

#include <type_traits>
#include <utility>

#include "base/bytes.h"
#include "base/stage.h"
#include "plausibility/plausibility.h"
#include "simulate/turn.h"

namespace camber::distribute {
namespace {

template <class Part>
void give_part(PartStore& store, const PartName& name, const Part& part) {
  store.give(name, [&](const auto& put) { put(bytes_of_part(part)); });
}

void add(const SectionWork& more, SectionWork& work) {
  work.stamps += more.stamps;
  work.voxels += more.voxels;
}

/// Pieces of a path are cut apart from each other, without what a survey of the part along all of it finds.
void refuse_elastic_part(const machine::Job& job, Diagnostics& diagnostics) {
  if (!job.workpiece) return;
  Diagnostic d = job.workpiece->place;
  d.message = "[workpiece] is for a prediction in one piece; one without --sections was expected";
  d.check = "workpiece-sections";
  diagnostics.add(d);
  diagnostics.throw_if_errors();
}

}  // namespace

SectionRun::SectionRun(const machine::Job& job, PartKey key, PartStore& store, PartProgress progress,
                       Diagnostics& diagnostics, std::size_t longest_path)
    : job_(job), key_(std::move(key)), store_(store), progress_(std::move(progress)), diagnostics_(diagnostics) {
  const StageScope stages(progress_);
  refuse_elastic_part(job, diagnostics);
  const auto check = [&](const simulate::SimulatedProgram& program) {
    diagnostics.append(said_);
    plausibility::check_program(job, program, diagnostics);
    diagnostics.throw_if_errors();
  };
  Diagnostics of_original;
  // A line is looked for in the text, and along the whole path.
  if (key_.forces_at > 0) longest_path = kWholePath;
  programs_.emplace(job, SectionProgramsOptions{.longest_path = longest_path, .check = check},
                    simulate::SetupFindings{.program = said_, .original = of_original, .target = diagnostics});
  if (key_.forces_at > 0) turn_from_ = simulate::turn_at_line(programs_->program(), job, key_.forces_at, diagnostics);
  diagnostics.throw_if_errors();
}

std::shared_ptr<simulate::ReadPrograms> SectionRun::take_programs() {
  target_.reset();
  std::optional<simulate::Programs> programs = programs_->take();
  programs_.reset();
  if (!programs) return nullptr;
  return std::make_shared<simulate::ReadPrograms>(*std::move(programs), std::move(said_));
}

bool SectionRun::is_there(const PartName& name) {
  if (!store_.has(name)) return false;
  PartName own = name;
  own.own = true;
  const bool solved_once = name.stage == PartStage::solve && !is_static();
  return solved_once || store_.has(own);
}

const removal::Region& SectionRun::region(std::size_t section) {
  for (std::size_t s = regions_.size(); s < key_.sections; ++s)
    regions_.push_back(section_region(job_, *programs_, s, key_.sections));
  return regions_[section];
}

bool SectionRun::sweep(std::size_t section) {
  const PartName whole = name(PartStage::sweep, 1, section);
  if (is_there(whole)) return false;
  const StageScope stages(progress_);
  programs_->go_to(section, key_.sections);
  SweptSection part;
  // Its own pieces are many times what others need: they are written as they are carved.
  store_.give(name(PartStage::sweep, 1, section, true), [&](const auto& put) {
    part = sweep_section(
        job_, *programs_, section, key_.sections,
        [&](const removal::StockPart& piece) {
          const std::string bytes = bytes_of_part(piece);
          ByteWriter size;
          size.value(static_cast<std::uint64_t>(bytes.size()));
          put(size.take());
          put(bytes);
        },
        diagnostics_);
  });
  add(part.work, work_);
  give_part(store_, whole, part);
  return true;
}

/// Parts that a round of solving reads. Of the other sections only what lies in the section's region.
SectionParts SectionRun::parts_before(std::size_t section, int round) {
  const double voxel_mm = job_.simulation.voxel_mm;
  SectionParts out;
  const auto take_all = [&](auto& parts, PartStage stage, int of_round) {
    using Part = typename std::remove_reference_t<decltype(parts)>::value_type;
    for (std::size_t s = 0; s < key_.sections; ++s) {
      auto part = part_of<Part>(store_, name(stage, of_round, s));
      parts.push_back(s == section ? std::move(part) : part.within(region(section), voxel_mm));
    }
  };
  // Later rounds read of the sweeps what the target is made of, if it is not kept.
  if (round <= 2 || !target_) take_all(out.swept, PartStage::sweep, 1);
  if (round <= 2)
    out.own_sweep.open = [this, own = name(PartStage::sweep, 1, section, true)] { return store_.take_pieces(own); };
  if (round > 1) {
    take_all(out.last, PartStage::solve, round - 1);
    out.own_last = part_of<OwnSolution>(store_, name(PartStage::solve, round - 1, section, true));
  }
  if (round > 2) {
    take_all(out.before_last, PartStage::solve, round - 2);
    out.own_before_last = part_of<OwnSolution>(store_, name(PartStage::solve, round - 2, section, true));
  }
  return out;
}

bool SectionRun::solve(std::size_t section, int round) {
  const PartName whole = name(PartStage::solve, round, section);
  if (is_there(whole)) return false;
  const StageScope stages(progress_);
  if (target_section_ != section) target_.reset();
  target_section_ = section;
  programs_->go_to(section, key_.sections);
  const SectionParts parts = parts_before(section, round);
  const auto tell = [&](double share) {
    if (progress_) progress_("cutting", share);
  };
  const SolveOptions options{.section = section, .sections = key_.sections, .turn_from = turn_from_, .progress = tell};
  const Solved part = solve_section(job_, *programs_, parts, options, diagnostics_, is_static() ? &target_ : nullptr);
  add(part.section.work, work_);
  if (is_static()) give_part(store_, name(PartStage::solve, round, section, true), part.own);
  give_part(store_, whole, part.section);
  return true;
}

std::function<std::string(std::size_t)> SectionRun::part_for_others(const PartName& of) {
  const auto sender = [this](auto part) {
    return [this, part = std::make_shared<const decltype(part)>(std::move(part))](std::size_t section) {
      return bytes_of_part(part->within(region(section), job_.simulation.voxel_mm));
    };
  };
  if (of.stage == PartStage::sweep) return sender(part_of<SweptSection>(store_, of));
  return sender(part_of<SolvedSection>(store_, of));
}

std::size_t SectionRun::solved_again_in(const PartName& of) {
  if (of.stage == PartStage::sweep || of.round < 2) return 0;
  const auto part = part_of<SolvedSection>(store_, of);
  return part.history.empty() ? 0 : part.history.back().solved_again;
}

std::size_t SectionRun::solved_again(int round) {
  std::size_t out = 0;
  for (std::size_t s = 0; s < key_.sections; ++s) out += solved_again_in(name(PartStage::solve, round, s));
  return out;
}

}  // namespace camber::distribute
