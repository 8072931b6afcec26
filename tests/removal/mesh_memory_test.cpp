#include "removal/field/mesh_memory.h"

#include <gtest/gtest.h>

namespace camber::removal {
namespace {

/// A square of this side.
TriangleMesh square(float side) {
  TriangleMesh out;
  out.points = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
  out.triangles = {{0, 1, 2}, {0, 2, 3}};
  return out;
}

TEST(MeshMemory, IsAskedBeforeAnythingIsBuilt) {
  EXPECT_DOUBLE_EQ(surface_mm2(square(300)), 90000);
  try {
    require_mesh_memory("part.stl", square(300), 0.1, 1.0, 1e9);
    ADD_FAILURE() << "was not refused";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "part.stl: error: voxel_mm = 0.1 needs about 3.0 GB for a mesh with a surface of 90000 mm2, but 1.0 "
                 "GB are free; voxel_mm = 0.31 or a smaller mesh was expected [voxel-memory]");
  }
  EXPECT_NO_THROW(require_mesh_memory("part.stl", square(300), 0.1, 1.0, 4e9));
  EXPECT_NO_THROW(require_mesh_memory("part.stl", square(300), 0.31, 3.1, 1e9));
}

}  // namespace
}  // namespace camber::removal
