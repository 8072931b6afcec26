// A tool that yields along its axis, through the command line: columns, floors, and a ball's tip set right by Z.
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/geometry.h"
#include "base/units.h"
#include "tests/support/csv_columns.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::columns_of;
using tests::run_camber;
using tests::TempFolder;

/// A slot of 1 mm depth in which kae alone loads the tool: 100 N pull it down while its one tooth is in the cut.
void write_slot(const TempFolder& folder, const std::string& spring, const std::string& axis_z,
                const std::string& coupling) {
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-8. Y0.\nG0 Z-1.\nG1 X18. F600\nG0 Z5.\nM30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n" + axis_z);
  folder.write(
      "job.toml",
      "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 8.0\nflutes = "
      "1\noverhang_mm = 24.0\nyoungs_modulus_GPa = 600.0\n" +
          spring +
          "[material]\nktc_MPa = 0.0\nkrc_MPa = 0.0\nkae_N_per_mm = 100.0\n[stock]\nbox_mm = [[0, -6, -2], [10, "
          "6, 0]]\n[simulation]\nvoxel_mm = 0.1\ncoupling = \"" +
          coupling + "\"\n");
}

/// Mean error of the slot's floor, well inside it, um.
double floor_um(const TempFolder& folder) {
  const auto c = columns_of(tests::file_text(folder / "r/form_error.csv"));
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < c.at("x_mm").size(); ++i) {
    if (c.at("nz")[i] < 0.999 || std::abs(c.at("y_mm")[i]) > 2 || std::abs(c.at("x_mm")[i] - 5) > 2) continue;
    sum += c.at("area_mm2")[i] * c.at("error_um")[i];
    area += c.at("area_mm2")[i];
  }
  EXPECT_GT(area, 5);
  return sum / area;
}

TEST(Axial, AFloorIsOffByForceTimesCompliance) {
  constexpr double kForce_N = 100, kYoung_MPa = 600000, kOverhang = 24, kBar = 0.8 * 8;
  const double bar = kOverhang / (kYoung_MPa * kPi / 4 * kBar * kBar);
  struct Case {
    const char *spring, *axis_z, *coupling;
    double compliance;  ///< mm/N
  };
  for (const Case& c :
       {Case{"", "", "rigid", 0}, Case{"", "stiffness_N_per_um = 20.0\n", "rigid", bar + 5e-5},
        Case{"axial_stiffness_N_per_um = inf\n", "", "rigid", 0},
        Case{"root_axial_stiffness_N_per_um = 10.0\n", "", "rigid", bar + 1e-4},
        Case{"root_axial_stiffness_N_per_um = 10.0\n", "stiffness_N_per_um = 20.0\n", "rigid", bar + 1.5e-4},
        Case{"root_axial_stiffness_N_per_um = 10.0\n", "", "static", bar + 1e-4}}) {
    const TempFolder folder;
    write_slot(folder, c.spring, c.axis_z, c.coupling);
    const auto run = run_camber(folder, "-q predict job.toml -o r");
    ASSERT_EQ(run.status, 0) << run.err;
    // In static coupling it cuts deeper by what it yields: delta = -C kae (1 mm - delta).
    const double g = std::string(c.coupling) == "static" ? c.compliance * kForce_N : 0;
    const double expected = -1000 * kForce_N * c.compliance / (1 - g);
    EXPECT_NEAR(floor_um(folder), expected, 0.02 * -expected + 0.02) << c.spring << c.axis_z << c.coupling;
    const auto forces = columns_of(tests::file_text(folder / "r/forces.csv"));
    std::size_t inside = 0;
    for (std::size_t i = 0; i < forces.at("x_mm").size(); ++i) {
      if (std::abs(forces.at("x_mm")[i] - 4.5) > 1) continue;  // before the edge leaves the blank
      ++inside;
      EXPECT_NEAR(forces.at("dz_um")[i], expected, 0.02 * -expected + 0.02) << c.spring << c.axis_z << c.coupling;
    }
    EXPECT_GT(inside, 3u);
  }
}

/// Rows along X up a plane that rises along Y.
void write_plane(const TempFolder& folder, double degrees) {
  constexpr double kWide = 2.4, kLong = 2.0, kRow = 0.3;
  const double slope = std::tan(rad_from_deg(degrees));
  std::ostringstream program;
  program << "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS8000 M3\nG0 X-4. Y-2. Z8.\n";
  for (int i = -4; i <= 12; ++i) {
    const double y = i * kRow, z = y * slope;
    program << "G0 X-4. Y" << y << " Z8.\nG1 Z" << z << " F2000\nX" << kLong + 4 << " F1600\nG0 Z8.\n";
  }
  folder.write("p.nc", program.str() + "M30\n");
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  std::ostringstream job;
  job << "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 6.0\nflutes = "
         "2\nhelix_deg = 30.0\noverhang_mm = 20.0\nyoungs_modulus_GPa = 600.0\nroot_axial_stiffness_N_per_um = "
         "10.0\n[material]\nktc_MPa = 2000.0\nkrc_MPa = 1500.0\nkte_N_per_mm = 20.0\nkre_N_per_mm = 20.0\n[stock]\n"
      << "box_mm = [[0, 0, -3], [" << kLong << ", " << kWide << ", " << kWide * slope + 1
      << "]]\nallowance_mm = 0.2\n[simulation]\nvoxel_mm = 0.1\n[compensation]\nlevers = [\"shift\"]\ntolerance_um = "
         "0.5\nmax_rounds = "
         "6\nmax_shift_mm = 0.1\n";
  folder.write("job.toml", job.str());
}

/// A ball on a plane presses its tip up: the spring leaves micrometres, and a shift in Z takes them away.
TEST(Axial, ABallsTipIsSetRightByZ) {
  for (const double degrees : {0.0, 15.0, 30.0}) {
    const TempFolder folder;
    write_plane(folder, degrees);
    const auto run = run_camber(folder, "-q compensate job.toml -o out.nc --keep-anyway --json c.json");
    ASSERT_TRUE(run.status == 0 || run.status == 3) << run.err;
    const json c = json::parse(tests::file_text(folder / "c.json"));
    const auto figure = [&](const char* when, const char* which) { return c[when][which].get<double>(); };
    // What is left is the force's own ripple along the rows and the cutter's slow tip, which no shift takes away.
    EXPECT_GT(figure("before_um", "mean"), 1) << degrees;
    EXPECT_LT(std::abs(figure("after_um", "mean")), 0.2 * figure("before_um", "mean")) << degrees;
    EXPECT_LT(figure("after_um", "p95"), 0.6 * figure("before_um", "p95")) << degrees;
    EXPECT_NE(tests::file_text(folder / "out.nc"), tests::file_text(folder / "p.nc"));
  }
}

}  // namespace
}  // namespace camber
