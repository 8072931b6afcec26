#pragma once
// Makes the stock an obstacle, as the tool that is to be tilted finds it.
#include <cstddef>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program.h"
#include "posture/surroundings.h"

namespace camber::posture {

/// Adds the job's stock as it stands before the move `first`: without what the moves before it cut, and with its
/// allowance cut by the whole program. A box, a cylinder and a mesh of which nothing is cut are added as they are (the
/// cylinder as the prism of 48 faces about it); everything else as the faces of voxels, which stand out of the stock by
/// up to 0.7 kStockCell_mm and nowhere back from it (parts of more than about 0.3 m: wider faces). Without [stock]:
/// nothing. Throws InputError: what simulate_motion() and the readers of the stock say.
inline constexpr double kStockCell_mm = 0.5;
void add_stock(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves, std::size_t first,
               Surroundings& out, Diagnostics& diagnostics);

}  // namespace camber::posture
