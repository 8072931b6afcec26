#pragma once
// What find_collisions is made of. Internal to checks/.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "checks/collisions.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/stock.h"

namespace camber::checks {

inline constexpr double kCollisionStep_mm = 0.5;  ///< along paths and on outlines

/// A rapid to be checked.
struct RapidCheck {
  std::uint32_t move = 0;
  double t_s = 0;
  std::size_t before_stamp = 0;  ///< it happens before this stamp
  bool start_known = true;
};

/// The program's rapids with a known end, in order; without those of cycles that stay in their hole.
std::vector<RapidCheck> rapids_of(const motion::SimulatedProgram& program);

/// `found` gets another collision, unless its last one is of the same block and the same part of the tool.
void add_collision(const motion::SimulatedProgram& program, const Collision& c, std::vector<Collision>& found);

/// Requires upright stamps, and rapids without rotary motion.
std::vector<Collision> find_upright_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                                               const removal::Stock& blank);
/// Tools of any direction.
std::vector<Collision> find_tilted_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                                              const removal::Stock& blank);

}  // namespace camber::checks
