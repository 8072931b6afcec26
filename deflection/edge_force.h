#pragma once
// Force on the tool from one edge element.
#include "machine/job.h"

namespace camber::deflection {

/// Components along the edge's motion, the envelope's outward normal and the meridian that points up and
/// outward, as the work feels them; the tool feels the opposite. N.
struct EdgeForce {
  double tangential_N = 0, radial_N = 0, axial_N = 0;
};

/// dF_t = (K_tc h + K_te) db, likewise radial and axial.      [N] = ([MPa][mm] + [N/mm])[mm]
/// Source: Altintas, Manufacturing Automation, 2nd ed., ch. 2; directions on a general cutter: Engin & Altintas
/// 2001. chip_thickness_mm: uncut, along the normal; zero or less means in air, and the force is zero.
/// edge_ramp_mm > 0: the edge terms grow from zero to their full value over this thickness (a tool that the edge
/// force alone can push out of the cut has no equilibrium with a force that jumps).
EdgeForce edge_force(const machine::Material& material, double chip_thickness_mm, double chip_width_mm,
                     double edge_ramp_mm = 0);

}  // namespace camber::deflection
