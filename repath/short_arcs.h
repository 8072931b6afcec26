#pragma once
// Selection of the arcs of a run that are rewritten together with the neighbouring lines.
#include <vector>

#include "repath/resegment.h"

namespace camber::repath {

/// Zeroes: every arc stays.
struct ShortArcRule {
  double length_mm = 0;     ///< of the segments to be laid
  double tolerance_mm = 0;  ///< a chord of sqrt(8 r t) leaves a curve of radius r by t
};

/// The stretches of a run between arcs that stay. An arc is laid out again where it is shorter than the segment that
/// would be laid on it, the length or the chord within the tolerance, and goes on smoothly (20 degrees) into a block of
/// the run that is short too. Otherwise one block is best, and the arc stays. A stretch does not end on an arc whose
/// mode (G2, G3) the text behind relies on. Stretches of one block are left out.
std::vector<BlockRun> between_arcs(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                                   const ShortArcRule& rule);

}  // namespace camber::repath
