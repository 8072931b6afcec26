#pragma once
// Of the chains with as few primitives the one with the shortest lines.
#include <vector>

#include "repath/fit.h"

namespace camber::repath {

/// Around each line the primitives beside it, up to the next corners (or `corners` as ends_of says) and as long as they
/// are no more than a few dozen points, are laid out anew: every chain between the same two ends is tried, and the one
/// with the fewest primitives, among these the one with the shortest lines, is taken. For shorter lines alone nothing
/// may lie farther from the points than before. And where a chain of as many lies within a quarter of the tolerance, it
/// is taken: a line and an arc as they were drawn. Controls that are slow on lines gain. Time grows linearly with the
/// number of primitives.
void shorten_lines(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain);

}  // namespace camber::repath
