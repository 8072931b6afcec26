#pragma once
// Force on the tool from one edge element.
#include "machine/job.h"

namespace camber::deflection {

/// Components along the edge's motion, the envelope's outward normal and the meridian that points up and
/// outward, as the work feels them; the tool feels the opposite. N.
struct EdgeForce {
  double tangential_N = 0, radial_N = 0, axial_N = 0;
};

/// dF_t = (k_t(h) h + K_te) db, likewise radial and axial, with k(h) of the material's law (machine/force_laws).
/// [N] = ([MPa][mm] + [N/mm])[mm]
/// Source of the directions on a general cutter: Engin & Altintas 2001. chip_thickness_mm: uncut, along the normal;
/// zero or less means in air, and the force is zero.
/// edge_ramp_mm > 0: below this thickness the force is the chord from zero, the edge terms' as well as the law's, whose
/// slope may grow without bound at zero as Kienzle's does (a tool that the edge force alone can push out of the cut has
/// no equilibrium with a force that jumps).
EdgeForce edge_force(const machine::Material& material, double chip_thickness_mm, double chip_width_mm,
                     double edge_ramp_mm = 0);

/// Its derivative by the chip thickness, per width of edge, MPa (as if N). Zero in air. The thickness counts as at
/// least the ramp, or a micrometre without one.
EdgeForce edge_force_slope(const machine::Material& material, double chip_thickness_mm, double edge_ramp_mm = 0);

}  // namespace camber::deflection
