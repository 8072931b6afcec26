#pragma once
// Force on the tool from one edge element.
#include "machine/job.h"

namespace camber::deflection {

/// Components along the motion of the edge, the outward normal of the envelope and the meridian that points up and
/// outward, acting on the work; the force on the tool is the opposite. N.
struct EdgeForce {
  double tangential_N = 0, radial_N = 0, axial_N = 0;
};

/// dF_t = (k_t(h) h + K_te) db, likewise radial and axial, with k(h) of the material's law (machine/force_laws).
/// [N] = ([MPa][mm] + [N/mm])[mm]
/// Source of the directions on a general cutter: Engin & Altintas 2001. chip_thickness_mm: uncut, along the normal;
/// zero or less means in air, and the force is zero.
/// edge_ramp_mm > 0: below this thickness the force (cutting and edge terms) is the chord from zero. Without it the
/// slope of a law may be unbounded at zero, as Kienzle's is, and a tool that the edge force alone can push out of the
/// cut has no equilibrium with a force that jumps.
EdgeForce edge_force(const machine::Material& material, double chip_thickness_mm, double chip_width_mm,
                     double edge_ramp_mm = 0);

/// Its derivative by the chip thickness, per width of edge, MPa (as if N). Zero in air. The thickness counts as at
/// least the ramp, or a micrometre without one.
EdgeForce edge_force_slope(const machine::Material& material, double chip_thickness_mm, double edge_ramp_mm = 0);

}  // namespace camber::deflection
