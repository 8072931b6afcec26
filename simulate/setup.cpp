#include "simulate/setup.h"

#include <utility>

#include "simulate/collisions.h"
#include "simulate/flute_reach.h"
#include "simulate/machine_checks.h"
#include "simulate/machine_collisions.h"
#include "simulate/pieces.h"
#include "simulate/region.h"
#include "simulate/setup_checks.h"

namespace camber::simulate {

Programs read_programs(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings) {
  const bool other = !options.program.empty();
  SimulatedProgram program =
      simulate_motion(SourceText::read(other ? options.program : job.program), job, {}, findings.program);
  if (options.check) options.check(program);
  findings.program.throw_if_errors();
  machine::Job of_target = job;
  if (job.part.operations) of_target.operations = *job.part.operations;
  std::optional<SimulatedProgram> original;
  if (!job.part.program.empty() || other || job.part.operations)
    original.emplace(simulate_motion(SourceText::read(job.part.program.empty() ? job.program : job.part.program),
                                     of_target, {}, findings.original));
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
  Target target = make_target(job, programs.of_target(), findings.target, work);
  return {std::move(programs.program), std::move(programs.original), std::move(target)};
}

void check_program(const machine::Job& job, const SimulatedProgram& program, Diagnostics& diagnostics) {
  check_machine(job.machine, program.text, program.text_moves(), diagnostics);
  check_tool_lengths(job, cutting_tools(program.moves, program.selected, program.holes), diagnostics);
}

void check_clearance(const machine::Job& job, const Setup& setup, Diagnostics& diagnostics) {
  check_collisions(job, setup.program, setup.target.blank, diagnostics);
  check_machine_collisions(job, setup.program.text, setup.program.text_moves(), diagnostics);
  check_region_start(job, setup.program, setup.target.blank, diagnostics);
  check_flute_reach(job, setup.program, setup.target.blank, diagnostics);
}

std::function<void(double)> progress_of(const Progress& progress, std::string what) {
  if (!progress) return {};
  return [progress, what = std::move(what)](double fraction) { progress(what, fraction); };
}

Prediction predict_surface(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                           const Progress& progress, std::string what) {
  PredictOptions options;
  options.contacts = false;
  options.progress = progress_of(progress, std::move(what));
  return predict(job, target, program, options);
}

}  // namespace camber::simulate
