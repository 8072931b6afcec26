#pragma once
// Deviation of a rewritten path from the old one, by points laid densely on both.
#include <span>
#include <vector>

#include "machine/machine_model.h"
#include "nc/interpreter.h"
#include "nc/move.h"
#include "repath/compress/compression.h"
#include "repath/post/post_processing.h"

namespace camber::repath {

struct DeviationFigures {
  double max_mm = 0;                           ///< both ways, over the rewritten runs
  Vec3 worst_place_mm = Vec3::Zero();          ///< where that is
  double limit_mm = 0;                         ///< of the histogram
  std::vector<double> length_by_deviation_mm;  ///< length of the new path in bins of its distance from 0 to limit_mm
  double length_mm = 0;                        ///< of the new path in the rewritten runs
};

/// Independent of the fitters. Points of the new path, at most half of the old blocks' mean length
/// apart, against the old one, and ends and middles of the old blocks against the new one, whose arcs are chords with a
/// sagitta of at most a five hundredth of the tolerance: figures are right to within that. The nearest point is looked
/// for along the way, a few steps ahead of the one before. Linear in the number of blocks.
DeviationFigures measure_deviation(const nc::Interpretation& before, const nc::Interpretation& after,
                                   std::span<const RewrittenRun> runs, double tolerance_mm);

// A rewritten program against the given one, by dense sampling: what the bounds of post() are held to.

struct PostDeviation {
  double tip_mm = 0, rapid_tip_mm = 0;  ///< in feed moves, in rapids
  double axis_rad = 0;
  double end_tip_mm = 0, end_axis_rad = 0;  ///< at the ends of the given moves
  std::size_t samples = 0;
};

/// Poses of the given program at `per_piece` + 1 places of each piece against those of the rewritten one. Requires
/// `after`: the interpretation of posted.text.
PostDeviation post_deviation(const nc::Interpretation& before, const nc::Interpretation& after,
                             const machine::Machine& machine, const Posted& posted, int per_piece);

}  // namespace camber::repath
