#pragma once
// A program as it runs on a job's machine: its moves, its timed path, and the stamps of the tools along it.
#include <span>
#include <vector>

#include "base/diagnostics.h"
#include "feedmodel/timed_path.h"
#include "kinematics/machine_program.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "removal/tool_path.h"

namespace camber::motion {

/// A program as it runs on the job's machine.
struct SimulatedProgram : kinematics::MachineProgram {
  std::vector<bool> selected{};            ///< per move: milled by the job's operations
  std::vector<removal::HoleMove> holes{};  ///< per move
  removal::StampPath path{};
  feedmodel::FeedSummary feed{};
};

/// Reads, interprets, checks and times a program, on the part where rotary axes turn. `samples` (may be empty) also
/// receives the timed path. Throws InputError.
SimulatedProgram simulate_motion(SourceText source, const machine::Job& job, const feedmodel::SampleSink& samples,
                                 Diagnostics& diagnostics);

/// A program's motion.
struct Motion {
  removal::StampPath path;
  feedmodel::FeedSummary feed;
};

/// Stamps at the positions of `samples`, in time order, each on a move of the program. Motion::feed keeps its blocks
/// alone.
Motion motion_at(const SimulatedProgram& program, const machine::Job& job,
                 std::span<const feedmodel::TimedSample> samples);
/// Gives the program another motion, and `motion` the one that it had.
void exchange(SimulatedProgram& program, Motion& motion);

/// simulate_motion() in two steps. First: reads, interprets and checks a program; `path` and `feed` are empty.
SimulatedProgram read_moves(SourceText source, const machine::Job& job, Diagnostics& diagnostics);
/// Second: times it, and stamps it. Its text is not looked at. Twice the same. `stamps` (may be empty): see
/// removal::StampBuilder.
void time_path(SimulatedProgram& program, const machine::Job& job, const feedmodel::SampleSink& samples,
               const removal::StampSink& stamps = {});

}  // namespace camber::motion
