#pragma once
// Force on the tool from one edge element, by the material's force law.
#include <algorithm>

#include "machine/force_law.h"
#include "machine/material.h"

namespace camber::deflection {

/// Components along the motion of the edge, the outward normal of the envelope and the meridian that points up and
/// outward, acting on the work; the force on the tool is the opposite. N.
struct EdgeForce {
  double tangential_N = 0, radial_N = 0, axial_N = 0;
};

/// Returns the force of an edge element: dF_t = (k_t(h) h + K_te) db, likewise radial and axial, with k(h) of the
/// material's law (machine/force_laws). [N] = ([MPa][mm] + [N/mm])[mm] Source of the directions on a general cutter:
/// Engin & Altintas 2001. chip_thickness_mm: uncut, along the normal; zero or less means in air, and the force is zero.
/// edge_ramp_mm > 0: below this thickness the force (cutting and edge terms) is the chord from zero. Without it the
/// slope of a law may be unbounded at zero, as Kienzle's is, and a tool that the edge force alone can push out of the
/// cut has no equilibrium with a force that jumps.
inline EdgeForce edge_force(const machine::Material& material, double chip_thickness_mm, double chip_width_mm,
                            double edge_ramp_mm = 0) {
  const double h = chip_thickness_mm, db = chip_width_mm;
  if (h <= 0) return {};
  const double edge = h < edge_ramp_mm ? h / edge_ramp_mm : 1.0;
  return machine::with_law(material.law, [&](auto law) -> EdgeForce {
    const machine::Components k = law.specific_MPa(material, std::max(h, edge_ramp_mm));
    return {(k.tangential * h + edge * material.kte_N_per_mm) * db, (k.radial * h + edge * material.kre_N_per_mm) * db,
            (k.axial * h + edge * material.kae_N_per_mm) * db};
  });
}

/// Returns the derivative of edge_force by the chip thickness, per width of edge, MPa (in the fields named N). Zero in
/// air. The thickness counts as at least the ramp, or a micrometre without one.
inline EdgeForce edge_force_slope(const machine::Material& material, double chip_thickness_mm,
                                  double edge_ramp_mm = 0) {
  const double h = chip_thickness_mm;
  if (h <= 0) return {};
  constexpr double kMin_mm = 1e-3;
  const bool chord = h < edge_ramp_mm;
  const double at = std::max({h, edge_ramp_mm, kMin_mm});
  const machine::Components k = machine::with_law(
      material.law, [&](auto law) { return chord ? law.specific_MPa(material, at) : law.slope_MPa(material, at); });
  EdgeForce slope{k.tangential, k.radial, k.axial};
  if (chord) {
    slope.tangential_N += material.kte_N_per_mm / edge_ramp_mm;
    slope.radial_N += material.kre_N_per_mm / edge_ramp_mm;
    slope.axial_N += material.kae_N_per_mm / edge_ramp_mm;
  }
  return slope;
}

}  // namespace camber::deflection
