// Rows that a neighbouring row hides: which they are, where the tool really is along them, and a raster to and fro.
#include "compensate/hidden_rows.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "nc/interpreter.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

/// Rows along X to and fro, 10 mm long and `step` apart, as one unbroken path of lines of 1 mm.
std::string rows_program(int rows, double step, double slope_x, double slope_y) {
  std::string out = "G21 G90 G17\nT1 M6\nG54 S3000 M3\nG0 X-4 Y-4 Z20\n";
  const auto z = [&](double x, double y) { return slope_x * x + slope_y * y; };
  for (int r = 0; r < rows; ++r)
    for (int i = 0; i <= 12; ++i) {
      const double x = r % 2 == 0 ? i - 3.0 : 9.0 - i, y = -3.5 + r * step;
      out += fmt::format("{}X{:.3f} Y{:.4f} Z{:.4f}{}\n", r + i == 0 ? "G1 " : "", x, y, z(x, y) - 1.2,
                         r + i == 0 ? " F900" : "");
    }
  return out + "G0 Z20\nM30\n";
}

nc::Interpretation moves_of(const std::string& text) {
  Diagnostics diagnostics;
  return nc::interpret(nc::read_program(SourceText("rows.nc", text), diagnostics), {}, diagnostics);
}

TEST(HiddenRows, RowsOfOnePathDifferWherePointsOfOneRowDoNot) {
  const nc::Interpretation moves = moves_of(rows_program(3, 0.3, 0, 0));
  std::vector<bool> selected;
  for (const nc::Move& move : moves.moves) selected.push_back(move.kind == nc::MoveKind::linear);
  const ShiftPath path(moves, selected, 0.4);
  const Rows rows(path);
  const auto near = [&](double x, double y) {
    std::size_t best = 0;
    for (std::size_t i = 0; i + 1 < path.points().size(); ++i)
      if ((path.points()[i].place_mm - Vec3(x, y, -1.2)).norm() <
          (path.points()[best].place_mm - Vec3(x, y, -1.2)).norm())
        best = i;
    return ShiftPath::PointInterval{best, 0};
  };
  EXPECT_FALSE(rows.differ(near(2, -3.5), near(4, -3.5))) << "2 mm along one row";
  EXPECT_TRUE(rows.differ(near(2, -3.5), near(2, -3.2)));
  EXPECT_TRUE(rows.differ(near(2, -3.5), near(2, -2.9)));
  EXPECT_FALSE(rows.differ(near(8.9, -3.5), near(8.9, -3.3))) << "around the end of a row it goes on";
}

TEST(HiddenRows, OffsetsAreWhereTheToolIsBesideTheProgrammedPath) {
  const nc::Interpretation moves = moves_of(rows_program(2, 0.3, 0, 0));
  std::vector<bool> selected;
  for (const nc::Move& move : moves.moves) selected.push_back(move.kind == nc::MoveKind::linear);
  const ShiftPath path(moves, selected, 0.4);
  simulate::SimulatedProgram machine{kinematics::MachineProgram({}, moves)};
  const auto offset_at = [](double y) { return Vec3(0, 0.003, y > -3.4 ? 0.02 : -0.01); };
  for (std::uint32_t m = 0; m < moves.moves.size(); ++m) {
    if (!selected[m]) continue;
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      removal::Stamp stamp;
      stamp.move = m;
      stamp.fraction = share;
      const Vec3 programmed = nc::point_at(moves, moves.moves[m], share);
      stamp.pose.tip_mm = programmed + offset_at(programmed.y());
      machine.path.stamps.push_back(stamp);
    }
  }
  const std::vector<Vec3> offsets = path_offsets(path, machine, machine, {});
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const ControlPoint& p = path.points()[i];
    if (p.place_mm.z() > -1.19 || std::abs(p.place_mm.x()) > 8) continue;  // the way down; the ends, where rows meet
    EXPECT_LT((offsets[i] - offset_at(p.place_mm.y())).norm(), 1e-9) << i;
  }
}

/// In every round: the surface shows what the second row cut, the first one's own error is added to it.
TEST(HiddenRows, WhatARowWouldLeaveIsObservedBesideWhatTheSurfaceShows) {
  simulate::SimulatedProgram given{kinematics::MachineProgram({}, moves_of(rows_program(2, 0.3, 0, 0)))};
  std::vector<bool> selected;
  for (const nc::Move& move : given.moves_in_part().moves) selected.push_back(move.kind == nc::MoveKind::linear);
  const ShiftPath path(given.moves_in_part(), selected, 0.4);
  const auto move_near = [&](double x, double y) {
    std::uint32_t m = 0;
    while (!selected[m] ||
           (nc::point_at(given.moves_in_part(), given.moves_in_part().moves[m], 0.5) - Vec3(x, y, -1.2)).norm() > 0.1)
      ++m;
    return m;
  };
  const std::uint32_t first = move_near(2.5, -3.5), second = move_near(2.5, -3.2);
  for (const std::uint32_t m : {first, second}) {
    removal::Stamp stamp;
    stamp.move = m;
    stamp.fraction = 0.5;
    stamp.pose.tip_mm = nc::point_at(given.moves_in_part(), given.moves_in_part().moves[m], 0.5);
    given.path.stamps.push_back(stamp);
  }
  const std::vector<simulate::PathFraction> target{{first, 0.5f}, {second, 0.5f}};
  removal::SurfacePoint above, below, own;
  above.normal = below.normal = own.normal = Vec3::UnitZ();
  above.area_mm2 = below.area_mm2 = own.area_mm2 = 0.01;
  above.error_mm = 0.001, below.error_mm = -0.004, own.error_mm = 0.002;
  above.target_stamp = below.target_stamp = own.target_stamp = 0;
  above.machined_stamp = below.machined_stamp = 1;
  own.machined_stamp = 0;
  const std::vector<removal::SurfacePoint> surface{above, below, own};
  const std::vector<Vec3> bending{Vec3(0, 0, 0.020), Vec3::Zero()};

  const machine::Job job;
  const Observed seen = observe(path, job, given, given, {}, surface, {target, bending});
  ASSERT_EQ(seen.hidden.size(), 2u) << "the row that cut its own point is not hidden";
  for (const Observation& o : seen.hidden) {
    EXPECT_DOUBLE_EQ(o.error_mm, 0.020);
    EXPECT_EQ(o.place.lower, path.find(first, 0.5).lower);
  }
  EXPECT_EQ(seen.of_path().size(), 4u) << "below and own as they are, above and below again";
  EXPECT_TRUE(observe(path, job, given, given, {}, surface, {target}).hidden.empty()) << "without what bends it";

  // What a first cut of the second row left last counts as not cut: the first row should have.
  std::vector<bool> first_cuts(given.moves_in_part().moves.size(), false);
  first_cuts[second] = true;
  const Observed repeated = observe(path, job, given, given, {}, surface, {target, {}, first_cuts});
  for (const Observation& o : repeated.points) EXPECT_EQ(o.place.lower, path.find(first, 0.5).lower);
}

/// On a plane that rises along the rows, an axis that lags more than the others makes every second row cut deeper.
machine::Job lagging_job(const tests::TempFolder& folder) {
  machine::Job job;
  job.path = folder / "job.toml";
  job.program = folder.write("rows.nc", rows_program(16, 0.25, 0.3, 0.8));
  for (auto& axis : job.machine.axis) {
    axis.acceleration_mm_per_s2 = 1000;
    axis.max_velocity_mm_per_s = 100;
    axis.position_gain_per_s = 40;
  }
  job.machine.axis[2].position_gain_per_s = 42.5;
  job.machine.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  machine::Tool tool;
  tool.number = 1;
  tool.diameter_mm = 6;
  tool.overhang_mm = 30;
  job.tools[1] = tool;
  job.material = {2000, 700, 0, 15, 15, 0};
  job.stock.box = machine::Box{{0, -2, -4}, {6, 0, 3}};
  job.stock.allowance_mm = 0.2;
  job.simulation.voxel_mm = 0.15;
  job.simulation.coupling = machine::Coupling::rigid;
  job.compensation.max_rounds = 3;
  job.compensation.tolerance_um = 1;
  job.compensation.levers = {machine::Lever::shift};
  job.compensation.max_overcut_um = 50;
  return job;
}

TEST(HiddenRows, ARasterToAndFroIsCorrectedThoughEverySecondRowIsHidden) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  const CompensationResult c = compensate(lagging_job(folder), diagnostics, {});
  std::string rounds;
  for (const Round& r : c.rounds)
    rounds += fmt::format("{:.2f} um p95, {:.2f} um rms\n", r.error_um.p95, r.error_um.rms);
  EXPECT_GT(c.figures.before_um.p95, 5);
  // Fitted to what the surface shows, the first round leaves 0.37 of it: the hidden rows stay where they are.
  EXPECT_LT(c.rounds[1].error_um.p95, 0.2 * c.figures.before_um.p95) << rounds;
  EXPECT_LT(c.figures.after_um.p95, 0.45 * c.figures.before_um.p95) << rounds;
  EXPECT_LT(c.figures.after_um.rms, 0.4 * c.figures.before_um.rms);
}

}  // namespace
}  // namespace camber::compensate
