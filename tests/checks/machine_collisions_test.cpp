#include "checks/machine_collisions.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "checks/machine_solids.h"
#include "kinematics/control_options.h"
#include "nc/interpreter.h"
#include "tests/support/cutting.h"
#include "tests/support/temp_folder.h"

namespace camber::checks {
namespace {

/// Less is no contact: the tool is taken as smaller by this all round.
constexpr double kTouch_mm = kContact_mm;

/// A flat end mill of 6 mm whose holder, 24 mm wide and 30 mm long, begins 16 mm above the tip.
machine::Job job_of() {
  machine::Job job;
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 6, 2, 0);
  tool.overhang_mm = 16;
  tool.flute_length_mm = 10;
  tool.holder = {{24, 24, 30}};
  job.tools[1] = tool;
  job.machine.cycle.rapid_path = machine::RapidPath::linear;
  job.compensation.work_offset_mm = Vec3(100, 50, -200);
  return job;
}

machine::Body box_on(std::size_t axes, const Vec3& low, const Vec3& high, std::string name = "vice") {
  return {std::move(name), axes == 0 ? "part" : "axis", axes, std::array<Vec3, 2>{low, high}};
}

struct Program {
  nc::Program text;
  nc::Interpretation moves;
};

Program program_of(const machine::Job& job, const std::string& blocks) {
  Diagnostics found;
  nc::InterpreterOptions options;
  options.rotary_axes = kinematics::rotary_options(job.machine);
  Program out{nc::read_program(SourceText("p.nc", "G21 G90 G94\nT1 M6\nS3000 M3\n" + blocks + "M30\n"), found), {}};
  out.moves = nc::interpret(out.text, kinematics::interpreter_options(job.machine, options), found);
  for (const auto& d : found.all()) EXPECT_NE(d.severity, Severity::error) << d.message;
  return out;
}

/// "5: holder, vice", by lines.
std::string found_in(const machine::Job& job, const std::string& blocks) {
  constexpr const char* kParts[] = {"cutter", "shank", "holder"};
  const Program program = program_of(job, blocks);
  std::string out;
  for (const MachineCollision& c : find_machine_collisions(job, program.text, program.moves)) {
    const std::string what =
        c.other_body ? job.machine.bodies[*c.other_body].name : kParts[static_cast<std::size_t>(c.part)];
    out += fmt::format("{}: {}, {}\n", program.moves.moves[c.move].block + 1, what, job.machine.bodies[c.body].name);
  }
  return out;
}

/// The job with the vice's box as a mesh of twelve triangles.
void mesh_instead(machine::Body& body, const tests::TempFolder& folder) {
  const auto& [low, high] = *body.box_mm;
  std::string text = "solid box\n";
  for (int axis = 0; axis < 3; ++axis)
    for (const bool top : {false, true}) {
      std::array<Vec3, 4> corner;
      for (int i = 0; i < 4; ++i) {
        Vec3 p;
        p[axis] = (top ? high : low)[axis];
        p[(axis + 1) % 3] = (i == 1 || i == 2 ? high : low)[(axis + 1) % 3];
        p[(axis + 2) % 3] = (i >= 2 ? high : low)[(axis + 2) % 3];
        corner[static_cast<std::size_t>(i)] = p;
      }
      if (!top) std::swap(corner[1], corner[3]);
      for (const auto& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int i : t) {
          const Vec3& p = corner[static_cast<std::size_t>(i)];
          text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
        }
        text += "endloop\nendfacet\n";
      }
    }
  body.mesh = folder.write("body.stl", text + "endsolid box\n");
  body.box_mm.reset();
}

TEST(MachineCollisions, HolderThatPassesOverAViceByATenthDoesNotCollide) {
  const tests::TempFolder folder;
  for (const bool mesh : {false, true})
    for (const double clearance : {0.1, -kTouch_mm - 0.02}) {
      machine::Job job = job_of();
      // A jaw beside the part, its top at Z-6 of the program.
      job.machine.bodies = {box_on(0, Vec3(100, 50 + 5, -230), Vec3(160, 50 + 40, -206))};
      if (mesh) mesh_instead(job.machine.bodies[0], folder);
      const std::string blocks = fmt::format(
          "G0 X-40 Y-5 Z50\nG0 Z0\nG1 X100 F900\nG0 Z50\nG0 X-40\nZ{:.3f}\nG1 X100\nG0 Z50\n", -6 - 16 + clearance);
      EXPECT_EQ(found_in(job, blocks), clearance > 0 ? "" : "10: holder, vice\n") << clearance << mesh;
    }
}

TEST(MachineCollisions, CutterBesideAViceByATenthDoesNotCollide) {
  for (const double clearance : {0.1, -kTouch_mm - 0.02}) {
    machine::Job job = job_of();
    job.machine.bodies = {box_on(0, Vec3(100, 50, -230), Vec3(160, 90, -206))};
    // Round the corner of the jaw on an arc whose radius is that of the tool and the clearance.
    const double r = 3 + clearance;
    const std::string blocks =
        fmt::format("G0 X{0:.3f} Y20 Z50\nZ-8\nG1 Y0 F900\nG3 X0 Y{0:.3f} I{1:.3f} J0\nG1 X30\nG0 Z50\n", -r, r);
    EXPECT_EQ(found_in(job, blocks), clearance > 0 ? "" : "5: cutter, vice\n") << clearance;
  }
}

TEST(MachineCollisions, RapidsGoThePathOfTheControl) {
  machine::Job job = job_of();
  job.machine.axis[0].max_velocity_mm_per_s = 100;
  job.machine.axis[1].max_velocity_mm_per_s = 100;
  // Beside the straight line from (0, 0) to (100, 30), in the way of both axes at once to (30, 30).
  job.machine.bodies = {box_on(0, Vec3(100 + 35, 50 + 35, -250), Vec3(100 + 40, 50 + 40, -150), "clamp")};
  const std::string blocks = "G0 X0 Y0 Z0\nG0 X100 Y30\n";
  EXPECT_EQ(found_in(job, blocks), "");
  job.machine.cycle.rapid_path = machine::RapidPath::dogleg;
  EXPECT_EQ(found_in(job, blocks), "5: holder, clamp\n");
}

TEST(MachineCollisions, EachContactIsReportedWhereItBegins) {
  machine::Job job = job_of();
  job.machine.bodies = {box_on(0, Vec3(100, 50, -230), Vec3(160, 90, -220), "table")};
  // The cutter goes 0.05 mm below the table's top at Z-20; a deep drill stays in it for three blocks.
  EXPECT_EQ(found_in(job, "G0 X30 Y20 Z50\nG1 Z-20 F300\nG1 Z-20.05\nG0 Z50\n"), "6: cutter, table\n");
  EXPECT_EQ(found_in(job, "G0 X30 Y20 Z50\nG1 Z-25 F300\nG1 X40\nG0 Z50\nG1 Z-20.5\n"),
            "5: cutter, table\n8: cutter, table\n");
  // A way that is not known: after the tool change only the ends of rapids are.
  job.tools[2] = job.tools[1];
  EXPECT_EQ(found_in(job, "G0 X-50 Y20 Z-25\nT2 M6\nG0 X200 Y20 Z-25\n"), "");
  EXPECT_EQ(found_in(job, "G0 X-50 Y20 Z-25\nG0 X200 Y20 Z-25\n"), "5: cutter, table\n");
}

TEST(MachineCollisions, ToolThatStandsInsideAMeshCollides) {
  const tests::TempFolder folder;
  machine::Job job = job_of();
  job.machine.bodies = {box_on(0, Vec3(0, 0, -400), Vec3(300, 300, 100), "block")};
  mesh_instead(job.machine.bodies[0], folder);
  // Of the first positioning the program knows nothing; the block after it begins at its end.
  EXPECT_EQ(found_in(job, "G0 X30 Y20 Z0\nG1 X31 F100\nX32\n"), "5: cutter, block\n");
}

TEST(MachineCollisions, HeadMeetsFixtureWithoutTheTool) {
  machine::Job job = job_of();
  // Without G43 the holder's upper end, 46 mm above the tip, is at the gauge line, where all axes at 0 have it.
  job.machine.bodies = {box_on(0, Vec3(100, 50, -230), Vec3(160, 90, -150), "post"),
                        box_on(3, Vec3(20, -20, 1), Vec3(80, 20, 80), "head")};
  // The head's lower face is 47 mm above the tip, the post's top at Z50 of the program.
  EXPECT_EQ(found_in(job, "G0 X-30 Y0 Z50\nG1 Z3.1 F900\n"), "");
  EXPECT_EQ(found_in(job, "G0 X-30 Y0 Z50\nG1 Z2.9 F900\n"), "5: head, post\n");
}

// --- turning axes

constexpr double kPivot_mm = -70;

/// Table-table: C on A on Y. Tools of T1 are 120 mm long, work offset 0.
machine::Job five_axes() {
  machine::Job job = job_of();
  job.compensation.work_offset_mm.reset();
  machine::Kinematics& k = job.machine.kinematics;
  k.chain = "cayxz";
  k.table_axes = 3;
  auto& a = job.machine.rotary[0];
  auto& c = job.machine.rotary[2];
  a.given = c.given = true;
  a.direction = Vec3::UnitX();
  a.point_mm = Vec3(0, 0, kPivot_mm);
  a.positive = c.positive = machine::PositiveTurn::table;
  return job;
}

/// Under tool-centre-point control.
std::string tcp(const std::string& blocks) {
  return "G10 L2 P1 X0 Y0 Z0\nG10 L1 P1 R120\nG54\nG43.4 H1\n" + blocks + "G49\n";
}

TEST(MachineCollisions, BodiesOnTheTableTurnWithThePart) {
  machine::Job job = five_axes();
  job.machine.bodies = {box_on(0, Vec3(40, -10, -50), Vec3(60, 10, -20), "clamp")};
  // The part's frame stands still for what is carried with it: the same places collide at every angle of C.
  for (const int c : {0, 30, 90, 200})
    EXPECT_EQ(
        found_in(job, tcp(fmt::format("G0 X0 Y0 Z30 A0 C{}\nG1 Z-20.1 X10 F900\nX24.9\nX25.1 Z-36.1\nG0 Z30\n", c))),
        "")
        << c;
  for (const int c : {0, 30, 90, 200})
    EXPECT_EQ(found_in(job, tcp(fmt::format("G0 X0 Y0 Z30 A0 C{}\nG1 Z-21 X10 F900\nX37.1\nG0 Z30\n", c))),
              "10: cutter, clamp\n")
        << c;
  // On the saddle it does not turn: at C90 the tool has gone to where the machine has it, at X 0 and Y 50.
  job.machine.bodies = {box_on(3, Vec3(40, -10, -50), Vec3(60, 10, -20), "clamp")};
  EXPECT_EQ(found_in(job, tcp("G0 X50 Y0 Z30 A0 C0\nG1 Z-21 F900\nG0 Z30\n")), "9: cutter, clamp\n");
  EXPECT_EQ(found_in(job, tcp("G0 X50 Y0 Z30 A0 C90\nG1 Z-21 F900\nG0 Z30\n")), "");
}

TEST(MachineCollisions, TableThatTiltsTowardsTheHolderMeetsItAtTheAngleOfTheClosedForm) {
  // A plate on A below the pivot. In its frame the tool leans by A about X; the tip stays at the origin. The rim of the
  // holder's lower end, R = 12 at H = 16, is lowest at z = H cos A - R sin A; its upper end, H = 46, likewise.
  machine::Job job = five_axes();
  const double top = -5;
  job.machine.bodies = {box_on(1, Vec3(-200, -200, top - 20), Vec3(200, 200, top), "plate")};
  const auto lowest = [](double deg) {
    const double a = rad_from_deg(deg);
    return (16 + kTouch_mm) * std::cos(a) - (12 - kTouch_mm) * std::sin(a);
  };
  double at_deg = 0;
  while (lowest(at_deg) > top) at_deg += 1e-3;
  const auto turn_to = [&](double deg) { return tcp(fmt::format("G0 X0 Y0 Z0 A0 C0\nG1 A{:.4f} F900\n", deg)); };
  EXPECT_EQ(found_in(job, turn_to(at_deg - 0.05)), "");
  EXPECT_EQ(found_in(job, turn_to(at_deg + 0.05)), "9: holder, plate\n");
  EXPECT_EQ(found_in(job, turn_to(-at_deg + 0.05)), "");
  EXPECT_EQ(found_in(job, turn_to(-at_deg - 0.05)), "9: holder, plate\n");
}

TEST(MachineCollisions, TableMeetsBedAndHeadButNotWhatCarriesIt) {
  machine::Job job = five_axes();
  const auto table = box_on(0, Vec3(-100, -100, -50), Vec3(100, 100, -30), "table");
  const std::string turn = tcp("G0 X0 Y0 Z50 A0 C0\nG1 A90 F900\n");
  // Turned about A by 90 degrees the table's rim is at Z -170.
  job.machine.bodies = {table, box_on(3, Vec3(-300, -300, -200), Vec3(300, 300, -165), "bed")};
  EXPECT_EQ(found_in(job, turn), "9: bed, table\n");
  job.machine.bodies[1].box_mm = {Vec3(-300, -300, -200), Vec3(300, 300, -183)};
  EXPECT_EQ(found_in(job, turn), "");
  // The cradle touches the table that it carries.
  job.machine.bodies[1] = box_on(1, Vec3(-100, -100, -60), Vec3(100, 100, -50), "cradle");
  EXPECT_EQ(found_in(job, turn), "");
}

TEST(MachineCollisions, TurnedMachinesFindTheSame) {
  // The same part and fixture, stood up by random angles of A and C: bodies of the part see the same tool.
  const std::string path = "G1 X0 Y0 Z30 A{0:.3f} C{1:.3f} F2000\nX0 Y{2:.3f} Z-10\nX60 Y{2:.3f}\nG1 Z30 Y-60\n";
  machine::Job job = five_axes();
  job.machine.bodies = {box_on(0, Vec3(20, 0, -40), Vec3(40, 40, 30), "vice")};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(0, 360);
  for (int i = 0; i < 5; ++i) {
    // A upright tool and any C: its cutter passes 0.1 mm beside the vice's face at Y0, or 0.1 mm inside.
    const double c = angle(random);
    const auto blocks = [&](double clearance) {
      return tcp("G0 X0 Y-60 Z60 A0 C0\n" + fmt::format(fmt::runtime(path), 0.0, c, -12 - clearance));
    };
    const tests::TempFolder folder;
    machine::Job with_mesh = job;
    mesh_instead(with_mesh.machine.bodies[0], folder);
    EXPECT_EQ(found_in(job, blocks(0.1)), found_in(with_mesh, blocks(0.1)));
    EXPECT_EQ(found_in(job, blocks(-0.1)), found_in(with_mesh, blocks(-0.1)));
    EXPECT_EQ(found_in(job, blocks(-0.1)), "11: holder, vice\n") << c;
    EXPECT_EQ(found_in(job, blocks(0.1)), "") << c;
  }
}

// --- messages

std::string messages(const machine::Job& job, const std::string& blocks) {
  const Program program = program_of(job, blocks);
  Diagnostics found;
  check_machine_collisions(job, program.text, program.moves, found);
  std::string out;
  for (const auto& d : found.all()) out += to_string(d) + "\n";
  return out;
}

TEST(MachineCollisions, AreErrorsAtTheirLines) {
  machine::Job job = job_of();
  job.machine.bodies = {box_on(0, Vec3(100, 50, -230), Vec3(160, 90, -206))};
  // The rim, R = 12 less 0.01, meets the jaw's corner at X = -sqrt(R^2 - 5^2) = -10.90; places are 0.1 mm apart.
  const std::string blocks = "G0 X-40 Y-5 Z50\nG0 Z-25\nG1 X100 F900\n";
  EXPECT_EQ(messages(job, blocks),
            "p.nc:6:1: error: the holder of T1 meets the body \"vice\" where the tip of T1 is at X-10.84 Y-5.00 "
            "Z-25.00; a path or a set-up that clears it was expected [collision-table]\n    G1 X100 F900\n    ^\n");
  job.simulation.collisions = machine::Collisions::off;
  EXPECT_EQ(messages(job, blocks), "");
  job.simulation.collisions = machine::Collisions::warning;
  job.compensation.work_offset_mm.reset();
  EXPECT_EQ(messages(job, blocks),
            "p.nc: warning: where the bodies of the machine ([[body]]) are depends on the work offset, which is not "
            "known; its value, G10 L2 in the program or without rotary axes [compensation] work_offset_mm in the job, "
            "was expected [work-offset]\n");
}

}  // namespace
}  // namespace camber::checks
