// STEP files: read in builds with Open CASCADE, refused with a word on how to build it in others.
#include "base/triangle_mesh.h"

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber {
namespace {

TEST(MeshFile, KnowsStepFilesByTheirNames) {
  EXPECT_TRUE(is_step_file("a/part.step"));
  EXPECT_TRUE(is_step_file("PART.STP"));
  EXPECT_FALSE(is_step_file("part.stl"));
  EXPECT_FALSE(is_step_file("step"));
}

std::string refusal(const std::string& path) {
  try {
    read_mesh(path);
  } catch (const InputError& error) {
    return to_string(error.diagnostics().at(0));
  }
  return "read";
}

#ifdef CAMBER_OPENCASCADE

const std::string kBox = CAMBER_SOURCE_DIR "/tests/data/box_with_hole.step";
const std::string kInchBox = CAMBER_SOURCE_DIR "/tests/data/box_with_hole_inch.step";

double volume_mm3(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]].cast<double>(), b = mesh.points[t[1]].cast<double>(),
               c = mesh.points[t[2]].cast<double>();
    sum += a.dot(Vec3(b.y() * c.z() - b.z() * c.y(), b.z() * c.x() - b.x() * c.z(), b.x() * c.y() - b.y() * c.x())) / 6;
  }
  return sum;
}

/// 40 x 30 x 20 units with a through hole of 10 at (25, 15).
void expect_box_with_hole(const TriangleMesh& mesh, double unit_mm) {
  EXPECT_TRUE(mesh.closed());
  const double float_mm = 1e-5 * unit_mm;  // single precision, and the joining of points
  Vec3 low = Vec3::Constant(1e9), high = -low;
  for (const auto& p : mesh.points) {
    low = low.cwiseMin(p.cast<double>()), high = high.cwiseMax(p.cast<double>());
    const double r = std::hypot(p.x() - 25 * unit_mm, p.y() - 15 * unit_mm);
    if (r < 8 * unit_mm) {
      EXPECT_NEAR(r, 5 * unit_mm, 2 * float_mm);
    }
  }
  EXPECT_LT(low.norm(), float_mm);
  EXPECT_LT((high - unit_mm * Vec3(40, 30, 20)).norm(), 10 * float_mm);
  // The hole's facets are chords: it has less volume, by two thirds of the chord's height over its wall at most.
  const double cubic = unit_mm * unit_mm * unit_mm, wall = 2 * kPi * 5 * 20 * unit_mm * unit_mm;
  const double off = volume_mm3(mesh) - (40 * 30 * 20 - kPi * 25 * 20) * cubic;
  EXPECT_GT(off, 0);
  EXPECT_LT(off, kStepChord_mm * 2 / 3 * wall * 1.01);
}

TEST(StepFile, HasTheShapeWithinTheChordTolerance) { expect_box_with_hole(read_mesh(kBox), 1); }

TEST(StepFile, IsInMillimetresWhateverItsUnit) { expect_box_with_hole(read_mesh(kInchBox), 25.4); }

TEST(StepFile, TellsWhatIsNoStep) {
  const tests::TempFolder folder;
  const std::string path = folder.write("part.step", "solid part\nendsolid\n");
  EXPECT_EQ(refusal(path), path +
                               ": error: cannot be read as STEP (ISO 10303-21); a file of AP203, AP214 or AP242 was "
                               "expected [step-format]");
  EXPECT_EQ(refusal(folder / "none.stp"),
            (folder / "none.stp") + ": error: cannot be opened; a STEP file was expected [file-missing]");
}

#else

TEST(StepFile, IsRefusedWithAWordOnHowToBuildIt) {
  EXPECT_EQ(refusal("part.step"),
            "part.step: error: this build does not read STEP files; an STL file was expected, or a build configured "
            "with -DCAMBER_OPENCASCADE=ON (scripts/install-packages --step installs Open CASCADE) [step-not-built]");
}

#endif

}  // namespace
}  // namespace camber
