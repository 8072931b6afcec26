#pragma once
// Chooses the round whose program is emitted.
#include <cstddef>
#include <span>

namespace camber::compensate {

struct RoundFigures {
  double rms_um = 0, p95_um = 0;  ///< judged error
  double depth_um = 0;            ///< gouge depth of 99.9 % of the surface
  bool over_budget = false;       ///< takes more machine time than is allowed
  double worse_um = 0;            ///< WorsePlaces::p999_um
};

/// Returns the index of the best round that keeps the limits; 0, the given program, where none does. A round keeps them
/// if its rms is less and its 95th percentile no more than the given program's, and its depth no more than the limit or
/// the given program's, within the time allowed. Of these the ones within the limit come first, then the one of least
/// rms, or of the least 95th percentile where `by_p95` (the feed lever works on that). Of two that differ by less
/// than a tenth in it the one that makes less worse than given (worse_um).
std::size_t choose_round(std::span<const RoundFigures> rounds, double depth_limit_um, bool by_p95 = false);

}  // namespace camber::compensate
