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

}  // namespace camber::removal
