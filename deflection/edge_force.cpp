#include "deflection/edge_force.h"

#include <algorithm>

#include "machine/force_law.h"

namespace camber::deflection {

using machine::Components;
using machine::Material;

EdgeForce edge_force(const Material& m, double h, double db, double edge_ramp_mm) {
  if (h <= 0) return {};
  const double edge = h < edge_ramp_mm ? h / edge_ramp_mm : 1.0;
  return machine::with_law(m.law, [&](auto law) -> EdgeForce {
    const Components k = law.specific_MPa(m, std::max(h, edge_ramp_mm));
    return {(k.tangential * h + edge * m.kte_N_per_mm) * db, (k.radial * h + edge * m.kre_N_per_mm) * db,
            (k.axial * h + edge * m.kae_N_per_mm) * db};
  });
}

EdgeForce edge_force_slope(const Material& m, double h, double edge_ramp_mm) {
  if (h <= 0) return {};
  constexpr double kMin_mm = 1e-3;
  const bool chord = h < edge_ramp_mm;
  const double at = std::max({h, edge_ramp_mm, kMin_mm});
  const Components k =
      machine::with_law(m.law, [&](auto law) { return chord ? law.specific_MPa(m, at) : law.slope_MPa(m, at); });
  EdgeForce slope{k.tangential, k.radial, k.axial};
  if (chord) {
    slope.tangential_N += m.kte_N_per_mm / edge_ramp_mm;
    slope.radial_N += m.kre_N_per_mm / edge_ramp_mm;
    slope.axial_N += m.kae_N_per_mm / edge_ramp_mm;
  }
  return slope;
}

}  // namespace camber::deflection
