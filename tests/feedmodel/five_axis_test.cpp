// Programs with rotary axes: times and joints against closed forms and against the traces of a real control.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "base/units.h"
#include "feedmodel/motion_plan.h"
#include "feedmodel/timed_path.h"
#include "kinematics/joint_map.h"
#include "kinematics/program_joints.h"
#include "tests/feedmodel/rotary_programs.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/test_data.h"

namespace camber::feedmodel {
namespace {

using rotary_tests::cutting_time_s;
using rotary_tests::fast_machine;
using rotary_tests::kPeriodS;
using rotary_tests::kProlog;
using rotary_tests::kToolMm;
using rotary_tests::moves_of;
using rotary_tests::traced_machine;

// --- closed forms

TEST(FiveAxis, AFixedTipTiltsInTheTimeOfItsRotaryAxis) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  m.rotary[0].acceleration_rad_per_s2 = rad_from_deg(100);
  const auto program = moves_of(kProlog + "G43.4 H1\nG0 X0 Y0 Z0\nG1 A-45 F100000\n", m);
  EXPECT_NEAR(cutting_time_s(program, m), 45.0 / 20 + 20.0 / 100, 1e-6);
  // F600 is 10 degrees/s
  const auto slow = moves_of(kProlog + "G43.4 H1\nG0 X0 Y0 Z0\nG1 A-45 F600\n", m);
  EXPECT_NEAR(cutting_time_s(slow, m), 45.0 / 10 + 10.0 / 100, 1e-6);
}

/// A linear axis that is the slowest all the way goes at its limit all the way.
TEST(FiveAxis, AFixedTipTiltsInTheTimeOfTheLinearAxisThatFollowsIt) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 1e6);
  m.axis[1].max_velocity_mm_per_s = 30;
  const auto program = moves_of(kProlog + "G43.4 H1\nG0 X0 Y0 Z100\nG1 A-30 F1000000\n", m);
  const kinematics::JointMap map(m, program);
  const Turn turn{.tip_control = true, .tool_length_mm = kToolMm};
  const auto y = [&](double a_deg) {
    return joints_of(map, {{0, 0, 100}, {rad_from_deg(a_deg), 0, 0}}, turn).linear_mm.y();
  };
  // In pieces of a degree, each at the speed of its fastest end.
  EXPECT_NEAR(cutting_time_s(program, m), std::abs(y(-30) - y(0)) / 30, 0.01 * std::abs(y(-30) - y(0)) / 30);
}

TEST(FiveAxis, AFanTakesTheTimeOfTheSlowerOfTipAndTilt) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 20);
  m.rotary[0].acceleration_rad_per_s2 = rad_from_deg(100);
  const std::string fan = kProlog + "G43.4 H1\nG0 X0 Y0 Z0\nG1 X40 A-45 F";
  EXPECT_NEAR(cutting_time_s(moves_of(fan + "100000\n", m), m), 45.0 / 20 + 20.0 / 100, 1e-6);
  // 5 mm/s along the tip; A takes 0.2 s to its 5.625 degrees/s: a = 100 x 40 / 45 along the path
  const double acceleration = 100.0 * 40 / 45;
  EXPECT_NEAR(cutting_time_s(moves_of(fan + "300\n", m), m), 40.0 / 5 + 5.0 / acceleration, 1e-6);
}

TEST(FiveAxis, ThePoleTakesTheHalfTurnOfC) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 60);
  m.rotary[2].acceleration_rad_per_s2 = rad_from_deg(300);
  const auto program = moves_of(kProlog + "G43.4 H1\nG0 X0 Y0 Z0 A-1\nG1 X1 C180 F3000\n", m);
  EXPECT_NEAR(cutting_time_s(program, m), 180.0 / 60 + 60.0 / 300, 1e-6);
}

/// Two directions in the part's frame, written once (G43.5), on machines of four kinds.
class FourMachines : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Samples, FourMachines,
                         testing::Values("table_ac_linuxcnc", "table_bc", "head_table", "head_head", "nutating_head"));

TEST_P(FourMachines, TheSamePathTakesTheTimeOfTheSlowestJoint) {
  machine::Machine m = fast_machine(GetParam(), 20);
  const auto program = moves_of(kProlog +
                                    "G43.5 H1\nG0 X0 Y0 Z0 I0 J0.17364818 K0.98480775\n"
                                    "G1 X10 I0.5 J0.4 K0.76811457 F1000000\n",
                                m);
  kinematics::ProgramJoints joints(m, program);
  Vec3 turn = Vec3::Zero();
  while (!joints.done()) {
    const kinematics::MoveJoints& now = joints.next();
    ASSERT_EQ(now.reach, kinematics::Reach::reached);
    turn = (now.end_rad - now.start_rad).cwiseAbs();
  }
  ASSERT_GT(turn.maxCoeff(), 0.1);
  EXPECT_NEAR(cutting_time_s(program, m), deg_from_rad(turn.maxCoeff()) / 20, 1e-6);
}

/// The tool's direction at a tilt from Z, towards an azimuth from X, as words of G43.5.
std::string direction(double tilt_deg, double azimuth_deg) {
  const double tilt = rad_from_deg(tilt_deg), azimuth = rad_from_deg(azimuth_deg);
  return fmt::format(" I{:.9f} J{:.9f} K{:.9f}", std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                     std::cos(tilt));
}

/// One path of the part from a tilt of 10 degrees to one of 50, on each machine: two axes tilt by the angle itself, the
/// nutating head turns by b with cos(tilt) = (1 + cos b) / 2 about an axis of 45 degrees.
TEST_P(FourMachines, ATiltTakesTheTimeOfTheAxisThatTilts) {
  const auto turn_deg = [&](double tilt_deg) {
    const bool nutates = GetParam() == std::string("nutating_head");
    return nutates ? deg_from_rad(std::acos(2 * std::cos(rad_from_deg(tilt_deg)) - 1)) : tilt_deg;
  };
  machine::Machine m = fast_machine(GetParam(), 20);
  const std::string start = kProlog + "G43.5 H1\nG0 X0 Y0 Z0" + direction(10, 90) + "\nG1";
  const double rotary_s = (turn_deg(50) - turn_deg(10)) / 20;
  EXPECT_NEAR(cutting_time_s(moves_of(start + " X0" + direction(50, 90) + " F1000000\n", m), m), rotary_s, 1e-6);
  // A fan: the tip takes 4 s at F600, longer than the tilt.
  EXPECT_NEAR(cutting_time_s(moves_of(start + " X40" + direction(50, 90) + " F600\n", m), m), 4, 1e-6);
  EXPECT_NEAR(cutting_time_s(moves_of(start + " X1" + direction(50, 90) + " F600\n", m), m), rotary_s, 1e-6);
}

/// A degree off the pole a quarter of a turn around it is one of C, however short the way.
TEST_P(FourMachines, AroundThePoleTakesTheTimeOfC) {
  const machine::Machine m = fast_machine(GetParam(), 20);
  const auto around =
      moves_of(kProlog + "G43.5 H1\nG0 X0 Y0 Z0" + direction(1, 90) + "\nG1 X1" + direction(1, 0) + " F6000\n", m);
  EXPECT_NEAR(cutting_time_s(around, m), 90.0 / 20, 1e-6);
}

/// A table that tilts about X and Y has its pole elsewhere: both turn by about a degree.
TEST(FiveAxis, AnUprightToolIsNoPoleOfATableThatTiltsTwice) {
  const machine::Machine m = fast_machine("table_ab", 20);
  const auto around =
      moves_of(kProlog + "G43.5 H1\nG0 X0 Y0 Z0" + direction(1, 90) + "\nG1 X0.1" + direction(1, 0) + " F6000\n", m);
  EXPECT_NEAR(cutting_time_s(around, m), 1.0 / 20, 1e-4);
}

// --- what F means

TEST(FiveAxis, FCountsWhatTheControlCounts) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 1e9);
  const std::string block = kProlog + "G0 X0 Y0 Z0\nG1 X30 C40 F600\n";
  EXPECT_NEAR(cutting_time_s(moves_of(block, m), m), 50.0 / 10, 1e-9);
  m.control.rotary_feed = machine::RotaryFeed::linear;
  EXPECT_NEAR(cutting_time_s(moves_of(block, m), m), 30.0 / 10, 1e-9);
  const std::string inverse = kProlog + "G0 X0 Y0 Z0\nG93 G1 X30 C40 F12\nG1 C0 F30\n";
  EXPECT_NEAR(cutting_time_s(moves_of(inverse, m), m), 60.0 / 12 + 60.0 / 30, 1e-9);
  // degrees per minute in inches, too
  const std::string inch = "G20 G90 G94\nG0 X0 Y0 Z0\nG1 C40 F600\n";
  EXPECT_NEAR(cutting_time_s(moves_of(inch, m), m), 40.0 / 10, 1e-9);
}

// --- drives

TEST(FiveAxis, ADriveOfARotaryAxisLagsInDegrees) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 1e9);
  m.rotary[2].position_gain_per_s = 25;
  const auto program = moves_of("G21 G90 G94\nG0 X0 Y0 Z0\nG1 C100 F600\n", m);
  double lag_deg = 0;
  predict_joints(program, m, [&](std::span<const TimedSample> samples, std::span<const JointSample> joints) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples[i].t_s > 5 && samples[i].t_s < 9)
        lag_deg = deg_from_rad(joints[i].command_rad.z() - joints[i].position_rad.z());
  });
  EXPECT_NEAR(lag_deg, 10.0 / 25, 1e-6);  // v / Kp
}

/// The tip stands still while A tilts: with drives that lag alike the tip stays, with a slow A it is off by about what
/// the others have gone ahead.
TEST(FiveAxis, DrivesThatDifferMoveATipThatShouldStandStill) {
  machine::Machine m = fast_machine("table_ac_linuxcnc", 1e9);
  for (int i = 0; i < 3; ++i)
    m.axis[i].position_gain_per_s = m.rotary[static_cast<std::size_t>(i)].position_gain_per_s = 40;
  const auto program = moves_of(kProlog + "G43.4 H1\nG0 X0 Y0 Z0\nG1 A-60 F600\n", m);
  const auto contour = [&] { return *predict_joints(program, m, [](const auto&, const auto&) {}).contour; };
  const PoseContourFigures alike = contour();
  EXPECT_LT(alike.tip_max_mm, 0.02);
  m.rotary[0].position_gain_per_s = 20;
  const PoseContourFigures slow = contour();
  // A is 10/20 - 10/40 = 0.25 degrees behind the others, at about 100 mm from its axis.
  EXPECT_GT(slow.tip_max_mm, 0.2);
  EXPECT_LT(slow.tip_max_mm, 1.0);
}

// --- traces of a real control

struct Traced {
  std::string program;
  std::map<unsigned, int> cycles;  ///< of each line
};

Traced traced(const std::string& name) {
  Traced out;
  out.program = tests::data_path("linuxcnc5/programs/" + name + ".ngc");
  const std::string text = SourceText::read(tests::unpacked_data("linuxcnc5/" + name + "_t.csv")).text();
  std::istringstream lines(text);
  std::string line, cell;
  std::getline(lines, line);
  std::size_t at = 0;
  for (std::istringstream head(line); std::getline(head, cell, ',') && cell != "line";) ++at;
  while (std::getline(lines, line)) {
    std::size_t from = 0;
    for (std::size_t i = 0; i < at; ++i) from = line.find(',', from) + 1;
    ++out.cycles[static_cast<unsigned>(std::stoul(line.substr(from)))];
  }
  return out;
}

class TracedPrograms : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(LinuxCnc, TracedPrograms,
                         testing::Values("rotary_g61", "rotary_g64", "combined_g94_g61", "combined_g94_g64",
                                         "combined_g93_g61", "combined_g93_g64", "tcp_fixed_g61", "tcp_fan_g64",
                                         "tcp_sphere_normal_g64", "tcp_dome_g61", "tcp_dome_g64", "tcp_singular_g64"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(TracedPrograms, EveryPartTakesTheTimeThatTheControlTook) {
  constexpr double kCycles = 2;  // the line changes at one end or the other of a cycle
  const Traced trace = traced(GetParam());
  ASSERT_FALSE(trace.cycles.empty());
  const machine::Machine m = traced_machine();
  const auto moves = moves_of(SourceText::read(trace.program), m);
  std::map<unsigned, int> cycles;
  predict_joints(moves, m, [&](std::span<const TimedSample> samples, std::span<const JointSample>) {
    for (const TimedSample& s : samples)
      if (s.feed_command_mm_per_s > 0) ++cycles[moves.moves[s.move].block + 1];
  });
  const auto sum = [](const std::map<unsigned, int>& of, unsigned first, unsigned last) {
    int count = 0;
    for (auto at = of.lower_bound(first); at != of.end() && at->first <= last; ++at) count += at->second;
    return count;
  };
  std::istringstream parts(
      SourceText::read(tests::data_path("linuxcnc5/programs/" + std::string(GetParam()) + ".parts.csv")).text());
  std::string line;
  std::getline(parts, line);
  std::size_t count = 0;
  double longest = 0, longest_model = 0;
  while (std::getline(parts, line)) {
    unsigned first = 0, last = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%u,%u", &first, &last), 2);
    const double measured = sum(trace.cycles, first, last), model = sum(cycles, first, last);
    EXPECT_LE(std::abs(model - measured), kCycles)
        << "lines " << first << " to " << last << ": " << measured << " cycles, model " << model;
    if (measured > longest) longest = measured, longest_model = model;
    ++count;
  }
  EXPECT_GT(count, 0U);
  tests::record_figure("time of the longest part", 100 * (longest_model / longest - 1), 100 * kCycles / longest);
}

/// No joint is commanded faster, or accelerated more, than its axis allows, where the control looks at its joints.
TEST_P(TracedPrograms, WithJointLimitsNoJointExceedsItsLimit) {
  constexpr double kOver = 1.01;
  machine::Machine m = traced_machine();
  m.control.joint_limits = true;
  const auto moves =
      moves_of(SourceText::read(tests::data_path("linuxcnc5/programs/" + std::string(GetParam()) + ".ngc")), m);
  std::vector<std::array<double, 6>> joints;
  predict_joints(moves, m, [&](std::span<const TimedSample> samples, std::span<const JointSample> rotary) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Vec3 &l = samples[i].command_mm, &r = rotary[i].command_rad;
      joints.push_back({l.x(), l.y(), l.z(), r.x(), r.y(), r.z()});
    }
  });
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double v = axis < 3 ? m.axis[axis].max_velocity_mm_per_s : m.rotary[axis - 3].max_velocity_rad_per_s;
    const double a = axis < 3 ? m.axis[axis].acceleration_mm_per_s2 : m.rotary[axis - 3].acceleration_rad_per_s2;
    double fastest = 0, most = 0;
    for (std::size_t k = 2; k < joints.size(); ++k) {
      const double step = joints[k][axis] - joints[k - 1][axis], before = joints[k - 1][axis] - joints[k - 2][axis];
      fastest = std::max(fastest, std::abs(step) / kPeriodS);
      most = std::max(most, std::abs(step - before) / (kPeriodS * kPeriodS));
    }
    EXPECT_LE(fastest, kOver * v) << "xyzabc"[axis];
    EXPECT_LE(most, kOver * a) << "xyzabc"[axis];
  }
}

}  // namespace
}  // namespace camber::feedmodel
