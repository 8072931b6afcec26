#pragma once
// Contour error: the effect of servo lag and corner rounding on the surface, without deflection.
#include "simulate/predict.h"
#include "simulate/section_pieces.h"

namespace camber::simulate {

/// Sets contour_mm and unseen_mm2 of a target: the undeflected sweep of its program as the machine runs it (`path`),
/// minus the nominal surface, along the nominal surface's normal at the points of Target::map.
void mark_contour(const machine::Job& job, const removal::StampPath& path, Target& target);

/// Marks the stamps of a piece on a map.
void mark_contour_of(const machine::Job& job, const PathStretch& path, const PathPiece& piece,
                     removal::SurfaceMap& map);

}  // namespace camber::simulate
