#pragma once
// Checks of a job and its program before the simulation.
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "removal/tool_path.h"

namespace camber::motion {

/// Errors at the program's blocks: [nothing-to-cut], [tool-missing], [tool-type], [spindle-stopped],
/// [spindle-direction]; warnings: [tooth-frequency] (the tooth passing frequency exceeds a third of the tool's
/// first natural frequency, above which a static deflection is no longer valid; milling only), [cycle-not-carved] (a
/// cycle whose holes are not carved).
void check_cutting(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                   const std::vector<bool>& selected, const std::vector<removal::HoleMove>& holes,
                   Diagnostics& diagnostics);

/// A program with S and an M function of the machine's maker, but neither M3 nor M4: the spindle turns clockwise, with
/// a warning [spindle-assumed]. One without S as well, as for machines whose spindle is set by hand: each tool gets the
/// speed at which its greatest feed cuts chips of 0.6 % of its diameter (0.02 to 0.1 mm) a tooth, 1000 to 12000 rpm,
/// likewise.
void assume_spindle(const machine::Job& job, const nc::Program& program, nc::Interpretation& moves,
                    Diagnostics& diagnostics);

}  // namespace camber::motion
