// Every type of cutter, its teeth, neck and holder, and the blank, read from a job; whole messages.
#include <gtest/gtest.h>

#include "base/units.h"
#include "machine/job_file.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

struct Result {
  Job job;
  std::string messages;
};

/// A job whose [tool.1] holds `tool` from line 4 on.
Result read(const std::string& tool, const std::string& stock = "box_mm = [[0, 0, -20], [50, 40, 5]]") {
  const tests::TempFolder folder;
  folder.write("finish.nc", "G21\nM30\n");
  folder.write("machine.toml", "[axis.x]\nstiffness_N_per_um = 40.0\n");
  const std::string path =
      folder.write("job.toml", "program = \"finish.nc\"\nmachine = \"machine.toml\"\n[tool.1]\n" + tool +
                                   "\n[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\n" + stock + "\n");
  Result result;
  Diagnostics diagnostics;
  try {
    result.job = read_job(path, diagnostics);
    for (const auto& d : diagnostics.all()) result.messages += to_string(d) + "\n";
    // What --effective-config prints is read back to the same tool.
    const std::string again = folder.write("again.toml", to_toml(result.job));
    Diagnostics none;
    EXPECT_EQ(to_toml(read_job(again, none)), to_toml(result.job));
  } catch (const InputError& problem) {
    result.messages = problem.what();
  }
  result.messages = tests::replaced(result.messages, folder.path() + "/", "");
  return result;
}

const std::string kRest = "\nflutes = 3\noverhang_mm = 40\n";

TEST(ToolReader, ReadsMeasuredModes) {
  const auto r = read("type = \"flat\"\ndiameter_mm = 10" + kRest +
                      "density_kg_per_m3 = 8000\n[[tool.1.mode]]\ndirection = \"x\"\nfrequency_Hz = 920.5\n"
                      "damping_percent = 1.1\nstiffness_N_per_um = 1.34\n[[tool.1.mode]]\ndirection = \"y\"\n"
                      "frequency_Hz = 950\ndamping_percent = 2\nstiffness_N_per_um = 3\n[[workpiece.mode]]\n"
                      "direction = \"y\"\nfrequency_Hz = 300\ndamping_percent = 3\nstiffness_N_per_um = 40");
  ASSERT_EQ(r.messages, "");
  const Tool& t = r.job.tools.at(1);
  EXPECT_EQ(t.density_kg_per_m3, 8000);
  ASSERT_EQ(t.modes.size(), 2u);
  EXPECT_EQ(t.modes[0].direction, Vec2(1, 0));
  EXPECT_EQ(t.modes[0].frequency_hz, 920.5);
  EXPECT_NEAR(t.modes[0].damping_ratio, 0.011, 1e-15);
  EXPECT_NEAR(t.modes[0].stiffness_N_per_mm, 1340, 1e-9);
  EXPECT_EQ(t.modes[1].direction, Vec2(0, 1));
  ASSERT_EQ(r.job.workpiece_modes.size(), 1u);
  EXPECT_EQ(r.job.workpiece_modes[0].frequency_hz, 300);
}

TEST(ToolReader, RefusesModesThatAreNone) {
  const std::string tool = "type = \"flat\"\ndiameter_mm = 10" + kRest;
  const auto messages = [&](const std::string& mode) { return read(tool + "[[tool.1.mode]]\n" + mode).messages; };
  EXPECT_EQ(messages("direction = \"z\"\nfrequency_Hz = 900\ndamping_percent = 1\nstiffness_N_per_um = 2"),
            "job.toml:9:13: error: direction is \"z\"; \"x\" or \"y\" was expected [value-choice]\n"
            "    direction = \"z\"\n                ^");
  EXPECT_EQ(
      messages("direction = \"x\"\nfrequency_Hz = 900\nstiffness_N_per_um = 2"),
      "job.toml:8:1: error: damping_percent is missing in [[mode]]; a number greater than zero and at most 100 was "
      "expected [key-missing]\n    [[tool.1.mode]]\n    ^");
  EXPECT_EQ(messages("direction = \"x\"\nfrequency_Hz = 900\ndamping_percent = 0\nstiffness_N_per_um = 2"),
            "job.toml:11:19: error: damping_percent is 0; a number greater than zero and at most 100 was expected "
            "[value-range]\n    damping_percent = 0\n                      ^");
  EXPECT_EQ(messages("direction = \"x\"\nfrequency_Hz = 900\ndamping_percent = 1\nstiffness = 2"),
            "job.toml:8:1: error: stiffness_N_per_um is missing in [[mode]]; a number greater than zero was expected "
            "[key-missing]\n    [[tool.1.mode]]\n    ^\n"
            "job.toml:12:1: error: unknown key stiffness in [[mode]]; did you mean stiffness_N_per_um? [key-unknown]\n"
            "    stiffness = 2\n    ^");
  EXPECT_EQ(read(tool + "mode = 3").messages,
            "job.toml:8:8: error: mode is a number; a list of tables [[mode]] was expected [value-type]\n"
            "    mode = 3\n           ^");
}

TEST(ToolReader, ReadsATaperedBallWithEverythingAToolCanHave) {
  const auto r = read("type = \"tapered_ball\"\ndiameter_mm = 4\ntaper_deg = 5" + kRest +
                      "flute_length_mm = 15\nneck_diameter_mm = 6\nneck_length_mm = 10\nshank_diameter_mm = 8\n"
                      "holder_mm = [[20, 20, 10], [20, 40, 15]]\nhelix_deg = 30\npitch_deg = [118, 122, 120]\n"
                      "runout_um = 8\nrunout_angle_deg = 45\nshear = true");
  ASSERT_EQ(r.messages, "");
  const Tool& t = r.job.tools.at(1);
  EXPECT_EQ(t.type, ToolType::tapered_ball);
  EXPECT_NEAR(t.taper_rad, rad_from_deg(5), 1e-15);
  EXPECT_NEAR(t.pitch_rad.at(1), rad_from_deg(122), 1e-15);
  EXPECT_NEAR(t.runout_mm, 0.008, 1e-15);
  EXPECT_NEAR(t.runout_angle_rad, rad_from_deg(45), 1e-15);
  EXPECT_EQ(t.neck_diameter_mm, 6);
  ASSERT_EQ(t.holder.size(), 2u);
  EXPECT_EQ(t.holder[1].upper_diameter_mm, 40);
  EXPECT_TRUE(t.shear);
  EXPECT_EQ(r.job.machine.axis[0].stiffness_N_per_mm, 40000);
}

TEST(ToolReader, ReadsChamferDrillAndGeneral) {
  auto r = read("type = \"chamfer\"\ndiameter_mm = 10\ntip_diameter_mm = 2\npoint_angle_deg = 90" + kRest);
  ASSERT_EQ(r.messages, "");
  EXPECT_EQ(r.job.tools.at(1).tip_diameter_mm, 2);
  r = read("type = \"drill\"\ndiameter_mm = 8" + kRest);
  ASSERT_EQ(r.messages, "");
  EXPECT_NEAR(r.job.tools.at(1).point_angle_rad, rad_from_deg(118), 1e-15);
  r = read(
      "type = \"general\"\ndiameter_mm = 12\ncorner_radius_mm = 2\ncorner_centre_r_mm = 4.2\n"
      "corner_centre_z_mm = 2.3\nbottom_angle_deg = 6\ntaper_deg = 4\nflute_length_mm = 14" +
      kRest);
  ASSERT_EQ(r.messages, "");
  EXPECT_EQ(r.job.tools.at(1).corner_centre_z_mm, 2.3);
}

TEST(ToolReader, SaysWhatAToolLacks) {
  EXPECT_EQ(read("type = \"chamfer\"\ndiameter_mm = 10" + kRest).messages,
            "job.toml:3:1: error: point_angle_deg is missing in [tool.1]; a number from 10 to 170 was expected "
            "[key-missing]\n"
            "    [tool.1]\n"
            "    ^");
  EXPECT_EQ(
      read("type = \"ball\"\ndiameter_mm = 10\ntaper_deg = 3" + kRest).messages,
      "job.toml:6:1: error: taper_deg does not belong to type \"ball\"; it is for \"tapered_ball\" or \"general\" "
      "[key-unused]\n"
      "    taper_deg = 3\n"
      "    ^");
  EXPECT_EQ(read("type = \"chamfer\"\ndiameter_mm = 10\ntip_diameter_mm = 10\npoint_angle_deg = 90" + kRest).messages,
            "job.toml:6:19: error: tip_diameter_mm is 10; less than the diameter, 10, was expected [tool-shape]\n"
            "    tip_diameter_mm = 10\n"
            "                      ^");
  EXPECT_EQ(read("type = \"general\"\ndiameter_mm = 12\ncorner_radius_mm = 2\ncorner_centre_z_mm = 5" + kRest).messages,
            "job.toml:4:1: error: the profile does not close: the corner's arc does not reach the bottom "
            "(docs/cutters.md) [tool-shape]\n"
            "    type = \"general\"\n"
            "    ^");
}

TEST(ToolReader, RefusesTeethAndNecksThatDoNotFit) {
  EXPECT_EQ(read("type = \"ball\"\ndiameter_mm = 10" + kRest + "pitch_deg = [120, 120, 110]").messages,
            "job.toml:8:13: error: pitch_deg add up to 350; 360 was expected [tool-shape]\n"
            "    pitch_deg = [120, 120, 110]\n"
            "                ^");
  EXPECT_EQ(read("type = \"ball\"\ndiameter_mm = 10" + kRest + "pitch_deg = [180, 180]").messages,
            "job.toml:8:13: error: pitch_deg has 2 numbers; an angle for each of the 3 flutes, as in [118, 122, 120], "
            "was expected [value-count]\n"
            "    pitch_deg = [180, 180]\n"
            "                ^");
  EXPECT_EQ(read("type = \"ball\"\ndiameter_mm = 10" + kRest +
                 "flute_length_mm = 20\nneck_diameter_mm = 9\n"
                 "neck_length_mm = 25")
                .messages,
            "job.toml:10:18: error: flutes and neck are 45 long; at most the overhang, 40, was expected [tool-shape]\n"
            "    neck_length_mm = 25\n"
            "                     ^");
  EXPECT_EQ(
      read("type = \"ball\"\ndiameter_mm = 10" + kRest + "holder_mm = [[20, 10]]").messages,
      "job.toml:8:13: error: holder_mm: rows of lower diameter, upper diameter, length from the holder's face up, "
      "as in [[32, 32, 20], [32, 50, 15]], was expected [value-count]\n"
      "    holder_mm = [[20, 10]]\n"
      "                ^");
}

TEST(StockReader, ReadsACylinderAndRefusesTwoBlanks) {
  const std::string tool = "type = \"ball\"\ndiameter_mm = 10" + kRest;
  auto r = read(tool, "cylinder = { base_mm = [1, 2, -30], diameter_mm = 60, height_mm = 30 }");
  ASSERT_EQ(r.messages, "");
  EXPECT_EQ(r.job.stock.cylinder->base_mm.z(), -30);
  EXPECT_EQ(r.job.stock.cylinder->diameter_mm, 60);
  EXPECT_EQ(read(tool, "box_mm = [[0, 0, 0], [1, 1, 1]]\nvdb = \"finish.nc\"").messages,
            "job.toml:14:1: error: the stock has box_mm and vdb; one of them was expected [stock-shape]\n"
            "    vdb = \"finish.nc\"\n"
            "    ^");
  EXPECT_EQ(
      read(tool, "cylinder = { diameter_mm = 60, height_mm = 30 }").messages,
      "job.toml:13:12: error: base_mm is missing in [stock.cylinder]; [x, y, z], the middle of the lower face, was "
      "expected [key-missing]\n"
      "    cylinder = { diameter_mm = 60, height_mm = 30 }\n"
      "               ^");
}

}  // namespace
}  // namespace camber::machine
