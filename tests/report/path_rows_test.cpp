#include "report/path_rows.h"

#include <cmath>

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::report {
namespace {

nc::Interpretation moves_of(const std::string& text) {
  Diagnostics diagnostics;
  const auto program = nc::read_program(SourceText("p.nc", text), diagnostics);
  return nc::interpret(program, {}, diagnostics);
}

/// Samples of a straight cut along X at 600 mm/min, one a millisecond, with one slow and one fast one.
std::vector<feedmodel::TimedSample> straight_samples() {
  std::vector<feedmodel::TimedSample> out(100);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].t_s = 0.001 * static_cast<double>(i);
    out[i].position_mm = out[i].command_mm = Vec3(0.01 * static_cast<double>(i), 0, 0);
    out[i].velocity_mm_per_s = Vec3(i == 33 ? 2 : i == 37 ? 11 : 10, 0, 0);
    out[i].feed_command_mm_per_s = 10;
  }
  return out;
}

TEST(PathRows, KeepTheSlowestAndTheFastestOfEveryPeriod) {
  const auto program = moves_of("G21 G90\nG1 X1. F600\nM30\n");
  PathCollector collector(program, 0.01);
  const auto samples = straight_samples();
  collector.add(std::span(samples).first(35));  // a period may come in two runs
  collector.add(std::span(samples).subspan(35));
  const auto rows = collector.take();
  ASSERT_EQ(rows.size(), 12u);  // ten periods, two more rows in one
  EXPECT_DOUBLE_EQ(rows[4].t_s, 0.033);
  EXPECT_DOUBLE_EQ(rows[4].feed_mm_per_min, 120);
  EXPECT_DOUBLE_EQ(rows[5].t_s, 0.037);
  EXPECT_DOUBLE_EQ(rows[5].feed_mm_per_min, 660);
  EXPECT_EQ(rows[5].block, 2u);
  EXPECT_TRUE(rows[5].cutting);
}

TEST(PathRows, TakeTheLoadsOfTheirStamps) {
  std::vector<PathRow> rows(10);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].t_s = 0.01 * static_cast<double>(i);
  // Teeth every 15 ms from 20 to 65 ms: some rows hold none and go on with the tooth before; nothing is cut before
  // the first and after the last.
  removal::StampPath path;
  std::vector<simulate::StampLoad> loads;
  std::vector<simulate::ChatterMargins::Passage> chatter;
  for (int k = 0; k < 4; ++k) {
    removal::Stamp stamp;
    stamp.t_s = 0.021 + 0.015 * k;
    stamp.first = k == 0;
    path.stamps.push_back(stamp);
    simulate::StampLoad load;
    load.lateral_max_N = 10 + k;
    load.contact_deflection_mm = Vec3(0.003, 0.004, 0);
    load.chip_max_mm = 0.05;
    loads.push_back(load);
    chatter.push_back({k == 2 ? 0.0f : 0.25f * static_cast<float>(4 - k), 500});  // 2: no cut
  }
  add_loads(rows, path, loads, chatter);
  const double nan = kNothingHere;
  const std::vector<double> expected{nan, nan, 10, 11, 11, 12, 13, nan, nan, nan};
  const std::vector<double> margins{nan, nan, 1, 0.75, 0.75, nan, 0.25, nan, nan, nan};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::isnan(expected[i])) {
      EXPECT_TRUE(std::isnan(rows[i].force_N)) << i;
    } else {
      EXPECT_EQ(rows[i].force_N, expected[i]) << i;
      EXPECT_TRUE(rows[i].margin == margins[i] || (std::isnan(rows[i].margin) && std::isnan(margins[i]))) << i;
      EXPECT_DOUBLE_EQ(rows[i].deflection_um, 5) << i;
      EXPECT_DOUBLE_EQ(rows[i].chip_um, 50) << i;
    }
  }

  std::vector<removal::SurfacePoint> surface(3);
  surface[0].machined_stamp = surface[1].machined_stamp = 1;
  surface[0].error_mm = 0.002;
  surface[1].error_mm = -0.007;
  surface[2].machined_stamp = -1;
  add_errors(rows, path, surface);
  EXPECT_DOUBLE_EQ(rows[3].error_um, -7);
  EXPECT_TRUE(std::isnan(rows[2].error_um));
}

TEST(PathRows, AreThinnedWithoutLosingAnyExtreme) {
  std::vector<PathRow> rows(100000);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].t_s = static_cast<double>(i);
    rows[i].feed_mm_per_min = 900 + std::sin(0.1 * static_cast<double>(i));
    rows[i].force_N = 20;
  }
  rows[12345].feed_mm_per_min = 3;
  rows[54321].force_N = 500;
  rows[77777].error_um = -31;
  const auto kept = rows_to_draw(rows, 5000);
  EXPECT_LE(kept.size(), 5000u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  for (const std::size_t must : {0u, 12345u, 54321u, 77777u, 99999u})
    EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), must)) << must;
  EXPECT_EQ(rows_to_draw(std::span(rows).first(5000), 5000).size(), 5000u);
}

std::vector<PathRow> rows_at(const std::vector<Vec3>& places) {
  std::vector<PathRow> rows;
  for (const Vec3& p : places) {
    PathRow row;
    row.command_mm = p;
    row.cutting = true;
    rows.push_back(row);
  }
  return rows;
}

TEST(PathShift, IsTheDistanceOfTheTwoPaths) {
  const auto given = moves_of("G21 G90\nG0 X0. Y0. Z0.\nG1 X10. F600\nG2 X20. Y-10. R10.\nG1 Y-20.\nM30\n");
  // From nothing up by 20 um along the line, out by 30 um around the arc, then back to none.
  const auto moved = moves_of(
      "G21 G90\nG0 X0. Y0. Z0.\nG1 X0. Y0.02 F600\nG1 X10. Y0.02\nG1 X10. Y0.03\nG2 X20.03 Y-10. R10.03\nG1 X20. "
      "Y-20.\n"
      "M30\n");
  const double s = std::sqrt(0.5);
  auto rows = rows_at(
      {{0, 0.02, 0}, {1, 0.02, 0}, {5, 0.02, 0}, {10 + 10.03 * s, -10 + 10.03 * s, 0}, {20.015, -15, 0}, {20, -20, 0}});
  add_shifts(rows, moved, given);
  const std::vector<double> expected_um{10, 20, 20, 30, 15, 0};
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_NEAR(rows[i].shift_um, expected_um[i], 1) << i;
}

TEST(PathShift, DoesNotTakeTheNeighbouringRowOfARaster) {
  // Rows 0.05 mm apart, moved by 0.04 mm towards the next one.
  const auto given = moves_of("G21 G90\nG0 X0. Y0. Z0.\nG1 X50. F600\nY0.05\nX0.\nY0.1\nX50.\nM30\n");
  const auto moved = moves_of("G21 G90\nG0 X0. Y0.04 Z0.\nG1 X50. F600\nY0.09\nX0.\nY0.14\nX50.\nM30\n");
  std::vector<Vec3> places;
  for (int i = 0; i <= 50; ++i) places.push_back({1.0 * i, 0.04, 0});
  for (int i = 0; i <= 50; ++i) places.push_back({50 - 1.0 * i, 0.09, 0});
  auto rows = rows_at(places);
  add_shifts(rows, moved, given);
  for (int i = 5; i <= 45; ++i) EXPECT_NEAR(rows[static_cast<std::size_t>(i)].shift_um, 40, 0.01) << i;
}

}  // namespace
}  // namespace camber::report
