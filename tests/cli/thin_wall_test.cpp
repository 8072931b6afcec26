// A wall that bends under the tool, as a user predicts and checks it.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/csv_columns.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::columns_of;
using tests::run_camber;
using tests::TempFolder;

/// One pass along the top of a wall of 0.8 x 12 x 12 mm.
void write_wall_job(const TempFolder& folder, const std::string& workpiece) {
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-4. Y3.8 Z5.\nG0 Z-2.\nG1 X16. F2400\nG0 Z5.\nM30\n");
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 5000\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "flat"
diameter_mm = 6.0
flutes = 2
helix_deg = 30.0
flute_length_mm = 3.0
overhang_mm = 20.0
[material]
ktc_MPa = 800.0
krc_MPa = 250.0
kte_N_per_mm = 6.0
kre_N_per_mm = 6.0
[stock]
box_mm = [[0, 0, -12], [12, 1, 0]]
[simulation]
voxel_mm = 0.2
)" + workpiece);
}

constexpr const char* kWorkpiece = "[workpiece]\nyoungs_modulus_GPa = 70.0\n";

TEST(ThinWallJob, ErrorIsTheToolsAndTheParts) {
  const TempFolder folder;
  write_wall_job(folder, kWorkpiece);
  const auto run = run_camber(folder, "predict job.toml -o result --json figures.json");
  ASSERT_EQ(run.status, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("\n  workpiece "), std::string::npos) << run.out;
  const auto rows = columns_of(tests::file_text(folder / "result/form_error.csv"));
  ASSERT_TRUE(rows.contains("part_deflection_um"));
  double largest = 0;
  for (std::size_t i = 0; i < rows.at("error_um").size(); ++i) {
    EXPECT_NEAR(rows.at("tool_deflection_um")[i] + rows.at("part_deflection_um")[i], rows.at("deflection_um")[i],
                0.002);
    largest = std::max(largest, std::abs(rows.at("part_deflection_um")[i]));
  }
  const auto figures = nlohmann::json::parse(tests::file_text(folder / "figures.json"));
  EXPECT_GT(figures.at("part_deflection_um").at("p95").get<double>(),
            3 * figures.at("tool_deflection_um").at("p95").get<double>());
  EXPECT_GT(largest, 5);
  EXPECT_GT(figures.at("workpiece").at("places").get<int>(), 2);
}

TEST(ThinWallJob, TakesThePartAsRigidUnlessItIsTold) {
  const TempFolder folder;
  write_wall_job(folder, "");
  const auto run = run_camber(folder, "predict job.toml -o result");
  ASSERT_EQ(run.status, 0) << run.err << run.out;
  EXPECT_EQ(run.out.find("workpiece"), std::string::npos);
  EXPECT_FALSE(columns_of(tests::file_text(folder / "result/form_error.csv")).contains("part_deflection_um"));
}

TEST(ThinWallJob, CheckSuggestsIt) {
  const TempFolder folder;
  write_wall_job(folder, "");
  const auto rigid = run_camber(folder, "check p.nc --job job.toml");
  EXPECT_NE((rigid.err + rigid.out).find("[workpiece-thin]"), std::string::npos) << rigid.err << rigid.out;
  write_wall_job(folder, kWorkpiece);
  const auto elastic = run_camber(folder, "check p.nc --job job.toml");
  EXPECT_EQ((elastic.err + elastic.out).find("[workpiece-thin]"), std::string::npos) << elastic.err << elastic.out;
}

TEST(ThinWallJob, IsRefusedInSections) {
  const TempFolder folder;
  write_wall_job(folder, kWorkpiece);
  const auto run = run_camber(folder, "predict job.toml -o parts --sections 2");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("error: [workpiece] is for a prediction in one piece; one without --sections was expected "
                         "[workpiece-sections]"),
            std::string::npos)
      << run.err;
}

}  // namespace
}  // namespace camber
