#pragma once
// What camber post and camber posture have written: read again, and checked at the blocks of the given program.
#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "kinematics/machine_program.h"
#include "machine/job_file.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"

namespace camber::api {

/// `name`: in messages. Throws InputError: an error in the text is ours. Warnings were said of the given text.
kinematics::MachineProgram read_new_program(const machine::Machine& machine, const std::string& name,
                                            const std::string& text, const nc::InterpreterOptions& interpreter);

/// Runs kinematics::check_travel on the new moves and, for a job whose machine has bodies and where that finds
/// nothing, checks::check_machine_collisions. Messages name blocks of the given program.
void check_new_program(const machine::Machine& machine, const machine::Job* job, const nc::Program& given,
                       nc::Interpretation moves, const std::vector<std::uint32_t>& block_of_line,
                       Diagnostics& diagnostics);

}  // namespace camber::api
