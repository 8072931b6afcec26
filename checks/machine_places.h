#pragma once
// Where the axes of a machine go in a program, move by move. Internal to checks/.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kinematics/chain.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program.h"

namespace camber::checks {

/// A move of a tool of the job.
struct MachineMove {
  std::uint32_t move = 0;
  int tool = 0;
  double tool_length_mm = 0;  ///< gauge line to tip
  bool goes_on = false;       ///< the first place is where the last move ended, with the same tool
};

/// All axes go straight from place to place. One place alone where the start is not known.
using MachineMoveSink = std::function<void(const MachineMove&, std::span<const kinematics::Joints>)>;

/// A machine without [kinematics] has the axes x, y and z between part and spindle.
kinematics::Chain chain_of(const machine::Machine& machine);

/// All moves between known places. Without rotary motion, and without G43 and a known length, a tool's length goes up
/// to the upper end of its holder. `origin_mm`: machine zero in the frame of the moves.
void for_each_machine_move(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                           const Vec3& origin_mm, const MachineMoveSink& sink);

}  // namespace camber::checks
