#pragma once
// Checks of a job and its program before the simulation.
#include <vector>

#include "base/diagnostics.h"
#include "machine/job.h"
#include "nc/move.h"
#include "nc/program.h"
#include "removal/tool_path.h"

namespace camber::simulate {

/// Errors at the program's blocks: [nothing-to-cut], [tool-missing], [tool-type], [spindle-stopped],
/// [spindle-direction]; warnings: [tooth-frequency] (the tooth passing frequency exceeds a third of the tool's
/// first natural frequency, above which a static deflection is no longer valid; milling only), [cycle-not-carved] (a
/// cycle whose holes are not carved).
void check_cutting(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                   const std::vector<bool>& selected, const std::vector<removal::HoleMove>& holes,
                   Diagnostics& diagnostics);

/// Error [voxel-memory] when the fields of the job would need more memory than is free; says how much.
void check_memory(const machine::Job& job, const Vec3& min_mm, const Vec3& max_mm, double band_voxels,
                  Diagnostics& diagnostics);

/// Bytes that the distance fields of a box of stock take, all copies together.
double field_bytes(const Vec3& size_mm, double voxel_mm, double band_voxels);

}  // namespace camber::simulate
