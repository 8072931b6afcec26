#pragma once
// What find_collisions is made of. Internal to simulate/.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "machine/job_file.h"
#include "removal/stock.h"
#include "simulate/collisions.h"
#include "simulate/predict.h"

namespace camber::simulate {

inline constexpr double kCollisionStep_mm = 0.5;  ///< along paths and on outlines

/// A rapid to be checked.
struct RapidCheck {
  std::uint32_t move = 0;
  double t_s = 0;
  std::size_t before_stamp = 0;  ///< it happens before this stamp
  bool start_known = true;
};

/// The program's rapids with a known end, in order; without those of cycles that stay in their hole.
std::vector<RapidCheck> rapids_of(const SimulatedProgram& program);

/// `found` gets another collision, unless its last one is of the same block and the same part of the tool.
void add_collision(const SimulatedProgram& program, const Collision& c, std::vector<Collision>& found);

/// Requires upright stamps, and rapids without rotary motion.
std::vector<Collision> find_upright_collisions(const machine::Job& job, const SimulatedProgram& program,
                                               const removal::Stock& blank);
/// Tools of any direction.
std::vector<Collision> find_tilted_collisions(const machine::Job& job, const SimulatedProgram& program,
                                              const removal::Stock& blank);

}  // namespace camber::simulate
