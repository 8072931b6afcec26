#include "api/new_program.h"

#include <utility>

#include "checks/machine_collisions.h"
#include "kinematics/machine_program.h"
#include "kinematics/travel_check.h"

namespace camber::api {

kinematics::MachineProgram read_new_program(const machine::Machine& machine, const std::string& name,
                                            const std::string& text, const nc::InterpreterOptions& interpreter) {
  Diagnostics again;
  nc::Program program = nc::read_program(SourceText(name, text), again);
  nc::Interpretation moves = kinematics::read_moves(
      program, machine, {.given = interpreter, .rotary = kinematics::RotaryWords::always}, again);
  again.throw_if_errors();
  return {std::move(program), std::move(moves), machine};
}

void check_new_program(const machine::Machine& machine, const machine::Job* job, const nc::Program& given,
                       nc::Interpretation moves, const std::vector<std::uint32_t>& block_of_line,
                       Diagnostics& diagnostics) {
  for (nc::Move& move : moves.moves) move.block = block_of_line[move.block];
  kinematics::check_travel(machine, given, moves, diagnostics);
  if (diagnostics.has_errors() || !job || machine.bodies.empty()) return;
  checks::check_machine_collisions(*job, given, moves, diagnostics);
}

}  // namespace camber::api
