#include "kinematics/program_joints.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "base/units.h"
#include "kinematics/control_options.h"
#include "kinematics/travel_check.h"
#include "nc/interpreter.h"
#include "tests/kinematics/machines.h"
#include "tests/support/csv_columns.h"
#include "tests/support/test_data.h"

namespace camber::kinematics {
namespace {

using tests::sample;

/// Positions of the trace have four decimals; the planner ends a block within about as much.
constexpr double kTraceStep = 2e-4;

struct Read {
  nc::Program program;
  nc::Interpretation moves;
};

Read read(SourceText text, const machine::Machine& machine, const char* dialect, double tool_length_mm) {
  nc::InterpreterOptions options;
  options.inch = false;
  options.dialect = *nc::dialect_named(dialect);
  options.rotary_axes = rotary_options(machine);
  options.tool_offsets[1].length_mm = tool_length_mm;
  Diagnostics diagnostics;
  Read r;
  r.program = nc::read_program(std::move(text), diagnostics);
  r.moves = nc::interpret(r.program, options, diagnostics);
  diagnostics.throw_if_errors();
  return r;
}

std::string said(const std::string& text, const machine::Machine& machine, double tool_length_mm = 100) {
  const Read r = read(SourceText("p.nc", text), machine, "fanuc", tool_length_mm);
  Diagnostics diagnostics;
  check_travel(machine, r.program, r.moves, diagnostics);
  std::string out;
  for (Diagnostic d : diagnostics.all()) {
    d.source_line.clear();
    out += to_string(d) + "\n";
  }
  return out;
}

/// Every block of this program ends at rest: the trace has the joints of its end.
TEST(ProgramJoints, AreThoseOfTheTraceAtTheEndsOfBlocks) {
  const machine::Machine machine = sample("table_ac_linuxcnc");
  const Read r =
      read(SourceText::read(camber::tests::data_path("linuxcnc5/programs/tcp_fixed_g61.ngc")), machine, "linuxcnc", 80);
  auto t =
      camber::tests::columns_of(SourceText::read(camber::tests::unpacked_data("linuxcnc5/tcp_fixed_g61_t.csv")).text());
  ProgramJoints joints(machine, r.moves);
  int compared = 0;
  while (!joints.done()) {
    joints.next();
    const nc::Move& move = r.moves.moves[joints.index()];
    if (move.kind != nc::MoveKind::linear) continue;
    std::size_t last = 0;
    for (std::size_t i = 0; i < t["line"].size(); ++i)
      if (t["line"][i] == move.block + 1) last = i;
    ASSERT_GT(last, 0U) << move.block + 1;
    const Joints q = joints.at(1);
    double nearest = 1e9;  // the interpolator comes up to three cycles later
    for (std::size_t i = last; i < std::min(last + 6, t["line"].size()); ++i) {
      const Vec3 mm(t["x_cmd_mm"][i], t["y_cmd_mm"][i], t["z_cmd_mm"][i]);
      const double off_mm = (mm - q.linear_mm).lpNorm<Eigen::Infinity>();
      const double off_deg = std::max(std::abs(t["a_cmd_deg"][i] - deg_from_rad(q.rotary_rad.x())),
                                      std::abs(t["c_cmd_deg"][i] - deg_from_rad(q.rotary_rad.z())));
      nearest = std::min(nearest, std::max(off_mm, off_deg));
    }
    EXPECT_LE(nearest, kTraceStep) << "line " << move.block + 1;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

TEST(ProgramJoints, FollowTheTipUnderTipControl) {
  const machine::Machine machine = sample("head_table");
  const Read r =
      read(SourceText("p.nc",
                      "G10 L2 P1 X10 Y20 Z-300\nG54 G0 X0 Y0 Z60\nZ50\nG43.4 H1\nZ50\nG1 X30 B30. C45. F500\n"
                      "G49\nG0 X0 Y0 Z100\n"),
           machine, "fanuc", 100);
  ProgramJoints joints(machine, r.moves);
  const MoveJoints& first = joints.next();
  EXPECT_FALSE(first.start_known);  // nothing is known of where it starts
  EXPECT_TRUE(first.linear_known);
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(10, 20, -240));
  EXPECT_TRUE(joints.next().linear_known);
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(10, 20, -250));  // no length is active
  EXPECT_TRUE(joints.next().start_known);                 // G43.4 alone moves nothing
  EXPECT_EQ(joints.at(0).linear_mm, Vec3(10, 20, -250));
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(10, 20, -150));
  const MoveJoints& tilted = joints.next();
  EXPECT_TRUE(tilted.turns());
  const Chain chain(machine);
  for (const double u : {0.0, 0.3, 1.0}) {
    const ToolPose pose = chain.pose(joints.at(u), 100);
    EXPECT_LE((pose.tip_mm - Vec3(10 + 30 * u, 20, -250)).norm(), 1e-9);
  }
  const Vec3 end_mm = joints.at(1).linear_mm;
  EXPECT_TRUE(joints.next().start_known);  // where the tilted move ended
  EXPECT_LE((joints.at(0).linear_mm - end_mm).norm(), 1e-12);
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(10, 20, -200));
  EXPECT_TRUE(joints.done());
}

/// X and Y are placed, Z by a machine coordinate: axes become known one by one.
TEST(ProgramJoints, AxesBecomeKnownOneByOne) {
  const machine::Machine machine = sample("head_table");
  const Read r = read(SourceText("p.nc",
                                 "G10 L2 P1 X10 Y20 Z-300\nG54 G0 X1 Y2\nG53 Z-5\nG43 H1\nX3\nG68 X0 Y0 R90.\nX4\n"
                                 "G69\nG28 G91 Y0\nG90 X5\nG68.2 J10.\nX6\n"),
                      machine, "fanuc", 100);
  ProgramJoints joints(machine, r.moves);
  EXPECT_FALSE(joints.next().linear_known);
  EXPECT_TRUE(joints.next().linear_known);  // G53
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(11, 22, -5));
  EXPECT_TRUE(joints.next().start_known);
  EXPECT_EQ(joints.at(0).linear_mm, Vec3(11, 22, -5));
  EXPECT_EQ(joints.at(1).linear_mm, Vec3(13, 22, -5));
  EXPECT_TRUE(joints.next().linear_known);  // G68 turns X to Y
  EXPECT_NEAR(joints.at(1).linear_mm.y(), 24, 1e-9);
  EXPECT_NEAR(joints.at(1).linear_mm.z(), -5, 1e-9);
  EXPECT_FALSE(joints.next().linear_known);  // G28 Y
  EXPECT_FALSE(joints.next().linear_known);
  EXPECT_NEAR(joints.end_linear_mm().x(), 15, 1e-9);
  EXPECT_TRUE(std::isnan(joints.end_linear_mm().y()));
  EXPECT_NEAR(joints.end_linear_mm().z(), -5, 1e-9);
  EXPECT_FALSE(joints.next().linear_known);  // in a tilted frame all axes depend on Y
  EXPECT_TRUE(std::isnan(joints.end_linear_mm().x()));
  EXPECT_TRUE(joints.done());
}

/// In a frame turned by 90 degrees the programmed X is Y of the machine, and the open Y its X.
TEST(ProgramJoints, ATurnedFrameAsksForThoseAxesOnlyThatItNeeds) {
  const machine::Machine machine = sample("head_table");
  const Read r = read(SourceText("p.nc",
                                 "G10 L2 P1 X10 Y20 Z-300\nG54 G0 X1 Y2\nG53 Z-5\nG43 H1\nG28 G91 Y0\n"
                                 "G90 G68 X0 Y0 R90.\nX6\n"),
                      machine, "fanuc", 100);
  ProgramJoints joints(machine, r.moves);
  joints.next();
  joints.next();
  EXPECT_FALSE(joints.next().linear_known);  // G28 Y
  EXPECT_TRUE(joints.next().linear_known);
  EXPECT_NEAR(joints.end_linear_mm().x(), 11, 1e-9);
  EXPECT_NEAR(joints.end_linear_mm().y(), 26, 1e-9);
  EXPECT_NEAR(joints.end_linear_mm().z(), -5, 1e-9);
  EXPECT_TRUE(joints.done());
}

TEST(ProgramJoints, DirectionsBecomeTheNearestAngles) {
  const machine::Machine machine = sample("head_table");
  const Read r = read(SourceText("p.nc",
                                 "G10 L2 P1 X0 Y0 Z-300\nG54 G0 X0 Y0 Z50 B10. C350.\nG43.5 H1\n"
                                 "G1 X0 Y0 Z50 I0.5 J0.1 K0.9 F500\n"),
                      machine, "fanuc", 100);
  ProgramJoints joints(machine, r.moves);
  joints.next();
  joints.next();
  const Joints q = joints.at(1);
  EXPECT_LE((Chain(machine).pose(q, 100).axis - Vec3(0.5, 0.1, 0.9).normalized()).norm(), 1e-12);
  EXPECT_GT(q.rotary_rad.y(), 0);
  EXPECT_LE(std::abs(q.rotary_rad.z() - rad_from_deg(350)), rad_from_deg(30));
}

/// The program moves X alone; Y runs out of travel because the table has turned.
TEST(TravelCheck, NamesAnAxisThatTheProgramDoesNotName) {
  EXPECT_EQ(
      said("G10 L2 P1 X0 Y0 Z-300\nG54 G0 X0 Y0 Z50\nG43.4 H1\nG0 X0 Y0 Z50 C90.\nG1 X450 F500\nX460\n",
           sample("head_table")),
      "p.nc:5:1: error: Y goes to -460 mm in machine coordinates in this move and 1 more; -400 to 400 was expected "
      "(travel_mm of [axis.y]) [travel]\n");
}

TEST(TravelCheck, LooksBetweenTheEndsOfAMove) {
  machine::Machine m = sample("head_table");
  m.axis[1].travel_mm = {-290, 290};
  // Both ends have Y = 0: half a turn on a radius of 300 mm.
  EXPECT_EQ(
      said("G10 L2 P1 X0 Y0 Z-300\nG54 G0 X300 Y0 Z50\nG43.4 H1\nG0 C180.\n", m),
      "p.nc:4:1: error: Y goes to -300 mm in machine coordinates; -290 to 290 was expected (travel_mm of [axis.y]) "
      "[travel]\n");
}

TEST(TravelCheck, ChecksRotaryAxesWithoutAnyOffset) {
  EXPECT_EQ(said("G0 X0 Y0 Z0 B101.\nC-663.\nC459.\nC-721.\n", sample("head_table")),
            "p.nc:2:1: warning: the travel of X, Y and Z is not checked, as the work offset (--work-offset, or G10 "
            "L2) is not known "
            "[travel-unchecked]\n"
            "p.nc:1:1: error: B goes to 101 degrees in machine coordinates in this move and 3 more; -100 to 100 was "
            "expected (travel_deg of [axis.b]) [travel]\n"
            "p.nc:4:1: error: C goes to -721 degrees in machine coordinates; -720 to 720 was expected (travel_deg of "
            "[axis.c]) [travel]\n");
}

TEST(TravelCheck, SaysWhichDirectionsAreOutOfReach) {
  EXPECT_EQ(said("G10 L2 P1 X0 Y0 Z-300\nG54 G0 X0 Y0 Z50\nG43.5 H1\nG1 X1 I1. K-1. F500\n", sample("nutating_head")),
            "p.nc:4:1: error: the rotary axes cannot give the tool this direction (I J K); one within their reach was "
            "expected [tool-direction]\n");
}

TEST(TravelCheck, SaysWhereTheFeedAsksTooMuchOfARotaryAxis) {
  // 2 mm at 1200 mm/min are 0.1 s, for 150 degrees of C.
  const std::string start = "G10 L2 P1 X0 Y0 Z-300\nG54 G0 X0 Y0 Z50\nG43.4 H1\n";
  const std::string warning =
      "p.nc:4:1: warning: the feed asks up to 90000 degrees/min of C, but  allows 12000 (max_velocity_deg_per_min of "
      "[axis.c]); the control slows down here [rotary-speed]\n";
  machine::Machine m = sample("head_table");
  m.path.clear();
  EXPECT_EQ(said(start + "G1 X2 C150. F1200\n", m), warning);
  EXPECT_EQ(said(start + "G93 G1 X2 C150. F600.\n", m), warning);
  EXPECT_EQ(said(start + "G93 G1 X2 C150. F60.\n", m), "");
  // Without tool-centre-point control: of all axes together, 150.01 at 20 /s; or of X alone; degrees of C alone.
  const std::string joints = "G10 L2 P1 X0 Y0 Z-300\nG54 G0 X0 Y0 Z50\n\n";
  EXPECT_EQ(said(joints + "G1 X2 C150. F1200\n", m), "");
  EXPECT_NE(said(joints + "G1 X2 C150. F20000\n", m).find("asks up to 19998 degrees/min of C"), std::string::npos);
  EXPECT_NE(said(joints + "G1 C150. F20000\n", m).find("asks up to 20000 degrees/min of C"), std::string::npos);
  m.control.rotary_feed = machine::RotaryFeed::linear;
  EXPECT_EQ(said(joints + "G1 X2 C150. F1200\n", m), warning);
}

TEST(TravelCheck, SaysNothingOfUprightProgramsWithoutOffsets) {
  EXPECT_EQ(said("G0 X0 Y0 Z0\nG1 X5000 F500\n", sample("head_table")), "");
}

}  // namespace
}  // namespace camber::kinematics
