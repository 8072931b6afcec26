#pragma once
// A chain whose kinks are at most FitOptions::max_kink_rad.
#include <vector>

#include "repath/fit.h"

namespace camber::repath {

/// Around joints that kink more than they may the primitives beside them are laid out anew, as few as possible: every
/// chain whose ends are among points that lie evenly along the old primitives, with the sweeps that each arc may have
/// as intervals, so that a chain is given up only where no choice of sweeps keeps the bound. Where that finds none the
/// stretch grows and the points lie closer; what is left after that becomes the blocks as they were, which kink as the
/// path does. Does nothing where kinks are not bounded. Time grows linearly with the number of primitives.
void smooth_joints(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain);

}  // namespace camber::repath
