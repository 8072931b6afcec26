#include "removal/rounded_distance.h"

#include <algorithm>
#include <cmath>

#include "removal/vector_clones.h"

namespace camber::removal {

CAMBER_VECTOR_CLONES
void rounded_distances(const float* x, const float* y, const float* z, std::size_t count, float px, float py, float pz,
                       float flat, float corner, float* __restrict out) {
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = px - x[k], dy = py - y[k];
    const float qx = std::sqrt(dx * dx + dy * dy) - flat, qz = corner - (pz - z[k]);
    const float a = std::max(qx, 0.0f), b = std::max(qz, 0.0f);
    out[k] = std::min(std::max(qx, qz), 0.0f) + std::sqrt(a * a + b * b) - corner;
  }
}

CAMBER_VECTOR_CLONES
void rounded_distances_to(const float* x, const float* y, const float* z, std::size_t count, const Disc& disc,
                          float flat, float corner, float* __restrict out) {
  constexpr float kTiny = 1e-6f;
  const float px = disc.centre[0], py = disc.centre[1], pz = disc.centre[2];
  const float nx = disc.normal[0], ny = disc.normal[1], nz = disc.normal[2];
  const float across = disc.across, thick = disc.thick;
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = px - x[k], dy = py - y[k];
    const float rho = std::sqrt(dx * dx + dy * dy);
    const float qx = rho - flat, qz = corner - (pz - z[k]);
    const float a = std::max(qx, 0.0f), b = std::max(qz, 0.0f), length = std::sqrt(a * a + b * b);
    const float distance = std::min(std::max(qx, qz), 0.0f) + length - corner;
    // Inside, the nearer of wall and bottom.
    const bool outside = length > kTiny;
    const float per_length = 1 / std::max(length, kTiny);
    const float radial = outside ? a * per_length : qx > qz ? 1.0f : 0.0f;
    const float down = outside ? b * per_length : qx > qz ? 0.0f : 1.0f;
    const float along = radial * (dx * nx + dy * ny) / std::max(rho, kTiny) - down * nz;
    out[k] = distance - thick * std::abs(along) - across * std::sqrt(std::max(1 - along * along, 0.0f));
  }
}

}  // namespace camber::removal
