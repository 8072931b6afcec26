// What is narrower than the planner's cells: nothing of it may be left along walls, and no rapid may run into it.
#include <gtest/gtest.h>

#include "copymill/copy_milling.h"
#include "tests/copymill/small_copy.h"
#include "tests/support/block_part.h"
#include "tests/support/height_map_judge.h"

namespace camber::copymill {
namespace {

using tests::BlockPart;
using tests::read_copy;
using tests::ReadCopy;
using tests::SmallCopy;
using tests::TempFolder;

std::string rows(const std::string& region, const std::string& more) {
  return "[[copy]]\ntool = 1\nmode = \"scanning-line\"\nspindle_rpm = 6000\nfeed_mm_per_min = 3000\n"
         "sense = \"both\"\nregion = { " +
         region + " }\n" + more;
}

const judge::Cutter kFlat8{.diameter = 8};

struct Judged {
  judge::Verdict program;
  judge::HeightMap map;
};

/// The program of a job, in a block of this size, on a grid of 0.1 mm.
Judged judged(const TempFolder& folder, const BlockPart& part, const SmallCopy& job, const judge::Point& lo,
              const judge::Point& hi) {
  tests::write_stl(part.mesh(), job.part);
  const ReadCopy read = read_copy(folder, job);
  Diagnostics diagnostics;
  const CopyResult result = copy(read.job, read.operations, {.loads = false}, diagnostics);
  Judged out{{}, judge::HeightMap(lo, hi, 0.1)};
  for (const judge::Piece& piece : judge::ProgramReader().read(result.text)) out.map.cut(piece, kFlat8, out.program);
  return out;
}

TEST(Slivers, RowsLeaveNoneAlongTheWallsAtTheirEnds) {
  // Cusps of rows 2.4 mm apart are 0.18 mm thick. Cells of 0.2 mm have their middles at 3.9 mm and 4.1 mm.
  const TempFolder folder;
  const BlockPart part{
      .block = tests::box(0, 0, 0, 24, 20, 10), .pockets = {tests::box(3.91, -1, 6, 25, 21, 11)}, .holes = {}};
  const SmallCopy job{
      .part = folder / "part.stl",
      .stock = "box_mm = [[0, 0, 0], [24, 20, 10]]",
      .operations = rows("box_mm = [[3.91, -5], [29, 25]]", "radial_depth_mm = 2.4\naxial_depth_mm = 4\n")};
  const Judged found = judged(folder, part, job, {0.03, 0.03, 0}, {24, 20, 10});
  judge::Verdict v;
  found.map.compare(judge::PartMesh(judge::read_stl(job.part)), {-1, -1, -1}, {25, 21, 11}, 0, 0.006, kFlat8, v, 0.1);
  EXPECT_EQ(v.left_reachable.depth, 0) << v.left_reachable.place.x << " " << v.left_reachable.place.y;
  EXPECT_LT(v.gouge.depth, 0.005);
  EXPECT_EQ(found.program.rapid.depth, 0) << found.program.rapid.line;
}

TEST(Slivers, NoRapidComesDownOnAFin) {
  // The first two operations leave a fin from Y 9 to 9.05; cells of 0.2 mm have their middles at 8.9 mm and 9.1 mm.
  const TempFolder folder;
  const BlockPart part{.block = tests::box(0, -10, 0, 40, 32, 4), .pockets = {}, .holes = {}};
  const std::string depths = "radial_depth_mm = 4\naxial_depth_mm = 3\n";
  const SmallCopy job{.part = folder / "part.stl",
                      .stock = "box_mm = [[0, -10, 0], [40, 32, 10]]",
                      .operations = rows("box_mm = [[-6, -10], [46, 5]], z_mm = [7, 10]", depths) +
                                    rows("box_mm = [[-6, 13.05], [46, 32]], z_mm = [7, 10]", depths) +
                                    rows("box_mm = [[14, 7], [26, 8]], z_mm = [4, 10]", depths)};
  const Judged found = judged(folder, part, job, {0.03, -9.98, 0}, {40, 32, 10});
  EXPECT_EQ(found.program.rapid.depth, 0) << "line " << found.program.rapid.line;
  EXPECT_NEAR(found.map.height_at(5.03, 9.02), 10, 1e-9) << "else there was no fin";
  EXPECT_NEAR(found.map.height_at(20.03, 9.02), 4, 1e-9);
}

}  // namespace
}  // namespace camber::copymill
