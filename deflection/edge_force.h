#pragma once
// Force on the tool from one edge element.
#include "machine/job.h"

namespace camber::deflection {

/// Components along the edge's motion, the envelope's outward normal and the meridian that points up and
/// outward, as the work feels them; the tool feels the opposite. N.
struct EdgeForce {
  double tangential_N = 0, radial_N = 0, axial_N = 0;
};

/// Linear edge model:   dF_t = (K_tc h + K_te) db, likewise radial and axial.     [N] = ([MPa][mm] + [N/mm])[mm]
/// Kienzle:             dF_t = (k_c1.1 h^(1 - m_c) + K_te) db, likewise with k_r1.1, m_r and k_a1.1, m_a.
/// Sources: Altintas, Manufacturing Automation, 2nd ed., ch. 2; directions on a general cutter: Engin & Altintas
/// 2001; Kienzle 1952. chip_thickness_mm: uncut, along the normal; zero or less means in air, and the force is zero.
/// edge_ramp_mm > 0: below this thickness the edge terms grow from zero in a straight line, and so does Kienzle's
/// force, whose slope grows without bound at zero (a tool that the edge force alone can push out of the cut has no
/// equilibrium with a force that jumps).
EdgeForce edge_force(const machine::Material& material, double chip_thickness_mm, double chip_width_mm,
                     double edge_ramp_mm = 0);

/// Its derivative by the chip thickness, per width of edge, MPa (as if N). Zero in air. With Kienzle the thickness
/// counts as at least the ramp, or a micrometre without one.
EdgeForce edge_force_slope(const machine::Material& material, double chip_thickness_mm, double edge_ramp_mm = 0);

}  // namespace camber::deflection
