// camber resegment --part as a user runs it.
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "nc/interpreter.h"
#include "repath/raster/drop_cutter.h"
#include "test_paths.h"
#include "tests/nc/rs274_oracle.h"
#include "tests/support/read_text.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::Read;
using tests::read;
using tests::replaced;
using tests::run_camber;
using tests::TempFolder;

const std::string kSample = CAMBER_SOURCE_DIR "/samples/10-raster/";
constexpr const char* kCut =
    "--scallop-mm 0.006 --tolerance-mm 0.003 --feed-mm-per-min 1200 --spindle-rpm 12000 -o raster.nc";

/// The sample's files, its job with some words replaced.
void copy_sample(const TempFolder& folder, const std::map<std::string, std::string>& words = {}) {
  std::string job = file_text(kSample + "job.toml");
  for (const auto& [from, to] : words) job = replaced(job, from, to);
  folder.write("job.toml", job);
  for (const char* name : {"machine.toml", "part.stl"}) folder.write(name, file_text(kSample + name));
}

/// What the command says of a wrong job or part; it must not have written a program.
std::string said(const TempFolder& folder, const std::string& arguments, int status = 1) {
  const auto run = run_camber(folder, "resegment " + arguments);
  EXPECT_EQ(run.status, status) << arguments;
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "raster.nc"));
  return run.err;
}

TEST(RasterCommand, LaysRowsThatKeepToTheOffsetSurface) {
  const TempFolder folder;
  copy_sample(folder);
  const auto run = run_camber(folder, fmt::format("resegment --part part.stl --job job.toml --json r.json {}", kCut));
  ASSERT_EQ(run.status, 0) << run.err;
  const auto check = run_camber(folder, "check --strict raster.nc");
  EXPECT_EQ(check.status, 0) << check.err;
  const json r = json::parse(file_text(folder / "r.json"));
  for (const char* key : {"blocks_before", "blocks_after", "lines", "arcs", "length_before_mm", "length_after_mm",
                          "max_deviation_mm", "time_before_s", "time_after_s"})
    EXPECT_TRUE(r.contains(key)) << key;
  EXPECT_LT(r["blocks_after"], r["blocks_before"]);
  EXPECT_LE(r["scallop_mm"]["largest"], 0.006);
  // The longest that costs no more than 0.5 % of the fastest one's time.
  double fastest = 1e9;
  for (const auto& t : r["tried"]) fastest = std::min(fastest, t["time_s"].get<double>());
  EXPECT_LE(r["time_after_s"], 1.0051 * fastest);
  for (const auto& t : r["tried"])
    if (t["length_factor"] > r["length_factor"]) {
      EXPECT_GT(t["time_s"], 1.004 * fastest);
    }
  // The tip along every block, against the drop cutter, which was tested by itself. The slopes are below 20 degrees.
  const repath::DropCutter part(read_stl(folder / "part.stl"), {.radius_mm = 3, .corner_radius_mm = 3});
  const Read program = read(file_text(folder / "raster.nc"));
  double above = 0, below = 0;
  std::size_t rows = 0, chains = 0;
  Vec3 along(0, 0, 0);
  for (const nc::Move& m : program.moves.moves) {
    if (m.kind != nc::MoveKind::linear) continue;
    const Vec3 step = m.end_mm - m.start_mm;
    if (step.head<2>().norm() < 1e-6) {  // led in
      ++chains;
      EXPECT_LT(step.z(), 0);
      continue;
    }
    if (std::abs(step.x()) > std::abs(step.y())) {  // on a row
      if (step.x() * along.x() < 0) ++rows;
      along = step;
    }
    for (int i = 0; i <= 10; ++i) {
      const Vec3 p = m.start_mm + 0.1 * i * step;
      const auto contact = part.at(p.head<2>());
      ASSERT_TRUE(contact);
      above = std::max(above, p.z() - contact->tip_mm);
      below = std::max(below, contact->tip_mm - p.z());
    }
  }
  EXPECT_LE(above, 0.003 * 1.07);
  EXPECT_LE(below, 0.003 * 1.07);
  EXPECT_EQ(chains, 1 + r["links"]["clearance"].get<std::size_t>());
  EXPECT_EQ(rows + 1, r["rows"]);
}

// Cusps between rows are parabolas: a third of the scallop in the mean. The tolerance is on top of it.
TEST(RasterCommand, PredictFindsOnThePartWhatTheScallopsSay) {
  const TempFolder folder;
  copy_sample(folder);
  ASSERT_EQ(run_camber(folder, fmt::format("-q resegment --job job.toml {}", kCut)).status, 0);
  const auto run = run_camber(folder, "-q predict job.toml -o predicted");
  ASSERT_EQ(run.status, 0) << run.err;
  const json r = json::parse(file_text(folder / "predicted/summary.json"));
  const auto& error = r["total_error_um"];
  EXPECT_GT(error["mean"], 6.0 / 3 - 0.7);
  EXPECT_LT(error["mean"], 6.0 / 3 + 0.7);
  EXPECT_LT(error["max"], 6 + 3 + 2);  // in the corner of the part the outermost row has no neighbour
  EXPECT_GT(error["min"], -3.0);
  EXPECT_GT(error["p95"], 0.6 * 6);
  EXPECT_LT(error["p95"], 6 + 1);
}

TEST(RasterCommand, RowsTurnAndAreCutOffAtABoundary) {
  const TempFolder folder;
  copy_sample(folder, {{"program = \"raster.nc\"", ""}});  // the program that is made needs no name in the job
  const auto run = run_camber(folder, fmt::format("-q resegment --job job.toml --direction-deg 90 --boundary 1,1,5,4 "
                                                  "--clearance-mm 30 {}",
                                                  kCut));
  ASSERT_EQ(run.status, 0) << run.err;
  const Read program = read(file_text(folder / "raster.nc"));
  Vec2 low(1e9, 1e9), high(-1e9, -1e9);
  double length_x = 0, length_y = 0, top = 0;
  for (const nc::Move& m : program.moves.moves) {
    top = std::max(top, m.end_mm.z());
    if (m.kind != nc::MoveKind::linear) continue;
    low = low.cwiseMin(m.end_mm.head<2>()), high = high.cwiseMax(m.end_mm.head<2>());
    length_x += std::abs(m.end_mm.x() - m.start_mm.x()), length_y += std::abs(m.end_mm.y() - m.start_mm.y());
  }
  EXPECT_GT(length_y, 5 * length_x);
  EXPECT_EQ(top, 30);
  // The contact stays inside; the axis stands beside it by the radius times the sine of the slope, 20 degrees at most.
  EXPECT_GE(low.x(), 1 - 3 * 0.35);
  EXPECT_LE(high.x(), 5 + 3 * 0.35);
  EXPECT_GE(low.y(), 1 - 3 * 0.1);
  EXPECT_LE(high.y(), 4 + 3 * 0.1);
}

TEST(RasterCommand, SaysWhereTheSurfaceIsTooSteepForTheScallops) {
  const TempFolder folder;
  copy_sample(folder);
  // A tetrahedron with two sides as good as upright along the rows.
  folder.write("steep.stl",
               "solid s\n"
               "facet\nouter loop\nvertex 0 0 0\nvertex 8 0 0\nvertex 4 0.3 6\nendloop\nendfacet\n"
               "facet\nouter loop\nvertex 8 0 0\nvertex 4 0.6 0\nvertex 4 0.3 6\nendloop\nendfacet\n"
               "facet\nouter loop\nvertex 4 0.6 0\nvertex 0 0 0\nvertex 4 0.3 6\nendloop\nendfacet\n"
               "facet\nouter loop\nvertex 0 0 0\nvertex 4 0.6 0\nvertex 8 0 0\nendloop\nendfacet\n"
               "endsolid\n");
  const auto run = run_camber(folder, fmt::format("-q resegment --part steep.stl --job job.toml {}", kCut));
  EXPECT_EQ(run.status, 3);
  const std::string begin = "resegment: scallops of up to ";
  EXPECT_EQ(run.err.substr(0, begin.size()), begin) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "raster.nc"));
}

TEST(RasterCommand, TellsWhatIsWrongWithThePart) {
  const TempFolder folder;
  copy_sample(folder);
  EXPECT_EQ(said(folder, fmt::format("--part nothing.stl --job job.toml {}", kCut)),
            "nothing.stl: error: no such file [file-missing]\n");
  folder.write("empty.stl", "");
  EXPECT_EQ(said(folder, fmt::format("--part empty.stl --job job.toml {}", kCut)),
            "empty.stl: error: is empty; an STL file was expected [stl-empty]\n");
  folder.write("text.stl", "solid nothing\nendsolid\n");
  EXPECT_EQ(said(folder, fmt::format("--part text.stl --job job.toml {}", kCut)),
            "text.stl: error: is not an STL file: neither 84 + 50 n bytes nor the word 'facet' [stl-format]\n");
  folder.write("open.stl",
               "solid s\nfacet\nouter loop\nvertex 0 0 0\nvertex 8 0 0\nvertex 8 5 1\nendloop\nendfacet\nendsolid\n");
  EXPECT_EQ(said(folder, fmt::format("--part open.stl --job job.toml {}", kCut)),
            "open.stl: error: the mesh is not closed: 3 of its edges have no second triangle, and the cutter could "
            "fall through; a closed one was expected [stl-open]\n");
  folder.write("large.stl",
               "solid s\n"
               "facet\nouter loop\nvertex 0 0 0\nvertex 2e7 0 0\nvertex 0 0 6\nendloop\nendfacet\n"
               "facet\nouter loop\nvertex 0 0 0\nvertex 0 0 6\nvertex 2e7 0 0\nendloop\nendfacet\nendsolid\n");
  EXPECT_EQ(said(folder, fmt::format("--part large.stl --job job.toml {}", kCut)),
            "large.stl: error: the part is 2e+07 mm long; no more than 10000 mm was expected [part-size]\n");
  copy_sample(folder, {{"[part]\nmesh = \"part.stl\"", ""}});
  EXPECT_EQ(said(folder, fmt::format("--job job.toml {}", kCut)),
            "job.toml: error: has no [part] mesh, and there is no --part; one of them was expected [part-missing]\n");
}

TEST(RasterCommand, TellsWhatIsWrongWithTheJob) {
  const TempFolder folder;
  copy_sample(folder);
  EXPECT_EQ(said(folder, fmt::format("--part part.stl --job no.toml {}", kCut)),
            "no.toml: error: no such file [file-missing]\n");
  EXPECT_EQ(said(folder, fmt::format("--job job.toml --tool 7 {}", kCut)),
            "job.toml: error: has no [tool.7]; it has T1 [tool-missing]\n");
  EXPECT_EQ(said(folder, fmt::format("--job job.toml --boundary 20,0,30,5 {}", kCut)),
            "part.stl: error: nothing of the part lies inside --boundary 20,0,30,5; it reaches from X0 Y0 to X8 Y5 "
            "[boundary-empty]\n");
  EXPECT_EQ(said(folder, fmt::format("--job job.toml --clearance-mm 2 {}", kCut)),
            "job.toml: error: --clearance-mm 2 lies below the top of stock and part, Z7; a height above it was "
            "expected [clearance-low]\n");
  EXPECT_EQ(
      said(folder,
           "--job job.toml --scallop-mm 0.005 --tolerance-mm 0.003 --feed-mm-per-min 1200 "
           "--spindle-rpm 50000 -o raster.nc"),
      "machine.toml: error: the spindle turns at 20000 rpm at most; --spindle-rpm 50000 was given [spindle-speed]\n");
  EXPECT_EQ(said(folder,
                 "--job job.toml --scallop-mm 0.005 --tolerance-mm 0.003 --feed-mm-per-min 1200 "
                 "--spindle-rpm 12000 -o part.stl"),
            "part.stl: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
  copy_sample(folder,
              {{"[tool.1]", "[tool.2]\ntype = \"flat\"\ndiameter_mm = 4\nflutes = 2\noverhang_mm = 20\n[tool.1]"}});
  EXPECT_EQ(said(folder, fmt::format("--job job.toml {}", kCut)),
            "job.toml: error: has the tools T1, T2; --tool N was expected [tool-missing]\n");
  copy_sample(folder, {{"type = \"ball\"", "type = \"drill\""}});
  EXPECT_EQ(said(folder, fmt::format("--job job.toml {}", kCut)),
            "job.toml: error: [tool.1] is no ball, flat or bull-nose cutter; one of them was expected for a raster "
            "[tool-type]\n");
}

TEST(RasterCommand, TellsWhatIsWrongOnTheCommandLine) {
  const TempFolder folder;
  copy_sample(folder);
  const std::string hint = "Run with --help for more information.\n";
  EXPECT_EQ(said(folder, "--job job.toml --scallop-mm 0.005 --tolerance-mm 0.003 --spindle-rpm 9 -o raster.nc", 2),
            "--feed-mm-per-min is required\n" + hint);
  EXPECT_EQ(said(folder, "--tolerance-mm 0.003 -o raster.nc", 2),
            "program, or --job with --part, is required\n" + hint);
  EXPECT_EQ(said(folder, fmt::format("--job job.toml --boundary 5,0,1,2 {}", kCut), 2),
            "--boundary: 5,0,1,2: X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1 was expected\n" + hint);
  EXPECT_EQ(said(folder, fmt::format("--job job.toml --direction-deg nan {}", kCut), 2),
            "--direction-deg: nan: a number from -360 to 360 was expected\n" + hint);
  EXPECT_EQ(
      said(folder,
           "--job job.toml --scallop-mm 0.005 --tolerance-mm 0.0001 --feed-mm-per-min 9 --spindle-rpm 9 "
           "-o raster.nc",
           2),
      "--tolerance-mm: 0.0001: at least 0.0005 was expected for a raster, whose points are rounded to 0.0001 mm\n" +
          hint);
  EXPECT_EQ(said(folder, fmt::format("p.nc --job job.toml {}", kCut), 2), "program excludes --job\n" + hint);
  EXPECT_EQ(said(folder, fmt::format("--job job.toml --units inch {}", kCut), 2), "--units requires program\n" + hint);
  EXPECT_EQ(said(folder, fmt::format("--part part.stl {}", kCut), 2), "--part requires --job\n" + hint);
}

TEST(RasterCommand, HelpShowsAnExampleOfIt) {
  const TempFolder folder;
  copy_sample(folder);
  const auto help = run_camber(folder, "resegment --help");
  const std::string mark = "\n  camber resegment --part";
  const std::size_t at = help.out.find(mark);
  ASSERT_NE(at, std::string::npos) << help.out;
  std::string example = help.out.substr(at + std::string("\n  camber ").size());
  example = example.substr(0, example.find('\n'));
  EXPECT_EQ(run_camber(folder, example).status, 0) << example;
}

}  // namespace
}  // namespace camber

namespace camber::nc {
namespace {

TEST_F(Rs274, ARasterMovesAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  const tests::TempFolder folder;
  copy_sample(folder, {{"\"machine.toml\"", "\"" CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_fitted.toml\""}});
  ASSERT_EQ(tests::run_camber(folder, fmt::format("-q resegment --job job.toml {}", kCut)).status, 0);
  expect_same_moves(tests::file_text(folder / "raster.nc"));
  EXPECT_GT(moves_, 500u);
}

}  // namespace
}  // namespace camber::nc
