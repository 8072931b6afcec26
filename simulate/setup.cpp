#include "simulate/setup.h"

#include <utility>

#include "simulate/collisions.h"
#include "simulate/flute_reach.h"
#include "simulate/machine_checks.h"
#include "simulate/setup_checks.h"

namespace camber::simulate {

Setup set_up(const machine::Job& job, const SetupOptions& options, const SetupFindings& findings) {
  const bool other = !options.program.empty();
  const auto motion_of = [&](const std::string& file, Diagnostics& diagnostics) {
    return simulate_motion(SourceText::read(file), job, {}, diagnostics);
  };
  SimulatedProgram program = motion_of(other ? options.program : job.program, findings.program);
  if (options.check) options.check(program);
  findings.program.throw_if_errors();
  std::optional<SimulatedProgram> original;
  if (!job.part.program.empty())
    original.emplace(motion_of(job.part.program, findings.original));
  else if (other)
    original.emplace(motion_of(job.program, findings.original));
  Target target = make_target(job, original ? *original : program, findings.target);
  return {std::move(program), std::move(original), std::move(target)};
}

void check_program(const machine::Job& job, const SimulatedProgram& program, Diagnostics& diagnostics) {
  check_machine(job.machine, program.text, program.moves, diagnostics);
  check_tool_lengths(job, cutting_tools(program.moves, program.selected, program.holes), diagnostics);
}

void check_clearance(const machine::Job& job, const Setup& setup, Diagnostics& diagnostics) {
  check_collisions(job, setup.program, setup.target.blank, diagnostics);
  check_flute_reach(job, setup.program, setup.target.blank, diagnostics);
}

std::function<void(double)> progress_of(const Progress& progress, std::string what) {
  if (!progress) return {};
  return [progress, what = std::move(what)](double share) { progress(what, share); };
}

Prediction predict_surface(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                           const Progress& progress, std::string what) {
  PredictOptions options;
  options.contacts = false;
  options.progress = progress_of(progress, std::move(what));
  return predict(job, target, program, options);
}

}  // namespace camber::simulate
