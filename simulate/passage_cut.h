#pragma once
// The cut of a tooth passing as one arc, and the stability of a tool at a speed. Private to the chatter files.
#include <vector>

#include "dynamics/stability_table.h"
#include "machine/job_file.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

struct PassageCut {
  dynamics::ArcCut cut;
  double depth_mm = 0;
};

/// False in air, and where the chips are too thin to count.
bool cuts(const StampLoad& load);
/// Requires cuts(load).
PassageCut passage_cut(const StampLoad& load, const machine::Material& material);

/// Returns the table of a tool's modes, with those of the work where the tool is upright.
dynamics::StabilityTable stability_table(const machine::Job& job, const machine::Tool& tool,
                                         std::vector<machine::Mode> modes, double speed_rpm, bool upright);

}  // namespace camber::simulate
