#pragma once
// Rapids through material; shank and holder against stock.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/stock.h"

namespace camber::checks {

struct Collision {
  enum class Part { cutter, shank, holder };  ///< a cutter collides in rapids only; the neck counts as shank
  Part part = Part::cutter;
  bool rapid = false;
  double t_s = 0;          ///< a rapid: when it begins
  std::uint32_t move = 0;  ///< index into Interpretation::moves
  int tool = 0;
  Vec3 place_mm = Vec3::Zero();  ///< of the tool's outline, in material
};

/// First collision of every block, in order of time.
///
/// The undeflected cutter is swept through a copy of the blank; a rapid is checked at its time; shank, neck and holder
/// are checked before their stretch of path is cut, because the cutter must have made room earlier. Positions above or
/// beside the stock are skipped, and nothing is swept if no part of a tool comes that low. Rapids follow the path of
/// the machine's control, straight or with every axis on its own (feedmodel::positioning_places); leading rapids, those
/// after a tool change and after a reference point whose start is not known are checked at their end only; a rapid
/// straight up is accepted if no part of the tool is narrower than the part below it. Less than a voxel of depth is no
/// collision; places every half millimetre of path, half a millimetre apart on the outline. Rapids of a cycle within
/// its hole are accepted.
std::vector<Collision> find_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                                       const removal::Stock& blank);

/// The same as diagnostics at the blocks: [collision-rapid], [collision-shank], [collision-holder]. Their severity is
/// that of the job; by default errors, or warnings if a part of the program is not simulated (operations, cycles that
/// are not carved), because the stock then contains material that the machine has removed. Collisions of moves outside
/// the job's operations are one diagnostic, at the first.
void check_collisions(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                      Diagnostics& diagnostics);
/// Of collisions that are found already.
void report_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                       const std::vector<Collision>& found, Diagnostics& diagnostics);
/// The severity of the job; nothing where collisions are not looked for.
std::optional<Severity> collision_severity(const machine::Job& job, const motion::SimulatedProgram& program);

}  // namespace camber::checks
