// One program through every command that tells a time: they agree to the microsecond.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

constexpr double kMicrosecond = 1e-6;

/// A wall with an arc, rapids that bend, a dwell, a code that the path waits for.
constexpr const char* kProgram =
    "%\nO1 (WALL)\nG21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4. Y-20.\nG0 Y-2.\nG0 Z-1.\nG1 X2. "
    "F1600\nM8\nX8.\n"
    "G3 X10. Y0. R2.\nG1 X10.5 Y.5\nG4 P120\nX12.\nG0 Z5.\nG0 X30. Y-7.\nM30\n%\n";

/// Every law that used to act in `time` alone.
std::string machine_with(const std::string& cycle) {
  std::string text =
      "[control]\ncorner = { law = \"angle\", time_ms = 3, threshold_degrees = 5 }\nblock_time_ms = 1\n" + cycle;
  for (const char axis : {'x', 'y', 'z'})
    text += fmt::format(
        "[axis.{}]\nmax_velocity_mm_per_min = 20000\nrapid_mm_per_min = {}\nacceleration_mm_per_s2 = 1500\n"
        "rapid_acceleration_mm_per_s2 = 2500\nposition_gain_per_s = 40\ntravel_mm = [-100, 100]\n",
        axis, axis == 'z' ? 9000 : 15000);
  return text;
}

constexpr const char* kJob =
    "program = \"p.nc\"\nmachine = \"m.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\n"
    "overhang_mm = 16.0\nhelix_deg = 30\n[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\n"
    "box_mm = [[0, -0.5, -2], [8, 2, 0]]\nallowance_mm = 0.1\n[simulation]\nvoxel_mm = 0.4\n"
    "coupling = \"rigid\"\n[compensation]\nlevers = [\"shift\"]\ntolerance_um = 3.0\nmax_overcut_um = 60.0\nmax_rounds "
    "= 1\n";

class OneModel : public testing::TestWithParam<const char*> {};

TEST_P(OneModel, EveryCommandTakesTheSameTime) {
  const TempFolder folder;
  folder.write("p.nc", kProgram);
  folder.write("m.toml", machine_with(GetParam()));
  folder.write("job.toml", kJob);
  const auto json_of = [&](const std::string& command) {
    const auto run = run_camber(folder, command + " --json r.json");
    EXPECT_TRUE(run.status == 0 || run.status == 3) << command << "\n" << run.err;
    return json::parse(file_text(folder / "r.json"));
  };
  const json feed = json_of("feed p.nc --machine m.toml"), time = json_of("time p.nc --machine m.toml");
  const double time_s = feed["time_s"];
  EXPECT_NEAR(time["cutting_s"].get<double>() + time["positioning_s"].get<double>() + time["dwell_s"].get<double>(),
              time_s, kMicrosecond);
  EXPECT_NEAR(time["cutting_s"], feed["cutting_time_s"], kMicrosecond);
  EXPECT_NEAR(json_of("predict job.toml -o map.ply")["machine_time_s"], time_s, kMicrosecond);
  EXPECT_NEAR(json_of("compensate job.toml --dry-run")["machine_time_s"]["before"], time_s, kMicrosecond);
  EXPECT_NEAR(json_of("resegment p.nc --machine m.toml --tolerance-mm 0.01 -o out.nc")["time_before_s"], time_s,
              kMicrosecond);
}

INSTANTIATE_TEST_SUITE_P(
    Laws, OneModel,
    testing::Values("[cycle]\nm_code_s = 0.3\n",
                    "[cycle]\nacceleration_law = \"exponential\"\ntime_constant_1_ms = 32\ntime_constant_2_ms = 33\n",
                    "[cycle]\nacceleration_law = \"bell\"\nbell_time_ms = 40\nrapid_path = \"linear\"\n",
                    "[cycle]\narc_acceleration_mm_per_s2 = 200\narc_tolerance_mm = 0.005\njerk_filter_ms = 12\n"
                    "linear_acceleration_mm_per_s2 = 700\n",
                    "[cycle]\nfeed_override_percent = 60\nrapid_override_percent = 25\nrapid_overlap_percent = 40\n"
                    "[tool_change]\nchip_to_chip_s = 4\nx_mm = 60\ny_mm = 60\nz_mm = 90\n"));

}  // namespace
}  // namespace camber
