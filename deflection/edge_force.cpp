#include "deflection/edge_force.h"

namespace camber::deflection {

EdgeForce edge_force(const machine::Material& m, double h, double db) {
  if (h <= 0) return {};
  return {(m.ktc_MPa * h + m.kte_N_per_mm) * db, (m.krc_MPa * h + m.kre_N_per_mm) * db,
          (m.kac_MPa * h + m.kae_N_per_mm) * db};
}

}  // namespace camber::deflection
