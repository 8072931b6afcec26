#pragma once
// For controls that run arcs faster than lines: more arcs where they spare enough of the lines.
#include <vector>

#include "repath/fit.h"

namespace camber::repath {

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
