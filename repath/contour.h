#pragma once
// What a machine makes of a path: how long it takes and how far it strays from the one that was meant.
#include "feedmodel/timed_path.h"
#include "machine/machine.h"
#include "nc/interpreter.h"

namespace camber::repath {

struct ContourFigures {
  double time_s = 0;  ///< of the whole program
  double cutting_time_s = 0;
  double contour_max_mm = 0;  ///< distance of the predicted axes from the path that was meant, while cutting
  double contour_rms_mm = 0;  ///< over time
};

/// Predicts `program` on the machine, against the moves of `meant` (which may be the same). Both have the same chains
/// of cutting moves, one after another; the nearest point is looked for along the chain, no farther than a few
/// millimetres ahead.
ContourFigures contour_figures(const nc::Interpretation& program, const nc::Interpretation& meant,
                               const machine::Machine& machine);

}  // namespace camber::repath
