// Jobs with exactly one thing wrong, and the whole of what is said of each.
#include "plausibility/plausibility.h"

#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "machine/job_file.h"
#include "simulate/pieces.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::plausibility {
namespace {

using tests::replaced;
using tests::TempFolder;

constexpr double kSlope = 0.5;  // of the roof

/// Rows of a ball of 6 mm over a roof: ridge along Y at X20, falling by kSlope to both sides.
std::string roof_rows() {
  std::string out = "G21 G90 G17 G40 G49 G80 G54\n(T1 D=6. CR=3. - BALL END MILL)\nT1 M6\nS8000 M3\nG0 X2 Y2 Z20\n";
  const double n = std::hypot(1, kSlope);
  // Centre over the slope by the radius along its normal, the tip below it.
  // Over the ridge 0.2 mm clear.
  const auto tip = [&](double x) { return x == 20 ? 0.2 : -kSlope * std::abs(x - 20) + 3 * n - 3; };
  bool to = true;
  for (double y = 2; y <= 18; y += 1, to = !to)
    for (const double x : {2.0, 18.6, 20.0, 21.4, 38.0})
      out += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.4f}{}\n", to ? x : 40 - x, y, tip(x), y == 2 && x == 2 ? " F960" : "");
  return out + "G0 Z20\nM30\n";
}

const std::string kMachine =
    "[control]\ndialect = \"linuxcnc\"\n[axis.x]\n[axis.y]\n[axis.z]\n[spindle]\nmax_rpm = 12000\npower_W = 10000\n";
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
    check_program(job, motion::read_moves(SourceText::read(job.program), job, found), found);
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

/// Of the lines those of one check.
std::string of_check(const std::string& text, const std::string& check) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    if (line.ends_with("[" + check + "]")) out += line + "\n";
    at = end + 1;
  }
  return out;
}

std::string roof(std::string_view from, std::string_view to, const std::string& check) {
  return of_check(said({.job = replaced(kRoof, from, to)}), check);
}
/// Of another program or machine, with the right job.
std::string program(std::string_view from, std::string_view to, const std::string& check) {
  return of_check(said({.program = replaced(roof_rows(), from, to)}), check);
}

TEST(Plausibility, NothingIsSaidOfRightJobs) {
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({.part = roof_stl(Vec3::Zero())}), "");
  EXPECT_EQ(said({.job = kPocket, .program = pocket_rows()}), "");
}

TEST(Plausibility, ToolThatTheCommentsContradict) {
  EXPECT_EQ(
      roof("\"ball\"", "\"flat\"", "tool-comment"),
      "job.toml: error: T1: type = \"flat\" in the job, but \"ball\" in the program's comment \"D=6. CR=3. - BALL "
      "END MILL\" (p.nc:2); the tool of the program was expected [tool-comment]\n");
  EXPECT_EQ(
      roof("diameter_mm = 6.0", "diameter_mm = 3.0", "tool-comment"),
      "job.toml: error: T1: diameter_mm = 3 in the job, but 6 mm (a radius?) in the program's comment \"D=6. CR=3. "
      "- BALL END MILL\" (p.nc:2); the tool of the program was expected [tool-comment]\n");
  EXPECT_EQ(roof("diameter_mm = 6.0", "diameter_mm = 0.236", "tool-comment"),
            "job.toml: error: T1: diameter_mm = 0.236 in the job, but 6 mm (is it in inches?) in the program's comment "
            "\"D=6. CR=3. - BALL END MILL\" (p.nc:2); the tool of the program was expected [tool-comment]\n");
  // The tool of another number.
  EXPECT_EQ(program("(T1 D=6. CR=3. - BALL END MILL)\n",
                    "(T1 D=10. - FLAT END MILL)\n(T2 D=6. CR=3. - BALL END MILL)\n", "tool-comment"),
            "job.toml: error: T1: type = \"ball\" in the job, but \"flat\" in the program's comment \"D=10. - FLAT END "
            "MILL\" (p.nc:2); it is like T2 there; the tool of the program was expected [tool-comment]\n");
}

TEST(Plausibility, OverhangTenTimesTooLongOrTooShort) {
  EXPECT_EQ(
      roof("overhang_mm = 30.0", "overhang_mm = 300.0", "tool-slender"),
      "job.toml: error: T1: overhang_mm = 300 is 50.0 times its diameter; no more than 15 times was expected: a longer "
      "tool is no static beam (diameter_mm and overhang_mm are in mm) [tool-slender]\n");
  EXPECT_EQ(roof("overhang_mm = 30.0", "overhang_mm = 762.0", "tool-slender"),
            "job.toml: error: T1: overhang_mm = 762 is longer than any milling tool; up to 400 mm was expected "
            "[tool-slender]\n");
  EXPECT_EQ(
      roof("overhang_mm = 30.0", "overhang_mm = 5.0", "tool-slender"),
      "job.toml: warning: T1: overhang_mm = 5 is less than its diameter, 6 mm; at least that was expected (holder "
      "face to tip) [tool-slender]\n");
}

TEST(Plausibility, NumbersOfAToolThatNoToolHas) {
  EXPECT_EQ(roof("flutes = 2", "flutes = 2\nyoungs_modulus_GPa = 600000.0", "tool-proportions"),
            "job.toml: error: T1: youngs_modulus_GPa = 600000 is not that of a milling cutter of 6 mm; 50 to 1200 was "
            "expected [tool-proportions]\n");
  EXPECT_EQ(roof("flutes = 2", "flutes = 20", "tool-proportions"),
            "job.toml: warning: T1: flutes = 20 is not that of a milling cutter of 6 mm; 1 to 7 was expected "
            "[tool-proportions]\n");
}

TEST(Plausibility, SpeedATenthAndFeedATenth) {
  EXPECT_EQ(program("S8000", "S800", "chip-load"),
            "p.nc:6: warning: T1 with 2 flutes at S800 and F960 feeds 0.6 mm per tooth, 0.1 of its diameter of 6 mm; "
            "0.006 to 0.36 mm was expected (S, F, flutes, diameter_mm?) [chip-load]\n");
  EXPECT_EQ(
      program("S8000", "S800", "cutting-speed"),
      "p.nc:6: warning: T1 with 2 flutes at S800 and F960 cuts at 15 m/min with 6 mm; 20 to 600 m/min was expected "
      "of carbide in a material of 1860 MPa (S, diameter_mm, [material]?) [cutting-speed]\n");
  EXPECT_EQ(program("F960", "F24", "chip-load"),
            "p.nc:6: error: T1 with 2 flutes at S8000 and F24 feeds 0.0015 mm per tooth, 0.00025 of its diameter of 6 "
            "mm; 0.006 to 0.36 mm was expected (S, F, flutes, diameter_mm?) [chip-load]\n");
}

TEST(Plausibility, WhatIsAssumedRefusesNoProgram) {
  const std::string slow = replaced(roof_rows(), "S8000", "S80");
  const auto starts = [&](std::string_view key, const std::string& check) {
    const std::string given = fmt::format("flutes = 2\nassumed = [\"{}\"]", key);
    return of_check(said({.job = replaced(kRoof, "flutes = 2", given), .program = slow}), check).substr(0, 12);
  };
  EXPECT_EQ(starts("flutes", "chip-load"), "p.nc:6: warn");
  EXPECT_EQ(starts("diameter_mm", "chip-load"), "p.nc:6: warn");
  EXPECT_EQ(starts("overhang_mm", "chip-load"), "p.nc:6: erro");
  const std::string high = replaced(kRoof, "[40, 20, 2]]", "[40, 20, 32]]\nassumed = [\"box_mm\"]");
  EXPECT_NE(said({.job = high}).find(": warning: the program rises to Z20 at most"), std::string::npos);
}

TEST(Plausibility, CoefficientsInOtherUnits) {
  EXPECT_EQ(
      roof("ktc_MPa = 1860.0", "ktc_MPa = 270000.0", "material-values"),
      "job.toml: error: [material] ktc_MPa: the specific cutting force of chips of 0.1 mm is 2.7e+05 MPa; 5 (wax) "
      "to 12000 MPa was expected (GPa, psi, kgf/mm2?) [material-values]\n");
  EXPECT_EQ(roof("kte_N_per_mm = 15.0", "kte_N_per_mm = 15000.0", "material-values"),
            "job.toml: error: [material] kte_N_per_mm = 15000, kre_N_per_mm = 15; 0.05 to 300 N/mm was expected (N/m, "
            "kN/m?) [material-values]\n");
  EXPECT_EQ(roof("ktc_MPa = 1860.0\nkrc_MPa = 700.0", "ktc_MPa = 190.0\nkrc_MPa = 71.0", "material-values"),
            "job.toml: warning: [material] kte_N_per_mm = 15 is 0.079 mm times the specific cutting force, 190 MPa; up "
            "to 0.06 mm was expected (are both in N and mm?) [material-values]\n");
}

/// The pocket's two levels at other heights.
std::string pocket_at(double first_mm, double second_mm, const std::string& feed = "F800") {
  return replaced(replaced(replaced(pocket_rows(), "Z-3 F200", fmt::format("Z{:g} F200", first_mm)), "Z-6 F200",
                           fmt::format("Z{:g} F200", second_mm)),
                  "F800", feed);
}

TEST(Plausibility, CutterOfAnotherShapeThanItsPath) {
  // Without the comment the path alone tells.
  const std::string rows = replaced(roof_rows(), "(T1 D=6. CR=3. - BALL END MILL)\n", "");
  const auto on_roof = [&](const char* type) {
    return of_check(said({.job = replaced(kRoof, "\"ball\"", type), .program = rows}), "tool-path");
  };
  EXPECT_EQ(on_roof("\"ball\""), "");
  EXPECT_EQ(
      on_roof("\"flat\""),
      "p.nc:5: warning: T1 is \"flat\" in the job, but 94 % of its path rises and falls as over a curved surface; "
      "a ball or bull end mill was expected [tool-path]\n");
  EXPECT_EQ(
      on_roof("\"bull\"\ncorner_radius_mm = 0.5"),
      "p.nc:5: warning: T1 is \"bull\" in the job, but 94 % of its path rises and falls as over a curved surface; "
      "a ball or bull end mill was expected [tool-path]\n");
  EXPECT_EQ(on_roof("\"bull\"\ncorner_radius_mm = 1.5"), "");  // half the radius follows surfaces

  const std::string ball =
      replaced(replaced(kPocket, "\"flat\"", "\"ball\""), "diameter_mm = 8.0", "diameter_mm = 6.0");
  EXPECT_EQ(
      of_check(said({.job = ball, .program = pocket_at(-4, -8)}), "tool-path"),
      "p.nc:7: warning: T1 is \"ball\" in the job, but 96 % of its path is level and cuts 2.9 mm deep with a radius "
      "of 3 mm, as end mills with a flat bottom do; a ball end mill's path was expected [tool-path]\n");
  EXPECT_EQ(of_check(said({.job = ball, .program = pocket_at(-1, -2)}), "tool-path"), "");
}

TEST(Plausibility, CutsDeeperThanTheCutterIsWide) {
  const std::string deep_stock = replaced(kPocket, "[-30, -20, -15]", "[-30, -20, -40]");
  EXPECT_EQ(of_check(said({.job = deep_stock, .program = pocket_at(-26, -26)}), "cut-depth"),
            "p.nc:9: warning: T1 cuts 26.0 mm deep at once, 3.2 times its diameter; at most 3 times in a slot was "
            "expected (is the stock too high, or the tool another one?) [cut-depth]\n");
  EXPECT_EQ(of_check(said({.job = deep_stock, .program = pocket_at(-22, -22)}), "cut-depth"), "");

  // A cone of 90 degrees from 0.4 mm to 8 mm is 3.8 mm high.
  const std::string chamfer =
      replaced(kPocket, "\"flat\"", "\"chamfer\"\ntip_diameter_mm = 0.4\npoint_angle_deg = 90.0");
  EXPECT_EQ(of_check(said({.job = chamfer, .program = pocket_at(-6, -6)}), "cut-depth"),
            "p.nc:9: warning: T1 is \"chamfer\" in the job and meets material up to 6.0 mm above its tip, but its cone "
            "is 3.8 mm high; a stock whose edges are cut and only lack their chamfer was expected (is the stock too "
            "high, or the tool another one?) [cut-depth]\n");
  EXPECT_EQ(of_check(said({.job = chamfer, .program = pocket_at(-3, -3)}), "cut-depth"), "");
}

TEST(Plausibility, CutsThatNeitherSpindleNorToolStands) {
  // 8 x 3 mm at 60 m/min in 1860 MPa are 44.6 kW.
  EXPECT_EQ(of_check(said({.job = kPocket, .program = pocket_at(-3, -6, "F60000")}), "cut-power"),
            "p.nc:9: error: T1 needs 44.6 kW for its chips; no more than 30 kW was expected (depth of the cut, "
            "[material], F?) [cut-power]\n");
  // 6.7 kW over 2.51 m/s are 2.66 kN.
  EXPECT_EQ(
      of_check(said({.job = replaced(kPocket, "overhang_mm = 30.0", "overhang_mm = 100.0"),
                     .program = pocket_at(-3, -6, "F9000")}),
               "cut-power"),
      "p.nc:9: error: T1 would bend by 7.5 mm under the mean force of its chips, 2.66e+03 N, and break; a cut that "
      "a cutter of 8 mm with overhang_mm = 100 stands was expected [cut-power]\n");
  EXPECT_EQ(of_check(said({.job = kPocket, .program = pocket_at(-3, -6, "F9000")}), "cut-power"), "");
  // A disc of 8 mm goes down at 40 m/min: 33.5 cm3/s are 62 kW; the survey's cells leave 6 % of it out.
  EXPECT_EQ(
      of_check(said({.job = kPocket, .program = replaced(pocket_rows(), "Z-3 F200", "Z-3 F40000")}), "cut-power"),
      "p.nc:7: warning: T1 goes straight down into the stock, which needs 58.8 kW for its chips; a place beside the "
      "stock, or that is cut already, was expected (is the stock too large?) [cut-power]\n");
}

TEST(Plausibility, StockTooHigh) {
  EXPECT_EQ(
      roof("[40, 20, 2]", "[40, 20, 22]", "stock-top"),
      "p.nc:91: error: the program rises to Z20 at most, but the stock's top is at Z22; a program that comes clear "
      "of the stock was expected (is the stock too high, or its zero another one?) [stock-top]\n");
}

TEST(Plausibility, StockTooHighOfAProgramThatRisesAboveIt) {
  EXPECT_EQ(
      roof("[40, 20, 2]", "[40, 20, 12]", "stock-top"),
      "job.toml: warning: the stock's top is at Z12, but nothing of it is left above Z0.67: the cut before, of which "
      "allowance_mm = 0.3 tells, takes 11.3 mm off everywhere; a stock of which the path leaves the top somewhere "
      "was expected (is it too high?) [stock-top]\n");
  EXPECT_EQ(roof("[40, 20, 2]", "[40, 20, 3]", "stock-top"), "");
  // Part of the top stays: a region of a larger block.
  EXPECT_EQ(roof("[40, 20, 2]", "[40, 40, 12]", "stock-top"), "");
}

TEST(Plausibility, AllowanceInAnotherUnit) {
  EXPECT_EQ(
      roof("allowance_mm = 0.3", "allowance_mm = 1.5", "allowance-size"),
      "job.toml: warning: allowance_mm = 1.5 is not what a pass before leaves for a cutter of 6 mm; 0.02 to 1.2 mm "
      "was expected [allowance-size]\n");
}

TEST(Plausibility, PathLongerThanTheTravel) {
  EXPECT_EQ(
      of_check(said({.machine = replaced(kMachine, "[axis.x]", "[axis.x]\ntravel_mm = [-10.0, 20.0]")}), "travel"),
      "p.nc:10: error: the program needs 36.0000 mm of X up to here; the axis has 30 mm of travel [travel]\n");
}

TEST(Plausibility, PartThatLiesElsewhere) {
  EXPECT_EQ(
      of_check(said({.part = roof_stl({1, 0, 0})}), "part-place"),
      "p.nc:40: error: the cutters cut into part.stl along 46 % of their path, by up to 0.45 mm here; the part "
      "moved by X-1.00 fits; a part that the path leaves was expected (its place, its size, another part, another "
      "tool?) [part-place]\n");
  EXPECT_EQ(
      of_check(said({.part = roof_stl({0, 0, 1})}), "part-place"),
      "p.nc:79: error: the cutters cut into part.stl along 96 % of their path, by up to 0.95 mm here; the part "
      "moved by Z-1.00 fits; a part that the path leaves was expected (its place, its size, another part, another "
      "tool?) [part-place]\n");
  EXPECT_EQ(
      of_check(said({.part = roof_stl({0, 0, -1})}), "part-place"),
      "part.stl: warning: no cutter comes nearer to the part than 0.89 mm; the part moved by Z1.00 fits; finishing "
      "passes that touch it were expected (its place, another part, another tool?) [part-place]\n");
}

TEST(Plausibility, StockThatLiesElsewhereOrIsTooSmall) {
  EXPECT_EQ(roof("[[0, 0, -20], [40, 20, 2]]", "[[24, 0, -20], [64, 20, 2]]", "stock-place"),
            "p.nc:7: warning: 53 % of the cutting path runs beside or above the stock: the tip cuts from X2.00 Y2.00 "
            "Z-8.65 to X38.00 Y18.00 Z20.00, the stock lies from X24.00 Y0.00 Z-20.00 to X64.00 Y20.00 Z2.00; a stock "
            "around the path, elsewhere by X-24.00 Y0.00, was expected [stock-place]\n");
  EXPECT_EQ(roof("[[0, 0, -20], [40, 20, 2]]", "[[0, -9, -20], [40, 11, 2]]", "stock-place"),
            "p.nc:67: warning: 29 % of the cutting path runs beside or above the stock: the tip cuts from X2.00 Y2.00 "
            "Z-8.65 to X38.00 Y18.00 Z20.00, the stock lies from X0.00 Y-9.00 Z-20.00 to X40.00 Y11.00 Z2.00; a stock "
            "around the path, elsewhere by X0.00 Y9.00, was expected [stock-place]\n");
  // Letters to and from which the cutter goes at the feed say nothing of the stock.
  std::string letters = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-16 Y0 Z30\n";
  for (int x = -16; x <= 16; x += 8) letters += fmt::format("G0 X{0} Y0\nG1 Z-1 F300\nY4\nG1 Z30\n", x);
  EXPECT_EQ(of_check(said({.job = kPocket, .program = letters + "M30\n"}), "stock-place"), "");
  // No more than a tool's diameter, as runs in and out are.
  EXPECT_EQ(roof("[[0, 0, -20], [40, 20, 2]]", "[[-7, -3, -20], [33, 17, 2]]", "stock-place"), "");
  EXPECT_EQ(
      of_check(said({.job = replaced(kPocket, "[[-30, -20, -15], [30, 20, 0]]", "[[-19, -11, -5.9], [19, 11, 0]]"),
                     .program = pocket_rows()}),
               "stock-left"),
      "job.toml: warning: the program removes 100.0 % of the stock; a stock of which a part is left was expected "
      "(is it too small, or a tool too large?) [stock-left]\n");
  EXPECT_EQ(of_check(said({.job = replaced(kRoof, "[40, 20, 2]]\nallowance_mm = 0.3", "[40, 20, -1]]"),
                           .part = roof_stl(Vec3::Zero())}),
                     "part-in-stock"),
            "part.stl: warning: the part rises out of the stock by up to 0.97 mm, at X19.93 Y0.20; a stock that holds "
            "the part was expected [part-in-stock]\n");
  EXPECT_EQ(
      of_check(said({.part = roof_stl({0, -1.5, 0})}), "part-in-stock"),
      "part.stl: warning: the part stands out of the stock towards -Y by 1.50 mm, though it would fit in; a stock "
      "that holds the part was expected (the place of either?) [part-in-stock]\n");
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
}  // namespace camber::plausibility
