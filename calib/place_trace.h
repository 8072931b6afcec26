#pragma once
// Places of a trace on the path of its program, by geometry: for traces that do not name their lines, and for pieces of
// a run that begin and end in motion.
#include <functional>
#include <optional>
#include <vector>

#include "calib/stretch.h"
#include "calib/trace.h"
#include "feedmodel/path_tracker.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::calib {

struct PlacedTrace {
  std::vector<feedmodel::PathPlace> place;  ///< of each sample; places never go back
  Vec3 offset_mm = Vec3::Zero();            ///< added to the positions of the trace
  double off_path_p95_mm = 0;               ///< beside what axes that lag cut off corners
};

/// The trace may begin and end anywhere in the program. Where the axes begin follows from the samples that come after:
/// of all places near the first one that moves, the one from which they follow the path best. Positions that are
/// nowhere near the path are shifted by a constant first, so that the extents agree (a work offset that the program
/// does not name). Requires X, Y and Z, commanded or actual.
///
/// Nothing where a twentieth of the samples stays 0.5 mm or more off the path.
std::optional<PlacedTrace> place_on_path(const ServoTrace& trace, const nc::Interpretation& program);

/// Names the line of each sample (0 at rests) from its place.
void set_lines(ServoTrace& trace, const nc::Interpretation& program, const PlacedTrace& placed);

struct PlacingOptions {
  double piece_s = 1;      ///< least time of a piece; a shorter run is one piece
  double end_sigma_s = 0;  ///< how well the log itself tells the time of a sample
};

/// Times of pieces of feed motion, from one sample to a later one: the place of a sample is known far better than when
/// a line ends between two of them. For traces whose samples are too few to show ramps. `override_between`: the
/// override between two times, nothing: not usable; empty: 100 % throughout.
std::vector<TimedStretch> placed_stretches(
    const ServoTrace& trace, const nc::Interpretation& program, const PlacedTrace& placed,
    const PlacingOptions& options,
    const std::function<std::optional<double>(double from_s, double to_s)>& override_between = {});

}  // namespace camber::calib
