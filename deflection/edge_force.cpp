#include "deflection/edge_force.h"

#include <algorithm>
#include <cmath>

namespace camber::deflection {
namespace {

using machine::ForceLaw;
using machine::Material;

/// k h^(1-m), below the ramp the chord from zero.
double kienzle_N_per_mm(double k, double m, double h, double ramp_mm) {
  return k * h * std::pow(std::max(h, ramp_mm), -m);
}

double kienzle_slope(double k, double m, double h, double ramp_mm) {
  if (h < ramp_mm) return k * std::pow(ramp_mm, -m);
  constexpr double kLeast_mm = 1e-3;
  return k * (1 - m) * std::pow(std::max(h, kLeast_mm), -m);
}

}  // namespace

EdgeForce edge_force(const Material& m, double h, double db, double edge_ramp_mm) {
  if (h <= 0) return {};
  const double edge = h < edge_ramp_mm ? h / edge_ramp_mm : 1.0;
  if (m.law == ForceLaw::kienzle)
    return {(kienzle_N_per_mm(m.kc1_1_MPa, m.mc, h, edge_ramp_mm) + edge * m.kte_N_per_mm) * db,
            (kienzle_N_per_mm(m.kr1_1_MPa, m.mr, h, edge_ramp_mm) + edge * m.kre_N_per_mm) * db,
            (kienzle_N_per_mm(m.ka1_1_MPa, m.ma, h, edge_ramp_mm) + edge * m.kae_N_per_mm) * db};
  return {(m.ktc_MPa * h + edge * m.kte_N_per_mm) * db, (m.krc_MPa * h + edge * m.kre_N_per_mm) * db,
          (m.kac_MPa * h + edge * m.kae_N_per_mm) * db};
}

EdgeForce edge_force_slope(const Material& m, double h, double edge_ramp_mm) {
  if (h <= 0) return {};
  EdgeForce slope{m.ktc_MPa, m.krc_MPa, m.kac_MPa};
  if (m.law == ForceLaw::kienzle)
    slope = {kienzle_slope(m.kc1_1_MPa, m.mc, h, edge_ramp_mm), kienzle_slope(m.kr1_1_MPa, m.mr, h, edge_ramp_mm),
             kienzle_slope(m.ka1_1_MPa, m.ma, h, edge_ramp_mm)};
  if (h < edge_ramp_mm) {
    slope.tangential_N += m.kte_N_per_mm / edge_ramp_mm;
    slope.radial_N += m.kre_N_per_mm / edge_ramp_mm;
    slope.axial_N += m.kae_N_per_mm / edge_ramp_mm;
  }
  return slope;
}

}  // namespace camber::deflection
