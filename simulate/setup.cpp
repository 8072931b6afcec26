#include "simulate/setup.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "checks/collision_search.h"
#include "checks/collisions.h"
#include "checks/flute_reach.h"
#include "checks/height_survey.h"
#include "checks/machine_collisions.h"
#include "checks/region_start.h"
#include "checks/setup_checks.h"
#include "simulate/pieces.h"

namespace camber::simulate {

Programs read_programs(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings) {
  const bool other = !options.program.empty();
  SimulatedProgram program =
      motion::read_moves(SourceText::read(other ? options.program : job.program), job, findings.program);
  if (options.check) options.check(program);
  findings.program.throw_if_errors();
  motion::time_path(program, job, {});
  machine::Job of_target = job;
  if (job.part.operations) of_target.operations = *job.part.operations;
  std::optional<SimulatedProgram> original;
  if (!job.part.program.empty() || other || job.part.operations)
    original.emplace(motion::simulate_motion(
        SourceText::read(job.part.program.empty() ? job.program : job.part.program), of_target, {}, findings.original));
  return {std::move(program), std::move(original)};
}

Setup set_up(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings) {
  return set_up(job, options, findings, {});
}

namespace {

Programs taken_from(ReadPrograms& read, const SetupOptions& options, const SetupFindings& findings) {
  findings.program.append(read.said);
  if (options.check) options.check(read.programs.program);
  findings.program.throw_if_errors();
  return std::move(read.programs);
}

}  // namespace

Setup set_up(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings,
             const TargetWork& work, ReadPrograms* read) {
  Programs programs = read ? taken_from(*read, options, findings) : read_programs(job, options, findings);
  const bool cleared =
      options.clearance &&
      check_heights(job, programs.program, programs.original ? &*programs.original : nullptr, findings.target);
  findings.target.throw_if_errors();
  Target target = make_target(job, programs.of_target(), findings.target, work);
  return {std::move(programs.program), std::move(programs.original), std::move(target), cleared, options.predictor};
}

namespace {

/// When the tool is there: of a move's stamps the first one.
void set_times(const SimulatedProgram& program, std::vector<checks::Collision>& found) {
  const auto& stamps = program.path.stamps;
  const std::vector<checks::RapidCheck> rapids = checks::rapids_of(program);
  for (checks::Collision& c : found) {
    if (c.rapid) {
      const auto rapid = std::ranges::find(rapids, c.move, &checks::RapidCheck::move);
      if (rapid != rapids.end()) c.t_s = rapid->t_s;
      continue;
    }
    const auto stamp = std::ranges::lower_bound(stamps, c.move, {}, &removal::Stamp::move);
    if (stamp != stamps.end()) c.t_s = stamp->t_s;
  }
}

/// Less than this is what a survey may be wrong by.
double nothing_mm3(const checks::HeightSurvey& survey) { return std::pow(survey.cell_mm, 3); }

}  // namespace

bool check_heights(const machine::Job& job, const SimulatedProgram& program, const SimulatedProgram* original,
                   Diagnostics& diagnostics, const std::function<void(const removal::HeightMap& machined)>& look) {
  const std::optional<machine::Box> stock = checks::stock_box(job);
  if (!stock) return false;
  constexpr double kVisits = 3e9;
  const double cell = checks::quick_cell_mm(job, program, *stock, job.simulation.voxel_mm, kVisits);
  std::optional<checks::HeightSurvey> survey = checks::survey_heights(
      job, program, {.cell_mm = cell, .tolerance_mm = std::max(cell, job.simulation.voxel_mm), .target = original});
  if (!survey) return false;
  if (job.stock.allowance_mm > 0 && survey->allowance_mm3 < nothing_mm3(*survey))
    checks::report_allowance(job, diagnostics);
  diagnostics.throw_if_errors();
  if (!original && survey->removed_mm3 < nothing_mm3(*survey))
    checks::report_nothing_removed(program.text().source.name(), places_of(job, program, *stock), diagnostics);
  diagnostics.throw_if_errors();
  set_times(program, survey->collisions);
  checks::report_collisions(job, program, survey->collisions, diagnostics);
  checks::check_region_start(
      job, program, [&](const machine::Tool&, const ToolPose&) { return survey->starts_in_material; }, diagnostics);
  checks::report_above_flutes(job, program, survey->above_flutes, diagnostics);
  if (look) look(survey->machined);
  return true;
}

void check_clearance(const machine::Job& job, const Setup& setup, Diagnostics& diagnostics) {
  checks::check_machine_collisions(job, setup.program.text(), setup.program.moves_in_program(), diagnostics);
  if (setup.cleared) return;
  checks::check_collisions(job, setup.program, setup.target.blank, diagnostics);
  checks::check_region_start(job, setup.program, setup.target.blank, diagnostics);
  checks::check_flute_reach(job, setup.program, setup.target.blank, diagnostics);
}

std::function<void(double)> progress_of(const Progress& progress, std::string what) {
  if (!progress) return {};
  return [progress, what = std::move(what)](double fraction) { progress(what, fraction); };
}

Prediction predict_surface(const Predictor& predictor, const machine::Job& job, const Target& target,
                           const SimulatedProgram& program, const Progress& progress, std::string what) {
  PredictOptions options;
  options.contacts = false;
  options.progress = progress_of(progress, std::move(what));
  return predictor(job, target, program, options);
}

}  // namespace camber::simulate
