// Programs with rotary motion, from text to loads: the same path on the part is the same cut, on any machine and in any
// coordinates.

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "simulate/predict_path.h"
#include "tests/support/cutting.h"
#include "tests/support/plate_job.h"

namespace camber::simulate {
namespace {

/// A plate of 5 mm by 2 mm.
machine::Job job_on(const std::string& machine) {
  return testing::job_without_inertia(machine, {{0, 0, -1}, {5, 2, 0}});
}

const std::string kStart = "G21 G90 G94\nG10 L2 P1 X0 Y0 Z-100\nG10 L1 P1 R90\nT1 M6\nS6000 M3\nG54\n";

/// Rows along X, 0.2 mm deep at the tip, by points and axes of the tool on the part.
struct Point {
  Vec3 tip, axis;
  bool rapid = false;
};

std::vector<Point> rows(double lead_from_deg, double lead_to_deg, double tilt_deg) {
  constexpr int kPieces = 72;
  std::vector<Point> out;
  for (const double y : {0.4, 0.9, 1.4}) {
    for (int i = 0; i <= kPieces; ++i) {
      const double u = static_cast<double>(i) / kPieces,
                   lead = rad_from_deg(lead_from_deg + u * (lead_to_deg - lead_from_deg)),
                   tilt = rad_from_deg(tilt_deg);
      const Vec3 axis = Vec3(-std::sin(lead), std::sin(tilt) * std::cos(lead), std::cos(tilt) * std::cos(lead));
      const Vec3 tip = Vec3(9 - 13 * u, y, 3 - 0.2) - 3 * axis;
      if (i == 0) out.push_back({tip + 8 * axis, axis, true});
      out.push_back({tip, axis});
    }
    out.push_back({out.back().tip + 8 * out.back().axis, out.back().axis});
  }
  return out;
}

/// The same text for every machine: directions of the tool (G43.5).
std::string by_directions(const std::vector<Point>& points) {
  std::string text = kStart + "G43.5 H1\n";
  for (const Point& p : points)
    text += fmt::format("G{} X{:.6f} Y{:.6f} Z{:.6f} I{:.9f} J{:.9f} K{:.9f}{}\n", p.rapid ? 0 : 1, p.tip.x(),
                        p.tip.y(), p.tip.z(), p.axis.x(), p.axis.y(), p.axis.z(), p.rapid ? "" : " F1200");
  return text + "M30\n";
}

struct Cut {
  SimulatedProgram program;
  Prediction prediction;
};

Cut cut_of(const machine::Job& job, const std::string& text) {
  Diagnostics found;
  Cut out{motion::simulate_motion(SourceText("p.nc", text), job, {}, found), {}};
  const Target target = make_target(job, out.program, found);
  out.prediction = predict(job, target, out.program, {});
  for (const auto& d : found.all()) EXPECT_NE(d.severity, Severity::error) << d.message;
  return out;
}

struct Sums {
  Vec3 force_N = Vec3::Zero();
  double lateral_N = 0, axial_N = 0, chip_mm3 = 0, stock_mm3 = 0, p95_um = 0, largest_N = 0;
};

Sums sums_of(const Cut& cut) {
  Sums out;
  const auto& loads = cut.prediction.cut.loads;
  for (const StampLoad& load : loads) {
    out.force_N += load.force_mean_N / static_cast<double>(loads.size());
    out.lateral_N += load.lateral_max_N / static_cast<double>(loads.size());
    out.axial_N += load.axial_max_N / static_cast<double>(loads.size());
    out.largest_N = std::max(out.largest_N, load.lateral_max_N);
  }
  out.chip_mm3 = cut.prediction.cut.chip_mm3;
  out.stock_mm3 = cut.prediction.cut.stock_mm3;
  out.p95_um = cut.prediction.form_error_um.p95;
  return out;
}

void expect_same(const Sums& is, const Sums& should, double fraction) {
  EXPECT_GT(should.largest_N, 10);
  EXPECT_LT((is.force_N - should.force_N).norm(), fraction * should.largest_N);
  EXPECT_NEAR(is.lateral_N, should.lateral_N, fraction * should.largest_N);
  EXPECT_NEAR(is.axial_N, should.axial_N, fraction * should.largest_N);
  EXPECT_NEAR(is.chip_mm3, should.chip_mm3, fraction * should.chip_mm3);
  EXPECT_NEAR(is.stock_mm3, should.stock_mm3, fraction * should.stock_mm3);
  EXPECT_NEAR(is.p95_um, should.p95_um, 0.05 * should.p95_um);
}

/// Angles of the axes at a point, next to those before.
kinematics::Joints joints_at(const kinematics::Chain& chain, const Point& p, const Vec3& origin,
                             const kinematics::Joints& near) {
  const auto solution = chain.solve({p.tip - origin, p.axis}, 90, near);
  EXPECT_EQ(solution.reach, kinematics::Reach::reached);
  return solution.joints;
}

}  // namespace

TEST(RotaryMotion, OnePathOnThreeMachinesIsOneCut) {
  const std::string text = by_directions(rows(10, 30, 5));
  const Sums first = sums_of(cut_of(job_on("table_bc"), text));
  for (const char* machine : {"head_table", "head_head"}) {
    SCOPED_TRACE(machine);
    expect_same(sums_of(cut_of(job_on(machine), text)), first, 0.01);
  }
}

/// The same path in positions of the axes, on a machine whose table turns and one whose head does.
TEST(RotaryMotion, PositionsOfTheAxesCutAsTipControlDoes) {
  const std::vector<Point> points = rows(10, 30, 5);
  for (const char* name : {"table_bc", "head_head"}) {
    SCOPED_TRACE(name);
    const machine::Job job = job_on(name);
    const Sums by_tip = sums_of(cut_of(job, by_directions(points)));
    const kinematics::Chain chain(job.machine);
    const Vec3 origin(0, 0, 100);  // of the machine, on the part
    std::string text = kStart + "G43 H1\n";
    kinematics::Joints joints;
    Vec3 last = points.front().tip;
    for (const Point& p : points) {
      joints = joints_at(chain, p, origin, joints);
      const Vec3 xyz = joints.linear_mm - Vec3(0, 0, 90) + job.machine.kinematics.gauge_point_mm + origin;
      const double length = (p.tip - last).norm();
      text += fmt::format("{} X{:.7f} Y{:.7f} Z{:.7f}", p.rapid ? "G94 G0" : "G93 G1", xyz.x(), xyz.y(), xyz.z());
      for (const char letter : job.machine.kinematics.rotary_axes())
        text += fmt::format(" {}{:.8f}", static_cast<char>(letter - 'a' + 'A'),
                            deg_from_rad(joints.rotary_rad[letter - 'a']));
      text += p.rapid ? "\n" : fmt::format(" F{:.6f}\n", 1200 / length);
      last = p.tip;
    }
    expect_same(sums_of(cut_of(job, text + "M30\n")), by_tip, 0.01);
  }
}

TEST(RotaryMotion, WithoutTiltThePathIsTheOneOfThreeAxes) {
  const machine::Job job = job_on("table_bc");
  const std::string rest = "G1 Z-0.2 F300\nX-4 F1200\nG0 Z5\nX9 Y1\nG1 Z-0.2 F300\nX-4 F1200\nG0 Z5\n";
  // A program that never turned would be read as one of three axes: this one turns its table when all is cut.
  const Cut three = cut_of(job, kStart + "G43 H1\nG0 X9 Y0.5 Z5\n" + rest + "M30\n"),
            five = cut_of(job, kStart + "G43.4 H1\nG0 X9 Y0.5 Z5 B0 C0\n" + rest + "G0 C90\nM30\n");
  EXPECT_FALSE(three.program.turns());
  ASSERT_TRUE(five.program.turns());
  EXPECT_TRUE(removal::all_upright(five.program.path.stamps));
  ASSERT_EQ(five.program.path.stamps.size(), three.program.path.stamps.size());
  for (std::size_t k = 0; k < three.program.path.stamps.size(); ++k) {
    const removal::Stamp &a = three.program.path.stamps[k], &b = five.program.path.stamps[k];
    ASSERT_LT((a.pose.tip_mm - b.pose.tip_mm).norm(), 1e-9) << k;
    ASSERT_NEAR(a.fraction, b.fraction, 1e-9);
    ASSERT_EQ(a.move, b.move);
    ASSERT_EQ(a.first, b.first);
    const StampLoad &p = three.prediction.cut.loads[k], &q = five.prediction.cut.loads[k];
    ASSERT_NEAR(p.lateral_max_N, q.lateral_max_N, 1e-4) << k;
    ASSERT_NEAR(p.axial_max_N, q.axial_max_N, 1e-4) << k;
  }
  EXPECT_NEAR(three.prediction.form_error_um.p95, five.prediction.form_error_um.p95, 1e-3);
}

/// Rotary axes turn, the tip stays: the stamps turn with them, and belong to the blocks that turn them.
TEST(RotaryMotion, ATipThatStandsStillHasStampsOfEveryBlock) {
  machine::Job job = job_on("table_bc");
  std::string text = kStart + "G43.4 H1\nG0 X2 Y1 Z5 B0 C0\nG1 Z-0.2 F300\n";
  for (int b = 1; b <= 8; ++b) text += fmt::format("G1 B{} F1000\n", 5 * b);
  Diagnostics found;
  const SimulatedProgram program = motion::simulate_motion(SourceText("p.nc", text + "G0 Z20\nM30\n"), job, {}, found);
  std::map<std::uint32_t, std::size_t> of_block;
  for (const removal::Stamp& stamp : program.path.stamps) ++of_block[program.moves_in_part().moves[stamp.move].block];
  ASSERT_GE(of_block.size(), 9u);
  double last = -1;
  for (const removal::Stamp& stamp : program.path.stamps) {
    const double tilt = deg_from_rad(std::acos(std::min(1.0, stamp.pose.axis.z())));
    EXPECT_GE(tilt, last - 1e-6);
    last = tilt;
  }
  EXPECT_NEAR(last, 40, 0.5);
  // 5 degrees at 1000 degrees/min are 0.3 s, of which a passing of 5 ms is a sixtieth.
  for (const auto& [block, count] : of_block)
    if (block >= 9 && block <= 16) {
      EXPECT_NEAR(static_cast<double>(count), 60, 4) << block;
    }
}

/// A revolution of the table in one block: the target follows the curve, not the chord from its start to its end, which
/// has no length.
TEST(RotaryMotion, ATurnOfTheTableInOneBlockCutsAGroove) {
  machine::Job job = job_on("table_bc");
  job.stock.box = machine::Box{{-8, -8, -2}, {8, 8, 0}};
  job.machine.rotary[2].point_mm = Vec3::Zero();
  const Cut cut = cut_of(job, kStart + "G43 H1\nG0 X5 Y0 Z5 B0 C0\nG1 Z-0.5 F300\nG93 G1 C360 F10\nG94 G0 Z20\nM30\n");
  std::size_t around = 0;
  double radius = 0;
  for (const removal::Stamp& stamp : cut.program.path.stamps) {
    if (stamp.pose.tip_mm.z() > -0.499) continue;
    ++around;
    radius = std::max(radius, std::abs(stamp.pose.tip_mm.head<2>().norm() - 5));
  }
  EXPECT_GT(around, 1000u);
  EXPECT_LT(radius, 2e-3);
  // Volume of the groove: a segment of a circle of 3 mm, 0.5 mm deep, swept along 2 pi 5 mm (Pappus).
  const double half = std::acos(2.5 / 3), area = 9 * (half - std::sin(half) * std::cos(half));
  EXPECT_NEAR(cut.prediction.cut.stock_mm3, area * 2 * kPi * 5, 0.02 * area * 2 * kPi * 5);
  EXPECT_LT(cut.prediction.form_error_um.p95, 40);
}

}  // namespace camber::simulate
