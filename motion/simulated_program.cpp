#include "motion/simulated_program.h"

#include <utility>

#include "motion/job_checks.h"
#include "motion/operations.h"

namespace camber::motion {

using machine::Job;

SimulatedProgram simulate_motion(SourceText source, const Job& job, const feedmodel::SampleSink& samples,
                                 Diagnostics& diagnostics) {
  SimulatedProgram out = read_moves(std::move(source), job, diagnostics);
  time_path(out, job, samples);
  return out;
}

SimulatedProgram read_moves(SourceText source, const Job& job, Diagnostics& diagnostics) {
  const kinematics::ReadingOptions reading = kinematics::reading_of(job);
  nc::Program text = nc::read_program(std::move(source), diagnostics);
  nc::Interpretation moves = kinematics::read_moves(text, job.machine, reading, diagnostics);
  assume_spindle(job, text, moves, diagnostics);
  SimulatedProgram out{kinematics::MachineProgram(std::move(text), std::move(moves), job.machine)};
  diagnostics.throw_if_errors();
  kinematics::check_on_part(out, diagnostics);
  const machine::Operations operations = as_lines(job.operations, out.text(), out.moves_in_part());
  out.selected = removal::selected_moves(out.moves_in_part(), operations);
  out.holes = removal::hole_moves(out.moves_in_part(), operations, job.tools);
  for (std::size_t i = 0; i < out.holes.size(); ++i)
    if (out.holes[i] != removal::HoleMove::none) out.selected[i] = false;
  check_cutting(job, out.text(), out.moves_in_part(), out.selected, out.holes, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

void time_path(SimulatedProgram& program, const Job& job, const feedmodel::SampleSink& samples,
               const removal::StampSink& stamps) {
  removal::StampBuilder builder(program.moves_in_part(), job.tools, program.selected, program.holes,
                                program.part_path(), stamps);
  const auto take = [&](const auto& run, std::span<const feedmodel::TimedSample> timed) {
    builder.add(run);
    if (samples) samples(timed);
  };
  program.feed = program.turns()
                     ? feedmodel::predict_on_part(program.moves_of_axes(), job.machine,
                                                  [&](const feedmodel::PartSamples& run) { take(run, run.samples()); })
                     : feedmodel::predict_feed(program.moves_in_part(), job.machine,
                                               [&](std::span<const feedmodel::TimedSample> run) { take(run, run); });
  program.path = builder.take();
}

Motion motion_at(const SimulatedProgram& program, const Job& job, std::span<const feedmodel::TimedSample> samples) {
  removal::StampBuilder builder(program.moves_in_part(), job.tools, program.selected, program.holes);
  builder.add(samples);
  return {builder.take(), {0, 0, program.feed.blocks}};
}

void exchange(SimulatedProgram& program, Motion& motion) {
  std::swap(program.path, motion.path);
  std::swap(program.feed, motion.feed);
}

}  // namespace camber::motion
