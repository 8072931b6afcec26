#include "deflection/edge_force.h"

namespace camber::deflection {

EdgeForce edge_force(const machine::Material& m, double h, double db, double edge_ramp_mm) {
  if (h <= 0) return {};
  const double edge = h < edge_ramp_mm ? h / edge_ramp_mm : 1.0;
  return {(m.ktc_MPa * h + edge * m.kte_N_per_mm) * db, (m.krc_MPa * h + edge * m.kre_N_per_mm) * db,
          (m.kac_MPa * h + edge * m.kae_N_per_mm) * db};
}

}  // namespace camber::deflection
