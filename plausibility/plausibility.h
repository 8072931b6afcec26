#pragma once
// Is this job plausible? What its program, tools, material, stock, part and machine say of each other, before anything
// is simulated.
#include <span>
#include <string_view>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "simulate/predict_path.h"

namespace camber::plausibility {

struct Evidence;

/// A rule says what does not fit to what.
struct Rule {
  std::string_view check;     ///< name of its diagnostics
  std::string_view compares;  ///< what with what
  void (*look)(const Evidence&, Diagnostics&);
};

/// Every rule, in the order in which they look.
std::span<const Rule> rules();

/// Errors where a result would be meaningless, warnings where something is only odd. Seconds at most: of the program
/// its moves alone are needed (motion::read_moves). Throws InputError where stock or part cannot be read.
void check_plausibility(const machine::Job& job, const simulate::SimulatedProgram& program, Diagnostics& diagnostics);

/// The same of a job whose program is yet to be made (copy, resegment --part): its tools, material, stock and part.
void check_job_values(const machine::Job& job, Diagnostics& diagnostics);

/// The checks that every command makes of a job's program before its work: whether the machine can run it
/// (motion/machine_checks.h), and whether the job is plausible.
void check_program(const machine::Job& job, const simulate::SimulatedProgram& program, Diagnostics& diagnostics);

}  // namespace camber::plausibility
