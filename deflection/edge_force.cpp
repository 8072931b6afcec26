#include "deflection/edge_force.h"

#include <algorithm>
#include <cmath>

namespace camber::deflection {
namespace {

using machine::ForceLaw;
using machine::Material;

/// k h^-m of the three components; below the ramp k stays as at the ramp. Equal exponents are worked out once.
EdgeForce kienzle_MPa(const Material& m, double h) {
  const double tangential = std::pow(h, -m.mc);
  const double radial = m.mr == m.mc ? tangential : std::pow(h, -m.mr);
  const double axial = m.ma == m.mc ? tangential : m.ka1_1_MPa == 0 ? 0 : std::pow(h, -m.ma);
  return {m.kc1_1_MPa * tangential, m.kr1_1_MPa * radial, m.ka1_1_MPa * axial};
}

}  // namespace

EdgeForce edge_force(const Material& m, double h, double db, double edge_ramp_mm) {
  if (h <= 0) return {};
  const double edge = h < edge_ramp_mm ? h / edge_ramp_mm : 1.0;
  if (m.law == ForceLaw::kienzle) {
    const EdgeForce k = kienzle_MPa(m, std::max(h, edge_ramp_mm));
    return {(k.tangential_N * h + edge * m.kte_N_per_mm) * db, (k.radial_N * h + edge * m.kre_N_per_mm) * db,
            (k.axial_N * h + edge * m.kae_N_per_mm) * db};
  }
  return {(m.ktc_MPa * h + edge * m.kte_N_per_mm) * db, (m.krc_MPa * h + edge * m.kre_N_per_mm) * db,
          (m.kac_MPa * h + edge * m.kae_N_per_mm) * db};
}

EdgeForce edge_force_slope(const Material& m, double h, double edge_ramp_mm) {
  if (h <= 0) return {};
  EdgeForce slope{m.ktc_MPa, m.krc_MPa, m.kac_MPa};
  if (m.law == ForceLaw::kienzle) {
    constexpr double kLeast_mm = 1e-3;
    const bool chord = h < edge_ramp_mm;
    slope = kienzle_MPa(m, std::max({h, edge_ramp_mm, kLeast_mm}));
    if (!chord) {
      slope.tangential_N *= 1 - m.mc;
      slope.radial_N *= 1 - m.mr;
      slope.axial_N *= 1 - m.ma;
    }
  }
  if (h < edge_ramp_mm) {
    slope.tangential_N += m.kte_N_per_mm / edge_ramp_mm;
    slope.radial_N += m.kre_N_per_mm / edge_ramp_mm;
    slope.axial_N += m.kae_N_per_mm / edge_ramp_mm;
  }
  return slope;
}

}  // namespace camber::deflection
