#pragma once
// The tool and the machine's head against table and fixtures: [[body]] of machine.toml.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/diagnostics.h"
#include "checks/tool_outline.h"
#include "kinematics/chain.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::checks {

/// Something of the machine meets a body.
struct MachineCollision {
  std::uint32_t move = 0;                              ///< index into Interpretation::moves
  std::size_t body = 0;                                ///< index into Machine::bodies
  std::optional<std::size_t> other_body{};             ///< that meets it; none: the tool does
  OutlineRing::Part part = OutlineRing::Part::cutter;  ///< of the tool
  int tool = 0;
  Vec3 tip_mm = Vec3::Zero();  ///< of the tool, in the frame of the moves
};

/// Where each contact begins, in the order of the moves. All moves of a job's tools between known places, rapids as the
/// control goes them (feedmodel::positioning_places), of unknown start at their end. `moves`: in the coordinates of the
/// text.
///
/// Solids are convex pieces; their distance is exact to 1e-4 mm (base/convex_distance.h), and where it is d, the next
/// place is where no point of either has moved by more than d against the other, or by a tenth of a millimetre where d
/// is less. Every end of a move is looked at. The tool is taken as smaller by kContact_mm (machine_solids.h), so
/// that it may touch a body.
///
/// The tool is compared with bodies that at least one axis moves against it, bodies with each other where two axes or
/// more are between them: neighbours touch where they are joined.
///
/// Requires the work offset (origin_of_machine). Throws InputError if a mesh cannot be read.
std::vector<MachineCollision> find_machine_collisions(const machine::Job& job, const nc::Program& text,
                                                      const nc::Interpretation& moves);

/// Machine zero in the frame of the moves: as the program gives it (G10 L2), without rotary motion also as the job does
/// ([compensation] work_offset_mm).
std::optional<Vec3> origin_of_machine(const machine::Job& job, const nc::Interpretation& moves);

/// The same as diagnostics [collision-table] at the blocks, errors unless the job says otherwise; [work-offset] where
/// it is not known.
void check_machine_collisions(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                              Diagnostics& diagnostics);

// Where the axes of a machine go in a program, move by move. Internal to checks/.

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
