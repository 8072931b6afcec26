#pragma once
// Passes over a chain of lines and arcs: fewer and shorter lines, smoother joints.
#include <vector>

#include "repath/compress/fit.h"

namespace camber::repath {

/// Around each line the primitives beside it, up to the next corners (or `corners` as ends_of says) and as long as they
/// are no more than a few dozen points, are laid out anew: every chain between the same two ends is tried, and the one
/// with the fewest primitives, among these the one with the shortest lines, is taken. For shorter lines alone nothing
/// may lie farther from the points than before. And where a chain of as many lies within a quarter of the tolerance, it
/// is taken: a line and an arc as they were drawn. Controls that are slow on lines gain. Time grows linearly with the
/// number of primitives.
void shorten_lines(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain);

// A chain whose kinks are at most FitOptions::max_kink_rad.

/// Around joints that kink more than they may the primitives beside them are laid out anew, as few as possible: every
/// chain whose ends are among points that lie evenly along the old primitives, with the sweeps that each arc may have
/// as intervals, so that a chain is given up only where no choice of sweeps keeps the bound. Where that finds none the
/// stretch grows and the points lie closer; what is left after that becomes the blocks as they were, which kink as the
/// path does. Does nothing where kinks are not bounded. Time grows linearly with the number of primitives.
void smooth_joints(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain);

// For controls that run arcs faster than lines: more arcs where they spare enough of the lines.

/// Around each line the primitives beside it, up to the next corners, are laid out anew: every chain between the same
/// two ends (of long ones every chain whose ends are among points that lie evenly along them), the one with the least
/// sum of primitives and FitOptions::primitives_per_line_mm times the length of lines. Kinks keep to their bound.
///
/// What is straight stays a line: several blocks that are straight to an increment; and a line that at least
/// arc_points points lie along, but where up to three primitives lie four times as near to them as the line does. A
/// row that is noise is a line, a bow or an S of many points is not. Where lines and arcs lie within a quarter of the
/// tolerance, as they were drawn, nothing is changed. Time grows linearly with the number of primitives.
void spare_lines(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                 const std::vector<bool>& corners, std::vector<Primitive>& chain);

}  // namespace camber::repath
