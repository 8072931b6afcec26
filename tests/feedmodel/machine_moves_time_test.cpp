// Times of moves in tilted frames, under G254 and to machine coordinates, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/units.h"
#include "feedmodel/cycle_time.h"
#include "feedmodel/timed_path.h"
#include "kinematics/program_joints.h"
#include "nc/frames.h"
#include "tests/feedmodel/rotary_programs.h"

namespace camber::feedmodel {
namespace {

using rotary_tests::cutting_time_s;
using rotary_tests::fast_machine;
using rotary_tests::kPeriodS;
using rotary_tests::kProlog;
using rotary_tests::motion_time_s;
using rotary_tests::moves_of;

constexpr double kSameS = 1e-6;
const std::string kPocket =
    "G0 X-20 Y-10 Z5\nG4 P0.1\nG1 Z0 F600\nX15 F2000\nG3 X20 Y-5 R5\nG1 Y10\nX-15\nG2 X-20 Y5 Z-1 I0 J-5\nG1 Y-10\n"
    "G18 G2 X-10 Z-1 R6\nG17 G1 X0\nG0 Z20\n";

/// A limit along the path alone, so that turned motion takes the time of upright motion.
machine::Machine even_machine(const std::string& name) {
  machine::Machine m = fast_machine(name, 60);
  m.control.corner = {.law = machine::CornerLaw::angle, .time_s = 0.02};
  m.control.path_acceleration_mm_per_s2 = 800;
  return m;
}

TEST(TiltedFrameTime, IsThatOfTheUprightPocket) {
  for (const char* name : {"table_ac_linuxcnc", "head_table", "head_head", "nutating_head"}) {
    const machine::Machine m = even_machine(name);
    const auto upright = moves_of(kProlog + "G43 H1\n" + kPocket, m);
    const auto tilted = moves_of(kProlog + "G0 X0 Y0 Z90\nG68.2 X3 Y4 Z5 I30 J20 K15\nG53.1\nG43 H1\n" + kPocket, m);
    EXPECT_GT(cutting_time_s(upright, m), 4) << name;
    EXPECT_NEAR(cutting_time_s(tilted, m), cutting_time_s(upright, m), kSameS) << name;
  }
}

/// The head leans to X by 60 degrees: Y of the plane is cos 60 along -X and sin 60 along Z of the machine.
TEST(TiltedFrameTime, IsThatOfTheSlowestLinearAxis) {
  machine::Machine m = fast_machine("head_table", 60);
  m.axis[2].max_velocity_mm_per_s = 10;
  const std::string text = kProlog + "G0 X0 Y0 Z90\nG68.2 I90 J60\nG53.1\nG43 H1\nG0 X0 Y0 Z10\nG1 Y100 F6000\n";
  EXPECT_NEAR(cutting_time_s(moves_of(text, m), m), 100 * std::sin(kPi / 3) / 10, kSameS);
  m.axis[2].max_velocity_mm_per_s = machine::kNoLimit;
  m.axis[0].acceleration_mm_per_s2 = 200;  // 400 along the plane
  EXPECT_NEAR(cutting_time_s(moves_of(text, m), m), 100.0 / 100 + 100.0 / 400, kSameS);
}

/// Where the linear axes are not square to each other arcs stay in the part's frame, and keep F there.
TEST(TiltedFrameTime, OfArcsAmongAxesThatAreNotSquare) {
  machine::Machine m = fast_machine("table_bc", 60);
  m.kinematics.chain = "cxbyz";
  m.kinematics.table_axes = 3;
  const auto program = moves_of(
      kProlog + "G0 X0 Y0 Z90\nG68.2 J25\nG53.1\nG43 H1\nG0 X0 Y0 Z0\nG2 X0 Y0 I-10 F1200\nG4 P0.1\nG1 X5\n", m);
  EXPECT_NEAR(cutting_time_s(program, m), (2 * kPi * 10 + 5) / 20, 1e-3);
}

TEST(TiltedFrameTime, CountsTheTurnOfG531) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  m.rotary[0].acceleration_rad_per_s2 = rad_from_deg(100);
  const auto program = moves_of(kProlog + "G0 X0 Y0 Z0\nG68.2 J30\nG53.1\n", m);
  EXPECT_NEAR(motion_time_s(program, m), 30.0 / 20 + 20.0 / 100, kPeriodS);
}

TEST(DynamicOffsetTime, IsThatOfTheAxes) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  m.axis[1].max_velocity_mm_per_s = 8;
  const auto program = moves_of(kProlog + "G43 H1\nG254\nG0 X0 Y0 Z20\nG0 A-30\nG0 X0 Y0 Z5\nG1 Y-40 F6000\nG255\n", m);
  EXPECT_NEAR(cutting_time_s(program, m), 40.0 / 8, kSameS);
}

TEST(MachineTargetTime, OfAKnownPlaceIsThatOfTheAxis) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  m.axis[2].max_velocity_mm_per_s = 50;
  m.axis[2].acceleration_mm_per_s2 = 500;
  // Z 10 above an offset of -300 with a tool of 80: the axis is at -210. Then back.
  const auto program = moves_of("G21 G90 G94 G10 L2 P1 X0 Y0 Z-300\nG54 G43 H1\nG0 X0 Y0 Z10\nG53 Z0\nG0 Z10\n", m);
  const auto rotary =
      moves_of("G21 G90 G94 G10 L2 P1 X0 Y0 Z-300\nG54 G43 H1\nG0 X0 Y0 Z10\nG53 Z0\nG0 Z10\nG0 A-10\n", m);
  EXPECT_EQ(motion_time_s(program, m), 0);  // without rotary words the reference point is not known (cycle-time.md)
  EXPECT_NEAR(motion_time_s(rotary, m), 2 * (210.0 / 50 + 50.0 / 500) + 10.0 / 20, 3 * kPeriodS);
}

TEST(MachineTargetTime, OfAnUnknownReferencePointIsThatOfTheRotaryAxes) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  const auto program = moves_of(kProlog + "G43 H1\nG0 X0 Y0 Z10 A-40\nG28 X0 Y0 Z10 A-40\nM30\n", m);
  EXPECT_NEAR(motion_time_s(program, m), 2 * 40.0 / 20, 3 * kPeriodS);
  EXPECT_EQ(cycle_time(program, m).unplaced_moves, 2U);  // to the start of the program, and to the reference point
}

// --- clamps

TEST(ClampTime, OfAxesWithCodesIsBookedWhereTheyAreReleased) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  m.rotary[0].clamp_s = 0.4;
  const std::string text = kProlog + "G43 H1\nG0 X0 Y0 Z10\nM11\nG0 A-40\nG0 A-20\nM10\nG1 X10 F1000\n";
  EXPECT_NEAR(cycle_time(moves_of(text, m), m).all.time.index_s, 0.8, 1e-12);  // each positioning
  m.rotary[0].clamp_m = 10, m.rotary[0].unclamp_m = 11;
  EXPECT_NEAR(cycle_time(moves_of(text, m), m).all.time.index_s, 0.4, 1e-12);  // M11
}

// --- poses

/// The tip runs along the plane while the joints are those of the machine.
TEST(TiltedFramePrediction, KeepsTheTipInThePlane) {
  const machine::Machine m = even_machine("head_head");
  const auto program = moves_of(kProlog + "G0 X0 Y0 Z90\nG68.2 X3 Y4 Z5 I30 J20 K15\nG53.1\nG43 H1\n" + kPocket, m);
  const Eigen::Matrix3d plane = nc::euler_zxz({rad_from_deg(30), rad_from_deg(20), rad_from_deg(15)});
  double lowest = 1e9, highest = -1e9, off = 0;
  predict_joints(program, m, [&](std::span<const TimedSample> samples, std::span<const JointSample> joints) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (program.moves[samples[i].move].kind == nc::MoveKind::rapid) continue;
      const Vec3 p = plane.transpose() * (joints[i].command_tool.tip_mm - Vec3(3, 4, 5));
      lowest = std::min(lowest, p.z());
      highest = std::max(highest, p.z());
      off = std::max(off, (joints[i].command_tool.axis - plane.col(2)).norm());
    }
  });
  EXPECT_NEAR(lowest, -1 - (6 - std::sqrt(11.0)), 0.05);  // the sagitta of the arc in G18, rounded at its ends
  EXPECT_NEAR(highest, 5, 1e-6);
  EXPECT_LE(off, 1e-12);
}

}  // namespace
}  // namespace camber::feedmodel
