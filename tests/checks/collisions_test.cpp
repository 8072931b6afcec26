// Cutter, shank and holder against the stock: rotation tells all, and a tool that only turns has a closed form.
#include "checks/collisions.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "checks/flute_reach.h"
#include "tests/support/cutting.h"

namespace camber::checks {
namespace {

using Part = Collision::Part;

constexpr double kVoxel = 0.3;
const Vec3 kLow(0, 0, -20), kHigh(30, 24, 0);

/// A flat end mill of 6 mm: flutes 10 mm long, holder 24 mm wide from 16 mm up.
machine::Job job_of() {
  machine::Job job;
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 6, 2, 0);
  tool.overhang_mm = 16;
  tool.flute_length_mm = 10;
  tool.holder = {{24, 24, 30}};
  job.tools[1] = tool;
  job.machine.cycle.rapid_path = machine::RapidPath::linear;
  for (machine::Axis& axis : job.machine.axis) axis.acceleration_mm_per_s2 = 2000;
  return job;
}

motion::SimulatedProgram program_of(const machine::Job& job, const std::string& moves) {
  Diagnostics found;
  return motion::simulate_motion(SourceText("p.nc", "G21 G90 G94\nT1 M6\nS3000 M3\n" + moves + "M30\n"), job, {},
                                 found);
}

/// The box, turned about the origin.
removal::Stock stock_of(const Mat3& turn, const Vec3& low = kLow, const Vec3& high = kHigh, double voxel_mm = kVoxel) {
  Vec3 lo = Vec3::Constant(1e9), hi = -lo;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(), c & 4 ? high.z() : low.z());
    lo = lo.cwiseMin(turn * corner), hi = hi.cwiseMax(turn * corner);
  }
  return {[=](const Vec3& p) { return removal::box_distance_mm(turn.transpose() * p, low, high); }, lo, hi, voxel_mm,
          4};
}

motion::SimulatedProgram turned(motion::SimulatedProgram program, const Mat3& turn) {
  for (removal::Stamp& s : program.path.stamps) {
    s.pose = pose_of_frame(turn * s.pose.tip_mm, turn.col(2), turn.col(0));
    s.feed_per_tooth_mm = turn * s.feed_per_tooth_mm;
  }
  nc::Interpretation moves = program.commanded();
  for (nc::Move& m : moves.moves) m.start_mm = turn * m.start_mm, m.end_mm = turn * m.end_mm;
  static_cast<kinematics::MachineProgram&>(program) = kinematics::MachineProgram(program.text(), std::move(moves));
  return program;
}

/// "line 8: holder"; a rapid: "line 8: cutter, rapid".
std::string text_of(const motion::SimulatedProgram& program, const std::vector<Collision>& found) {
  constexpr const char* kParts[] = {"cutter", "shank", "holder"};
  std::string out;
  for (const Collision& c : found)
    out += fmt::format("line {}: {}{}\n", program.moves_in_part().moves[c.move].block + 1,
                       kParts[static_cast<std::size_t>(c.part)], c.rapid ? ", rapid" : "");
  return out;
}

std::string found_in(const machine::Job& job, const motion::SimulatedProgram& program, const Mat3& turn) {
  return text_of(program, find_collisions(job, turned(program, turn), stock_of(turn)));
}

std::string flutes_of(const machine::Job& job, const motion::SimulatedProgram& program, const Mat3& turn) {
  Diagnostics found;
  check_flute_reach(job, turned(program, turn), stock_of(turn), found);
  std::string out;
  for (const auto& d : found.all()) out += fmt::format("line {} [{}]\n", d.location.line, d.check);
  return out;
}

std::vector<Mat3> random_turns() {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Mat3> out{Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()).toRotationMatrix()};
  for (int i = 0; i < 2; ++i)
    out.push_back(Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                      .normalized()
                      .toRotationMatrix());
  return out;
}

/// Slots along X in layers; the last one takes the holder into the block.
const std::string kLayers = "G0 X-20 Y12 Z30\nG0 Z-5\nG1 X50 F900\nZ-10\nX-20\nZ-15\nX50\nZ-18\nX-20\nG0 Z30\n";

TEST(Collisions, OfATurnedCutAreThoseOfTheUprightOne) {
  struct Case {
    std::string moves, found, flutes;
  };
  const std::vector<Case> cases{
      {kLayers, "line 12: holder\n", ""},
      // Full depth at once: more than the flutes.
      {"G0 X-20 Y12 Z30\nG0 Z-13\nG1 X50 F900\nG0 Z30\n", "line 6: shank\n", "line 6 [cut-above-flutes]\n"},
      // Back through the block beside the slot.
      {"G0 X-20 Y6 Z30\nG0 Z-5\nG1 X50 F900\nG0 Y14\nX-20\nG0 Z30\n", "line 8: cutter, rapid\n", ""},
      // Back through the slot; up out of the block's middle; a ramp deeper than the flutes, layer by layer.
      {"G0 X-20 Y6 Z30\nG0 Z-5\nG1 X50 F900\nG0 X-20\nG1 X15\nG0 Z30\n", "", ""},
      {"G0 X-20 Y12 Z30\nG0 Z0\nG1 X50 Z-9 F900\nX-20\nX50\nX-20 Z-13\nX50\nG0 Z30\n", "", ""},
  };
  const machine::Job job = job_of();
  for (const Case& c : cases) {
    const motion::SimulatedProgram program = program_of(job, c.moves);
    EXPECT_EQ(found_in(job, program, Mat3::Identity()), c.found) << c.moves;
    EXPECT_EQ(flutes_of(job, program, Mat3::Identity()), c.flutes) << c.moves;
    for (const Mat3& turn : random_turns()) {
      EXPECT_EQ(found_in(job, program, turn), c.found) << c.moves << turn;
      EXPECT_EQ(flutes_of(job, program, turn), c.flutes) << c.moves << turn;
    }
  }
}

TEST(Collisions, HolderThatPassesOverTheBlockByATenthDoesNotCollide) {
  machine::Job job = job_of();
  for (const double clearance : {0.1, -kVoxel - 0.1}) {
    const motion::SimulatedProgram program =
        program_of(job, fmt::format("G0 X-20 Y12 Z30\nG0 Z-5\nG1 X50 F900\nG0 Z30\nX-20\nZ-9\nG1 X50\nG0 Z30\n"
                                    "G0 X-20\nZ{:.3f}\nG1 X50\nG0 Z30\n",
                                    clearance - 16));
    for (const Mat3& turn : random_turns())
      EXPECT_EQ(found_in(job, program, turn), clearance > 0 ? "" : "line 14: holder\n") << clearance;
  }
}

/// A tool that turns about its tip, one line for every tenth of a degree.
motion::SimulatedProgram tilting(const machine::Job& job, const Vec3& tip, double from_deg, double to_deg,
                                 double step_deg) {
  const int n = static_cast<int>(std::lround((to_deg - from_deg) / step_deg));
  std::string lines = fmt::format("G0 X{} Y{} Z{}\n", tip.x() - 1, tip.y(), tip.z());
  for (int i = 0; i <= n; ++i) lines += fmt::format("G1 X{:.4f} F900\n", tip.x() + 1e-3 * (i + 1));
  motion::SimulatedProgram program = program_of(job, lines);
  program.path = {};
  std::uint32_t move = 0;
  while (program.moves_in_part().moves[move].kind != nc::MoveKind::linear) ++move;
  for (int i = 0; i <= n; ++i) {
    removal::Stamp s;
    s.t_s = 0.01 * i;
    s.pose.tip_mm = tip;
    const double angle = rad_from_deg(from_deg + i * step_deg);
    s.pose.axis = {std::sin(angle), 0, std::cos(angle)};
    s.first = i == 0;
    s.move = move + static_cast<std::uint32_t>(i);
    program.path.stamps.push_back(s);
  }
  program.path.runs = {{1, 0, program.path.stamps.size(), removal::RunKind::milling}};
  return program;
}

TEST(Collisions, HolderThatTiltsTowardsAWallMeetsItAtTheAngleOfTheClosedForm) {
  // The upper rim of the holder, R = 12 at H = 46, is at x = H sin a + R cos a; the wall stands at x = 17.
  const machine::Job job = job_of();
  const removal::Stock wall = stock_of(Mat3::Identity(), {17, -30, 0}, {25, 30, 60}, 0.1);
  const double reach = 17 + 0.1, angle = std::asin(reach / std::hypot(46, 12)) - std::atan2(12, 46);
  const motion::SimulatedProgram program = tilting(job, {0, 0, 5}, 0, 30, 0.1);
  const auto found = find_collisions(job, program, wall);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().part, Part::holder);
  const double at_deg = 0.1 * static_cast<double>(found.front().move - program.path.stamps.front().move);
  EXPECT_GE(at_deg, deg_from_rad(angle));
  // Places are half a millimetre apart, at the holder's top 0.6 degrees.
  EXPECT_LT(at_deg, deg_from_rad(angle) + 0.7);
  const double safe_deg = deg_from_rad(std::asin((17 - 0.1) / std::hypot(46, 12)) - std::atan2(12, 46));
  EXPECT_TRUE(find_collisions(job, tilting(job, {0, 0, 5}, 0, safe_deg, safe_deg / 100), wall).empty());
}

TEST(Collisions, ToolThatSwingsThroughAPostBetweenTwoPlacesIsFound) {
  machine::Job job = job_of();
  job.tools[1].holder = {{4, 4, 100}};
  const removal::Stock post = stock_of(Mat3::Identity(), {-0.5, -2, 90}, {0.5, 2, 110}, 0.2);
  EXPECT_FALSE(find_collisions(job, tilting(job, Vec3::Zero(), -5, 5, 10), post).empty());
  EXPECT_TRUE(find_collisions(job, tilting(job, Vec3::Zero(), 2, 5, 3), post).empty());
}

}  // namespace
}  // namespace camber::checks
