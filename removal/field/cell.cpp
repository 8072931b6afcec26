#include "removal/field/cell.h"

namespace camber::removal {

Vec3 trilinear_gradient(const float* lowest, const CellShare& f, double voxel_mm) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 8; ++c) {
      float face = c >> a & 1 ? 1.0f : -1.0f;
      for (int b = 0; b < 3; ++b) {
        const float share = f[static_cast<std::size_t>(b)];
        if (b != a) face *= c >> b & 1 ? share : 1 - share;
      }
      sum[a] += static_cast<double>(face * lowest[cell_corner(c)]);
    }
  return sum / voxel_mm;
}

}  // namespace camber::removal
