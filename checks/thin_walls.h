#pragma once
// Walls that are thin for their height, seen from above.
#include <optional>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/height_map.h"

namespace camber::checks {

/// A wall of less than this part of its height bends under a finishing cut by more than a stiff tool does.
constexpr double kThinOfHeight = 0.2;

struct ThinWall {
  double thickness_mm = 0, height_mm = 0;
  Vec2 place_mm = Vec2::Zero();  ///< a point of it
  double slenderness() const { return height_mm / thickness_mm; }
};

/// The most slender wall along X or Y that is thinner than kThinOfHeight of its height; the height is that of the lower
/// one of its sides. Walls of less than two cells are not seen.
std::optional<ThinWall> thinnest_wall(const removal::HeightMap& map);

/// Warning [workpiece-thin] at the job's [stock] where the machined part has such a wall and the job takes the part as
/// rigid.
void suggest_workpiece(const machine::Job& job, const motion::SimulatedProgram& program,
                       const removal::HeightMap& machined, Diagnostics& diagnostics);

}  // namespace camber::checks
