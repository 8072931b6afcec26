// Tilted frames and dynamic work offsets on whole machines, against tool-centre-point control and closed forms.
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "kinematics/control_options.h"
#include "kinematics/pose_track.h"
#include "kinematics/program_joints.h"
#include "kinematics/travel_check.h"
#include "nc/interpreter.h"
#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

using tests::sample;

constexpr double kLengthMm = 100;
/// Programs are written with twelve decimals of a degree and a millimetre.
constexpr double kSameMm = 1e-9;
const std::string kOffset = "G10 L2 P1 X10 Y20 Z-300\nG54\n";

struct Read {
  nc::Program program;
  nc::Interpretation moves;
};

Read read(const std::string& text, const machine::Machine& machine, double tool_length_mm = kLengthMm) {
  nc::InterpreterOptions options;
  options.inch = false;
  options.dialect = *nc::dialect_named("fanuc");
  options.rotary_axes = rotary_options(machine);
  options.tool_offsets[1].length_mm = tool_length_mm;
  Diagnostics diagnostics;
  Read r;
  r.program = nc::read_program(SourceText("p.nc", text), diagnostics);
  r.moves = nc::interpret(r.program, options, diagnostics);
  diagnostics.throw_if_errors();
  return r;
}

std::string said(const std::string& text, const machine::Machine& machine) {
  const Read r = read(text, machine);
  Diagnostics diagnostics;
  check_travel(machine, r.program, r.moves, diagnostics);
  std::string out;
  for (Diagnostic d : diagnostics.all()) {
    d.source_line.clear();
    out += to_string(d) + "\n";
  }
  return out;
}

/// Joints and poses at the ends and the middle of all feed moves.
struct Place {
  Joints joints;
  ToolPose pose;
};
std::vector<Place> cutting_places(const Read& r, const machine::Machine& machine) {
  std::vector<Place> out;
  ProgramJoints joints(machine, r.moves);
  while (!joints.done()) {
    const MoveJoints& now = joints.next();
    const nc::Move& move = r.moves.moves[joints.index()];
    if (move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc) continue;
    EXPECT_TRUE(now.linear_known) << move.block + 1;
    EXPECT_TRUE(now.start_known) << move.block + 1;
    for (const double u : {0.0, 0.3, 1.0}) out.push_back({joints.at(u), *joints.pose_at(u)});
  }
  return out;
}

void expect_same(const std::vector<Place>& a, const std::vector<Place>& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LE((a[i].pose.tip_mm - b[i].pose.tip_mm).norm(), kSameMm) << i;
    EXPECT_LE((a[i].pose.axis - b[i].pose.axis).norm(), 1e-12) << i;
    EXPECT_LE((a[i].joints.linear_mm - b[i].joints.linear_mm).norm(), kSameMm) << i;
    EXPECT_LE((a[i].joints.rotary_rad - b[i].joints.rotary_rad).norm(), 1e-12) << i;
  }
}

/// The angles that put the tool along `axis`, as the words of a program.
std::string angle_words(const machine::Machine& machine, const Vec3& axis) {
  const Chain chain(machine);
  const Solution solution = chain.solve_tool_axis(axis, {});
  EXPECT_EQ(solution.reach, Reach::reached);
  std::string out;
  for (const char letter : chain.rotary_axes())
    out += fmt::format(" {}{:.13f}", static_cast<char>(letter - 'a' + 'A'),
                       deg_from_rad(solution.joints.rotary_rad[letter - 'a']));
  return out;
}

const std::vector<Vec3> kCut{{-8, 3, 0}, {12, 5, -1}, {12, -6, -1.5}, {-8, -6, 0}};

/// The same cut in a tilted plane, once with G68.2 and once with X Y Z of the part under tool-centre-point control.
void compare_with_tip_control(const std::string& name, const Vec3& euler_deg) {
  SCOPED_TRACE(name);
  const machine::Machine machine = sample(name);
  const Vec3 origin(4, -7, 15);
  const Eigen::Matrix3d plane = (Eigen::AngleAxisd(rad_from_deg(euler_deg.x()), Vec3::UnitZ()) *
                                 Eigen::AngleAxisd(rad_from_deg(euler_deg.y()), Vec3::UnitX()) *
                                 Eigen::AngleAxisd(rad_from_deg(euler_deg.z()), Vec3::UnitZ()))
                                    .toRotationMatrix();
  std::string tilted = kOffset + fmt::format("G0 X0 Y0 Z80\nG68.2 X4 Y-7 Z15 I{} J{} K{}\nG53.1\nG43 H1\n",
                                             euler_deg.x(), euler_deg.y(), euler_deg.z());
  std::string tip = kOffset + "G0 X0 Y0 Z80" + angle_words(machine, plane.col(2)) + "\nG43.4 H1\n";
  bool first = true;
  for (const Vec3& p : kCut) {
    const Vec3 in_part = origin + plane * p;
    const char* g = first ? "G0" : "G1 F500";
    tilted += fmt::format("{} X{:.12f} Y{:.12f} Z{:.12f}\n", g, p.x(), p.y(), p.z());
    tip += fmt::format("{} X{:.12f} Y{:.12f} Z{:.12f}\n", g, in_part.x(), in_part.y(), in_part.z());
    first = false;
  }
  expect_same(cutting_places(read(tilted, machine), machine), cutting_places(read(tip, machine), machine));
}

TEST(TiltedFrames, CutTheSamePlaneAsTipControl) {
  for (const char* name : {"table_ac_linuxcnc", "table_bc", "head_table", "head_head", "nutating_head"})
    for (const Vec3& euler : {Vec3(0, 25, 0), Vec3(40, 30, 10), Vec3(90, 30, -90), Vec3(-120, 20, 55)})
      compare_with_tip_control(name, euler);
  compare_with_tip_control("table_ab", Vec3(0, 25, 0));
  compare_with_tip_control("table_ab", Vec3(90, 30, -90));
}

/// A table-table machine whose A alone turns lays X Y Z of the plane along X Y Z of the machine: joints differ by what
/// the program says. At A = -30 a point p of the part goes to c + R_x(-30) (p - c), with c a point of A's axis
/// (direction X, through y = -8.5, z = -70).
TEST(TiltedFrames, OnATableHaveAClosedForm) {
  const machine::Machine machine = sample("table_ac_linuxcnc");
  const Read r =
      read(kOffset + "G0 X0 Y0 Z80\nG68.2 X1 Y2 Z3 J30\nG53.1\nG43 H1\nG0 X0 Y0 Z10\nG1 X7 Y-4 Z2 F500\n", machine);
  ProgramJoints joints(machine, r.moves);
  while (!joints.done()) joints.next();
  const Joints q = joints.at(1);
  EXPECT_NEAR(deg_from_rad(q.rotary_rad.x()), -30, 1e-10);
  EXPECT_NEAR(q.rotary_rad.z(), 0, 1e-12);
  const double y = 2 + 20 + 8.5, z = 3 - 300 + 70, s = -0.5, c = std::sqrt(0.75);  // the plane's origin, seen from A
  const Vec3 origin(1 + 10, -8.5 + c * y - s * z, -70 + s * y + c * z);
  EXPECT_LE((q.linear_mm - (origin + Vec3(7, -4, 2 + kLengthMm))).norm(), 1e-9);
}

TEST(TiltedFrames, CyclesDrillAlongTheTool) {
  const machine::Machine machine = sample("head_table");
  const std::string start = kOffset + "G0 X0 Y0 Z80\nG68.2 X4 I90 J30\nG53.1\nG43 H1\nG0 X0 Y0 Z30\n";
  const Read cycle = read(start + "G81 X5 Y6 Z-4 R2 F100\nX9\nG80\n", machine);
  const Read lines = read(start + "X5 Y6\nZ2\nG1 Z-4 F100\nG0 Z30\nX9\nZ2\nG1 Z-4\nG0 Z30\n", machine);
  const auto holes = cutting_places(cycle, machine);
  expect_same(holes, cutting_places(lines, machine));
  const Vec3 along = (holes[2].pose.tip_mm - holes[0].pose.tip_mm).normalized();
  EXPECT_LE((along + holes[0].pose.axis).norm(), 1e-12);
}

TEST(TiltedFrames, TheLinearAxesStayWhileTheToolTurns) {
  const machine::Machine machine = sample("table_bc");
  const Read r = read(kOffset + "G43 H1\nG0 X30 Y-20 Z80\nG68.2 X1 Y2 Z3 I30 J25\nG53.1\nG0 X5 Y6\nZ10\n", machine);
  ProgramJoints joints(machine, r.moves);
  joints.next();
  const Vec3 before = joints.at(1).linear_mm;
  EXPECT_EQ(before, Vec3(40, 0, -300 + 80 + kLengthMm));
  EXPECT_TRUE(joints.next().turns());
  for (const double u : {0.0, 0.5, 1.0}) EXPECT_EQ(joints.at(u).linear_mm, before);
  const ToolPose turned = *joints.pose_at(1);
  // X and Y of the plane are programmed, its Z stays: it is along the tool.
  joints.next();
  EXPECT_NEAR((joints.pose_at(1)->tip_mm - turned.tip_mm).dot(turned.axis), 0, 1e-9);
  joints.next();
  const Vec3 way = joints.pose_at(1)->tip_mm - joints.pose_at(0)->tip_mm;
  EXPECT_LE(way.normalized().cross(turned.axis).norm(), 1e-12);
  const Eigen::Matrix3d plane =
      (Eigen::AngleAxisd(rad_from_deg(30), Vec3::UnitZ()) * Eigen::AngleAxisd(rad_from_deg(25), Vec3::UnitX()))
          .toRotationMatrix();
  EXPECT_LE((joints.pose_at(1)->tip_mm - (Vec3(1 + 10, 2 + 20, 3 - 300) + plane * Vec3(5, 6, 10))).norm(), 1e-9);
}

TEST(TiltedFrames, MachineCoordinatesAreThoseOfTheJoints) {
  const machine::Machine machine = sample("table_bc");
  const Read r = read(kOffset + "G43 H1\nG0 X30 Y-20 Z80\nG53 Z0\nG68.2 J25\nG53.1\nG53 X100\nG69\nG0 Z50\n", machine);
  ProgramJoints joints(machine, r.moves);
  joints.next();
  joints.next();
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(40, 0, 0));
  joints.next();
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(40, 0, 0));
  joints.next();
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(100, 0, 0));
  joints.next();  // after G69 Z is that of the machine again, and X and Y stay
  EXPECT_LE((joints.at(1).linear_mm - Vec3(100, 0, -300 + 50 + kLengthMm)).norm(), 1e-9);
}

/// B turns the tool about +Y by 30 degrees, so the table by -30, then C by -90: a way v of the machine is
/// R_z(90) R_y(30) v in the part's frame (pose(q) = E_c E_b ...).
TEST(DynamicOffset, MovesAsTipControlDoes) {
  const machine::Machine machine = sample("table_bc");
  std::string dynamic = kOffset + "G0 X0 Y0 Z80 B30 C90\nG43 H1\nG254\n",
              tip = kOffset + "G0 X0 Y0 Z80 B30 C90\nG43.4 H1\n";
  const double s = 0.5, c = std::sqrt(0.75);
  bool first = true;
  for (const Vec3& p : kCut) {
    const Vec3 about_y(c * p.x() + s * p.z(), p.y(), -s * p.x() + c * p.z());
    const Vec3 in_part(-about_y.y(), about_y.x(), about_y.z());
    const char* g = first ? "G0" : "G1 F500";
    dynamic += fmt::format("{} X{} Y{} Z{}\n", g, p.x(), p.y(), p.z());
    tip += fmt::format("{} X{:.12f} Y{:.12f} Z{:.12f}\n", g, in_part.x(), in_part.y(), in_part.z());
    first = false;
  }
  const auto places = cutting_places(read(dynamic, machine), machine);
  expect_same(places, cutting_places(read(tip, machine), machine));
  // Its axes are those of the machine.
  EXPECT_LE((places[2].joints.linear_mm - places[0].joints.linear_mm - (kCut[1] - kCut[0])).norm(), 1e-9);
}

TEST(DynamicOffset, CountsFromTheWorkOffsetAndWhatStandsOnIt) {
  const machine::Machine machine = sample("table_bc");
  const std::string turned = kOffset + "G0 X0 Y0 Z80 B30\n";
  const auto plain = cutting_places(read(turned + "G254\nG0 X5 Y0 Z0\nG1 X8 F100\n", machine), machine);
  expect_same(plain, cutting_places(read(turned + "G52 X2\nG254\nG0 X3 Y0 Z0\nG1 X6 F100\n", machine), machine));
}

TEST(TravelCheck, OfATiltedFrameNamesAnAxisThatTheProgramDoesNotName) {
  // The head leans to X by 60 degrees; a way of -310 along Y of the plane is one of -310 sin 60 along Z. With 10 cos 60
  // above the plane, the tool, and the head from its pivot: -300 - 268.468 + 5 + 100 cos 60 - 150 (1 - cos 60).
  EXPECT_EQ(said(kOffset + "G0 X0 Y0 Z80\nG68.2 I90 J60\nG53.1\nG43 H1\nG0 X0 Y0 Z10\nG1 Y-300 F500\nY-310\nG0 Y0\n",
                 sample("head_table")),
            "p.nc:8:1: error: Z goes to -588.468 mm in machine coordinates in this move and 2 more; -500 to 200 was "
            "expected (travel_mm of [axis.z]) [travel]\n");
}

TEST(TravelCheck, OfATiltedFrameSaysWhereThePlaneIsOutOfReach) {
  EXPECT_EQ(said(kOffset + "G0 X0 Y0 Z80\nG68.2 J120\nG53.1\nG0 X0 Y0 Z10\n", sample("nutating_head")),
            "p.nc:5:1: error: the rotary axes cannot put the tool along Z of the tilted frame; a plane within their "
            "reach was expected [tool-direction]\n"
            "p.nc:6:1: error: the tool is 120 degrees off Z of the tilted frame (G68.2) in this move; G53.1 was "
            "expected before [tilted-frame]\n");
}

TEST(TravelCheck, OfATiltedFrameAsksForG531) {
  const std::string start = kOffset + "G0 X0 Y0 Z80\nG68.2 J30\n";
  EXPECT_EQ(
      said(start + "G0 X0 Y0 Z10\n", sample("head_table")),
      "p.nc:5:1: error: the tool is 30 degrees off Z of the tilted frame (G68.2) in this move; G53.1 was expected "
      "before [tilted-frame]\n");
  // Angles by hand, with the three decimals of a post, do as well.
  EXPECT_EQ(said(start + "G0 B30. C-90.001\nG0 X0 Y0 Z10\n", sample("head_table")), "");
}

/// The program does not name the angles of G53.1 and G28.
TEST(TravelCheck, NamesAClampedAxisThatTurnsWithoutAWord) {
  machine::Machine machine = sample("head_table");
  machine.rotary[1].clamp_m = 10, machine.rotary[1].unclamp_m = 11;
  machine.rotary[2].clamp_m = 12, machine.rotary[2].unclamp_m = 13;
  const std::string start = kOffset + "G43 H1\nG0 X0 Y0 Z80\n";
  EXPECT_EQ(said(start + "M10\nM12\nG68.2 J30\nG53.1\nM11\nM13\n", machine),
            "p.nc:8:1: error: B turns by 30 degrees while M10 has it clamped; M11 was expected before [clamped]\n"
            "p.nc:8:1: error: C turns by -90 degrees while M12 has it clamped; M13 was expected before [clamped]\n");
  EXPECT_EQ(said(start + "B20.\nM10\nG28 B20.\n", machine),
            "p.nc:7:1: error: B turns by -20 degrees while M10 has it clamped; M11 was expected before [clamped]\n");
  EXPECT_EQ(said(start + "M10\nM11\nG68.2 J30\nG53.1\nM10\nG69\nG28 X0 Y0 Z0\n", machine), "");
}

TEST(RotaryWords, OfAnArcUnderTipControlKeepTheTipOnTheArc) {
  const machine::Machine machine = sample("head_table");
  const Read r = read(kOffset + "G0 X30 Y0 Z5\nG43.4 H1\nG3 X-30 Y0 I-30 B20 C180 F500\n", machine);
  ProgramJoints joints(machine, r.moves);
  joints.next();
  joints.next();
  for (const double u : {0.0, 0.25, 0.5, 1.0}) {
    const ToolPose pose = *joints.pose_at(u);
    EXPECT_LE((pose.tip_mm - Vec3(10 + 30 * std::cos(u * kPi), 20 + 30 * std::sin(u * kPi), -295)).norm(), 1e-9) << u;
    EXPECT_NEAR(std::acos(pose.axis.z()), u * rad_from_deg(20), 1e-9) << u;
  }
}

TEST(PoseTrack, FollowsTheMachineAtProgrammedFeeds) {
  machine::Machine machine = sample("head_table");
  const Read r =
      read(kOffset + "G43 H1\nG0 X0 Y0 Z80\nG1 X60 F600\nG93 G1 B40 F30\nG94 G4 P1000\nG1 B80 F60\n", machine);
  const PoseTrack track = programmed_track(machine, r.moves);
  EXPECT_EQ(track.unknown_moves, 0U);
  EXPECT_EQ(track.samples.front().time_s, 0);  // where the first move ends
  EXPECT_NEAR(track.samples.back().time_s, 6 + 2 + 1 + 40, 1e-9);
  const Chain chain(machine);
  double last_s = 0;
  for (const PoseSample& s : track.samples) {
    EXPECT_GE(s.time_s, last_s);
    last_s = s.time_s;
    EXPECT_LE((chain.pose(s.joints, kLengthMm).tip_mm - s.pose.tip_mm).norm(), 1e-12);
  }
  EXPECT_EQ(track.samples.back().line, 8);
  const Read open = read("G0 X0 Y0 Z0\nG1 X5 F100\n", machine);
  EXPECT_EQ(programmed_track(machine, open.moves).unknown_moves, 2U);
}

}  // namespace
}  // namespace camber::kinematics
