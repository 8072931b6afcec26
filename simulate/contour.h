#pragma once
// Contour error: the effect of servo lag and corner rounding on the surface, without deflection.
#include "motion/path_stretch.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// Sets contour_mm and unseen_mm2 of a target: the undeflected sweep of its program as the machine runs it (`path`),
/// minus the nominal surface, along the nominal surface's normal at the points of Target::map.
void mark_contour(const machine::Job& job, const removal::StampPath& path, Target& target);

/// Takes the contour error apart by its causes, where its 95th percentile is kWorthParting_um or more and no rotary
/// axis turns (Target::contour_parts). The machine is timed twice more:
///
///   lag             with an exact stop after every block and no merging: what the axes' lag and filters do to the path
///   path tolerance  with axes that follow the plan: what blending and merging do (G64 P, corner tolerance_mm)
///   corner law      the rest: corners that are passed without a stop, by axes that lag
void part_contour(const machine::Job& job, const SimulatedProgram& program, Target& target);
inline constexpr double kWorthParting_um = 1;

/// Marks the stamps of a piece on a map.
void mark_contour_of(const machine::Job& job, const motion::PathStretch& path, const motion::StretchPiece& piece,
                     removal::SurfaceMap& map);

}  // namespace camber::simulate
