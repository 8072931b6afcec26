#include "removal/simd/upright_distances.h"

#include <algorithm>
#include <cmath>

#include "base/vector_clones.h"
#include "removal/field/rounded_cutter.h"

namespace camber::removal::upright {

CAMBER_VECTOR_CLONES
void rounded_distances(const float* x, const float* y, const float* z, std::size_t count, float px, float py, float pz,
                       float flat, float corner, float* __restrict out) {
  const RoundedCutter<float> cutter{flat, corner};
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = px - x[k], dy = py - y[k];
    out[k] = cutter.distance(std::sqrt(dx * dx + dy * dy), pz - z[k]);
  }
}

CAMBER_VECTOR_CLONES
void rounded_distances_to(const float* x, const float* y, const float* z, std::size_t count, const Disc& disc,
                          float flat, float corner, float* __restrict out) {
  constexpr float kTiny = 1e-6f;
  const float px = disc.centre[0], py = disc.centre[1], pz = disc.centre[2];
  const float nx = disc.normal[0], ny = disc.normal[1], nz = disc.normal[2];
  const RoundedCutter<float> cutter{flat, corner};
  const float across = disc.across, thick = disc.thick;
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = px - x[k], dy = py - y[k];
    const float rho = std::sqrt(dx * dx + dy * dy);
    const auto place = cutter.place(rho, pz - z[k]);
    const auto normal = cutter.normal(place);
    const float along = normal.radial * (dx * nx + dy * ny) / std::max(rho, kTiny) - normal.down * nz;
    out[k] = place.distance - thick * std::abs(along) - across * std::sqrt(std::max(1 - along * along, 0.0f));
  }
}

}  // namespace camber::removal::upright
