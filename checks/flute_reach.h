#pragma once
// Checks for material above the flutes or above the holder face, which would be cut without a force.
#include "base/diagnostics.h"
#include "checks/height_survey.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/stock.h"

namespace camber::checks {

/// Errors [cut-above-flutes] and [cut-above-overhang] at the blocks in which the cutter's cylinder meets material, by
/// more than a voxel, above the flutes' end (flute_length_mm; without it overhang_mm). The undeflected cutter is swept
/// through a copy of the blank, up to the last place at which what is above the flutes meets the whole blank; where it
/// meets it nowhere, nothing is swept.
void check_flute_reach(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                       Diagnostics& diagnostics);
/// The same of cuts that are found already.
void report_above_flutes(const machine::Job& job, const motion::SimulatedProgram& program,
                         const std::vector<CutAboveFlutes>& found, Diagnostics& diagnostics);

}  // namespace camber::checks
