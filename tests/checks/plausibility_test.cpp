// Jobs with exactly one thing wrong, and the whole of what is said of each.
#include "checks/plausibility.h"

#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "machine/job.h"
#include "simulate/pieces.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::checks {
namespace {

using tests::replaced;
using tests::TempFolder;

constexpr double kSlope = 0.5;  // of the roof

/// Rows of a ball of 6 mm over a roof: ridge along Y at X20, falling by kSlope to both sides.
std::string roof_rows() {
  std::string out = "G21 G90 G17 G40 G49 G80 G54\n(T1 D=6. CR=3. - BALL END MILL)\nT1 M6\nS8000 M3\nG0 X2 Y2 Z20\n";
  const double n = std::hypot(1, kSlope);
  // Centre over the slope by the radius along its normal, the tip below it.
  const auto tip = [&](double x) { return -kSlope * std::abs(x - 20) + 3 * n - 3; };
  bool to = true;
  for (double y = 2; y <= 18; y += 1, to = !to)
    for (const double x : {2.0, 18.0, 22.0, 38.0})
      out += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.4f}{}\n", to ? x : 40 - x, y, tip(x), y == 2 && x == 2 ? " F960" : "");
  return out + "G0 Z20\nM30\n";
}

const std::string kMachine = "[axis.x]\n[axis.y]\n[axis.z]\n[spindle]\nmax_rpm = 12000\npower_kW = 10\n";
const std::string kSteel = "[material]\nktc_MPa = 1860.0\nkrc_MPa = 700.0\nkte_N_per_mm = 15.0\nkre_N_per_mm = 15.0\n";

/// The roof, right.
const std::string kRoof =
    "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 6.0\nflutes = 2\n"
    "helix_deg = 30.0\noverhang_mm = 30.0\nroot_stiffness_N_per_um = 20.0\n" +
    kSteel + "[stock]\nbox_mm = [[0, 0, -20], [40, 20, 2]]\nallowance_mm = 0.3\n[simulation]\nvoxel_mm = 0.2\n";

/// A pocket of 40 x 24 mm, 6 mm deep in two levels, by a flat end mill of 8 mm, right.
const std::string kPocket = replaced(
    replaced(replaced(kRoof, "\"ball\"", "\"flat\""), "diameter_mm = 6.0\nflutes = 2", "diameter_mm = 8.0\nflutes = 3"),
    "box_mm = [[0, 0, -20], [40, 20, 2]]\nallowance_mm = 0.3", "box_mm = [[-30, -20, -15], [30, 20, 0]]");
std::string pocket_rows() {
  std::string out = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-16 Y-8 Z10\n";
  for (const int z : {-3, -6}) {
    out += fmt::format("G0 X-16 Y-8\nG0 Z1\nG1 Z{} F200\n", z);
    for (int y = -8; y <= 8; y += 4) out += fmt::format("G1 Y{} F800\nX{}\n", y, y / 4 % 2 == 0 ? 16 : -16);
    out += "G0 Z10\n";
  }
  return out + "M30\n";
}

/// A closed roof; shift moves it.
std::string roof_stl(const Vec3& shift) {
  const std::vector<Vec3> p{{0, 0, -20},  {40, 0, -20},  {40, 0, -10},  {20, 0, 0},  {0, 0, -10},
                            {0, 20, -20}, {40, 20, -20}, {40, 20, -10}, {20, 20, 0}, {0, 20, -10}};
  const std::vector<std::array<int, 3>> triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {5, 7, 6}, {5, 8, 7}, {5, 9, 8},
                                                  {0, 5, 6}, {0, 6, 1}, {1, 6, 7}, {1, 7, 2}, {2, 7, 8}, {2, 8, 3},
                                                  {3, 8, 9}, {3, 9, 4}, {4, 9, 5}, {4, 5, 0}};
  std::string out = "solid roof\n";
  for (const auto& t : triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int i : t) {
      const Vec3 v = p[static_cast<std::size_t>(i)] + shift;
      out += fmt::format("vertex {:.6f} {:.6f} {:.6f}\n", v.x(), v.y(), v.z());
    }
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid roof\n";
}

struct SetUp {
  std::string job = kRoof, program = roof_rows(), machine = kMachine, part{};
};

/// A line for each thing said, without the folder's name.
std::string said(const SetUp& set_up) {
  const TempFolder folder;
  folder.write("p.nc", set_up.program);
  folder.write("machine.toml", set_up.machine);
  if (!set_up.part.empty()) folder.write("part.stl", set_up.part);
  const std::string path =
      folder.write("job.toml", set_up.job + (set_up.part.empty() ? "" : "[part]\nmesh = \"part.stl\"\n"));
  Diagnostics found;
  std::vector<Diagnostic> list;
  try {
    const machine::Job job = machine::read_job(path, found);
    check_program(job, simulate::read_moves(SourceText::read(job.program), job, found), found);
    list = found.all();
  } catch (const InputError& e) {
    list = e.diagnostics();
  }
  std::string out;
  for (const Diagnostic& d : list)
    out += fmt::format("{}{}: {}: {} [{}]\n", d.location.file,
                       d.location.line > 0 ? fmt::format(":{}", d.location.line) : "",
                       d.severity == Severity::error ? "error" : "warning", d.message, d.check);
  return replaced(out, folder.path() + "/", "");
}

std::string roof(std::string_view from, std::string_view to) { return said({.job = replaced(kRoof, from, to)}); }
std::string pocket(std::string_view from, std::string_view to) {
  return said({.job = replaced(kPocket, from, to), .program = pocket_rows()});
}
/// Without the comment that names the tool.
std::string silent_roof(std::string_view from, std::string_view to) {
  return said(
      {.job = replaced(kRoof, from, to), .program = replaced(roof_rows(), "(T1 D=6. CR=3. - BALL END MILL)", "")});
}

TEST(Plausibility, NothingIsSaidOfRightJobs) {
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({.part = roof_stl(Vec3::Zero())}), "");
  EXPECT_EQ(silent_roof("", ""), "");
  EXPECT_EQ(said({.job = kPocket, .program = pocket_rows()}), "");
}

TEST(Plausibility, RulesHaveNamesOfTheirOwnAndAreDescribed) {
  std::set<std::string_view> names;
  const std::string page = tests::file_text(std::string(CAMBER_SOURCE_DIR) + "/docs/set-up.md");
  for (const Rule& rule : rules()) {
    EXPECT_TRUE(names.insert(rule.check).second) << rule.check;
    EXPECT_NE(page.find("| `" + std::string(rule.check) + "` |"), std::string::npos) << rule.check;
  }
}

}  // namespace
}  // namespace camber::checks
