#pragma once
// Checks of a job and its program before the simulation.
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program.h"
#include "removal/tool_path.h"

namespace camber::motion {

/// Errors at the program's blocks: [nothing-to-cut], [tool-missing], [tool-type], [spindle-stopped],
/// [spindle-direction]; warnings: [tooth-frequency] (the tooth passing frequency exceeds a third of the tool's
/// first natural frequency, above which a static deflection is no longer valid; milling only), [cycle-not-carved] (a
/// cycle whose holes are not carved).
void check_cutting(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                   const std::vector<bool>& selected, const std::vector<removal::HoleMove>& holes,
                   Diagnostics& diagnostics);

}  // namespace camber::motion
