#include <gtest/gtest.h>

#include "machine/machine_model.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

struct ReadResult {
  Machine machine;
  std::string messages;
};

ReadResult read(const std::string& text, const std::string& ini = {}) {
  const tests::TempFolder folder;
  if (!ini.empty()) folder.write("mill.ini", ini);
  Diagnostics diagnostics;
  ReadResult result;
  try {
    result.machine = read_machine(folder.write("m.toml", text), diagnostics);
  } catch (const InputError& problem) {
    result.messages = tests::replaced(problem.what(), folder.path() + "/", "");
  }
  return result;
}

TEST(SourceParameters, Fanuc) {
  const ReadResult t = read("[source.fanuc]\n1825 = [3000, 4000, 5000]\n1783 = 400\n1420 = 24000\n");
  EXPECT_EQ(t.messages, "");
  EXPECT_DOUBLE_EQ(t.machine.axis[1].position_gain_per_s, 40);
  EXPECT_DOUBLE_EQ(t.machine.axis[2].max_velocity_mm_per_s, 400);
  EXPECT_EQ(t.machine.control.corner.law, CornerLaw::speed_difference);
  EXPECT_NEAR(t.machine.control.corner.speed_difference_mm_per_s, 400.0 / 60, 1e-12);
  ASSERT_EQ(t.machine.translation.size(), 7u);
  EXPECT_EQ(t.machine.translation[0], "fanuc 1825 = 3000 0.01/s: axis.x.position_gain_per_s = 30");
  EXPECT_EQ(t.machine.translation[6],
            "fanuc 1783 = 400 mm/min: control.corner = { law = \"speed_difference\", speed_difference_mm_per_min = "
            "400 }");
}

TEST(SourceParameters, SinumerikAndWhatTheFileSaysBesideIt) {
  const ReadResult t = read(
      "[source.sinumerik]\nMD32200 = 2\nMD32300 = [3, 3, 2]\nMD32431 = 50\n[axis.z]\nacceleration_mm_per_s2 = 1500\n");
  EXPECT_EQ(t.messages, "");
  EXPECT_NEAR(t.machine.axis[0].position_gain_per_s, 33.333, 1e-3);
  EXPECT_DOUBLE_EQ(t.machine.axis[0].acceleration_mm_per_s2, 3000);
  EXPECT_DOUBLE_EQ(t.machine.axis[1].jerk_mm_per_s3, 50000);
  EXPECT_DOUBLE_EQ(t.machine.axis[2].acceleration_mm_per_s2, 1500);
}

TEST(SourceParameters, LinuxCncIni) {
  const ReadResult t = read("[source.linuxcnc]\nini = \"mill.ini\"\n",
                            "[TRAJ]\nLINEAR_UNITS = inch\nARC_BLEND_OPTIMIZATION_DEPTH = 100 # blocks\n"
                            "[EMCMOT]\nSERVO_PERIOD = 1000000\n[AXIS_X]\nMAX_VELOCITY = 4\nMAX_ACCELERATION = 20.0\n"
                            "[JOINT_1]\nMAX_ACCELERATION = 10\n");
  EXPECT_EQ(t.messages, "");
  EXPECT_DOUBLE_EQ(t.machine.axis[0].max_velocity_mm_per_s, 101.6);
  EXPECT_DOUBLE_EQ(t.machine.axis[1].acceleration_mm_per_s2, 254);
  EXPECT_EQ(t.machine.axis[2].acceleration_mm_per_s2, kNoLimit);
  EXPECT_EQ(t.machine.control.lookahead_blocks, 100);
  EXPECT_EQ(t.machine.translation[1],
            "linuxcnc [AXIS_X]MAX_ACCELERATION = 20 inch/s2: axis.x.acceleration_mm_per_s2 = 508");
}

TEST(SourceParameters, ToldErrors) {
  EXPECT_EQ(read("[source.fanuc]\n1825 = [3000, 4000]\n").messages,
            "m.toml:2:8: error: 1825 has 2 numbers; one number, or one for each of x, y and z was expected "
            "[value-count]\n    1825 = [3000, 4000]\n           ^");
  EXPECT_EQ(read("[source.linuxcnc]\nini = \"none.ini\"\n").messages,
            "m.toml:2:7: error: ini is \"none.ini\", which is no file beside m.toml [source-ini]\n"
            "    ini = \"none.ini\"\n          ^");
  EXPECT_NE(read("[source.fanuc]\n1826 = 3\n").messages.find("1826"), std::string::npos);
}

}  // namespace
}  // namespace camber::machine
