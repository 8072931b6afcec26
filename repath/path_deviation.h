#pragma once
// Deviation of a rewritten path from the old one, by points laid densely on both.
#include <span>
#include <vector>

#include "nc/interpreter.h"
#include "repath/compress.h"

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

}  // namespace camber::repath
