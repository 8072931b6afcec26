#pragma once
// A rewritten program against the given one, by dense sampling: what the bounds of post() are held to.
#include "machine/machine.h"
#include "nc/move.h"
#include "repath/post.h"

namespace camber::repath {

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
