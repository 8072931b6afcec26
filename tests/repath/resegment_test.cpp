#include "repath/resegment/resegmentation.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "repath/resegment/fastest.h"
#include "tests/support/path_distance.h"
#include "tests/support/read_text.h"

using namespace camber;
using namespace camber::repath;
using camber::tests::Read;
using camber::tests::read;

namespace {

/// Greatest distance between two polylines, both ways, by dense points.
double apart_mm(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  const auto dense = [](const std::vector<Vec3>& p) {
    std::vector<Vec3> out;
    for (std::size_t k = 0; k + 1 < p.size(); ++k) {
      const int n = 1 + static_cast<int>((p[k + 1] - p[k]).norm() / 0.002);
      for (int i = 0; i < n; ++i) out.push_back(p[k] + static_cast<double>(i) / n * (p[k + 1] - p[k]));
    }
    out.push_back(p.back());
    return out;
  };
  const auto da = dense(a), db = dense(b);
  return std::max(tests::farthest_from(da, db, 0.05), tests::farthest_from(db, da, 0.05));
}

/// An arc in space of radius 10, in chords of uneven length, rounded to 0.001 mm.
std::vector<Vec3> arc_in_space(double chord_mm) {
  std::vector<Vec3> out;
  const Eigen::AngleAxisd turn(0.5, Vec3(0.3, 0.9, 0.1).normalized());
  double at = 0;
  for (int k = 0; at < 2; ++k) {
    const Vec3 p = 1000 * (turn * Vec3(10 * std::cos(at), 10 * std::sin(at), 0));
    out.push_back(Vec3(std::round(p.x()), std::round(p.y()), std::round(p.z())) / 1000);
    at += chord_mm / 10 * (k % 3 == 0 ? 0.5 : 1.2);
  }
  return out;
}

ResegmentOptions within(double tolerance_mm) { return {.tolerance_mm = tolerance_mm}; }

}  // namespace

TEST(SmoothCurve, WithoutToleranceIsTheNaturalSpline) {
  // Through (0,0) (1,1) (2,0), parameter the chords: second derivative at the middle -3 / h^2 times 1 in y.
  const std::vector<Vec3> points{{0, 0, 0}, {1, 1, 0}, {2, 0, 0}};
  const SmoothCurve curve(points, 0);
  const double h = std::sqrt(2.0);
  EXPECT_NEAR(curve.length_mm(), 2 * h, 1e-12);
  EXPECT_LT((curve.at(h) - points[1]).norm(), 1e-12);
  // y(h/2) of the natural spline through 0, 1, 0: 1/2 + 3/16.
  EXPECT_NEAR(curve.at(h / 2).y(), 0.5 + 3.0 / 16, 1e-12);
  EXPECT_NEAR(curve.at(h / 2).x(), 0.5, 1e-12);
}

TEST(SmoothCurve, StraightensANoisyLineWithinTheToleranceAndHoldsTheEnds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.004, 0.004);
  std::vector<Vec3> points;
  for (int k = 0; k <= 200; ++k) points.emplace_back(0.1 * k, noise(random), noise(random));
  const SmoothCurve curve(points, 0.006);
  EXPECT_LE(curve.largest_move_mm(), 0.006);
  EXPECT_GT(curve.largest_move_mm(), 0.003);
  EXPECT_EQ(curve.at(0), points.front());
  EXPECT_LT((curve.at(curve.length_mm()) - points.back()).norm(), 1e-12);
  const auto bending = [&](const SmoothCurve& c) {
    double sum = 0;
    const double step = 0.05;
    for (double s = step; s < c.length_mm() - step; s += step)
      sum += (c.at(s + step) - 2 * c.at(s) + c.at(s - step)).squaredNorm();
    return sum;
  };
  EXPECT_LT(bending(curve), 0.02 * bending(SmoothCurve(points, 0)));
}

TEST(LayOut, SegmentsAreAsLongAsAskedForAndNearTheOldPath) {
  const std::vector<Vec3> old = arc_in_space(0.08);
  for (const double length : {0.15, 0.3, 0.6}) {
    const Layout layout = lay_out(old, within(0.01), length, 0.001);
    EXPECT_EQ(layout.points.front(), old.front());
    EXPECT_EQ(layout.points.back(), old.back());
    for (std::size_t k = 1; k < layout.points.size(); ++k)
      EXPECT_GT((layout.points[k] - layout.points[k - 1]).norm(), 0.97 * length) << length;
    EXPECT_LE(layout.deviation_mm, 0.01);
    EXPECT_LE(apart_mm(old, layout.points), layout.deviation_mm + 2e-4);
  }
}

TEST(LayOut, SegmentsAreShorterWhereTheToleranceAsksForIt) {
  const std::vector<Vec3> old = arc_in_space(0.08);
  const Layout layout = lay_out(old, within(0.004), 5, 0.001);
  EXPECT_LE(apart_mm(old, layout.points), 0.004 + 2e-4);
  // A chord of sagitta 0.004 on radius 10 is 0.57 mm long.
  double longest = 0;
  for (std::size_t k = 1; k < layout.points.size(); ++k)
    longest = std::max(longest, (layout.points[k] - layout.points[k - 1]).norm());
  EXPECT_LT(longest, 0.9);
  EXPECT_GT(longest, 0.3);
}

TEST(LayOut, CornersStayWhereTheyAre) {
  std::vector<Vec3> old;
  for (int k = 0; k <= 50; ++k) old.emplace_back(0.1 * k, 0, 0.002 * k * k * 0.01);
  for (int k = 1; k <= 50; ++k) old.emplace_back(5, 0.1 * k, 0.05);
  const Layout layout = lay_out(old, within(0.01), 0.37, 0.001);
  EXPECT_EQ(layout.corners, 1u);
  EXPECT_NE(std::find(layout.points.begin(), layout.points.end(), old[50]), layout.points.end());
}

TEST(LayOut, PointsThatLieFarApartStay) {
  const std::vector<Vec3> old{{0, 0, 0}, {10, 0, 0}, {19, 3, 0}, {27, 8, 0}, {33, 15, 0}};
  const Layout layout = lay_out(old, within(0.01), 1, 0.001);
  EXPECT_EQ(layout.points, old);
  EXPECT_EQ(layout.deviation_mm, 0);
}

TEST(LayOut, RandomPathsStayWithinTheTolerance) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> turn(-0.25, 0.25), step(0.02, 0.6), any(0, 1);
  for (int n = 0; n < 16; ++n) {
    std::vector<Vec3> old{{0, 0, 0}};
    double heading = 0, climb = 0;
    for (int k = 0; k < 120; ++k) {
      heading += any(random) < 0.05 ? 8 * turn(random) : turn(random) * 0.4;
      climb = 0.9 * climb + 0.3 * turn(random);
      const Vec3 p = old.back() + step(random) * Vec3(std::cos(heading), std::sin(heading), climb);
      old.emplace_back(Vec3(std::round(1000 * p.x()), std::round(1000 * p.y()), std::round(1000 * p.z())) / 1000);
    }
    const double tolerance = n % 2 ? 0.02 : 0.005;
    const Layout layout = lay_out(old, within(tolerance), 0.25, 0.001);
    ASSERT_LE(layout.deviation_mm, tolerance);
    // As points 0.002 mm apart show it.
    ASSERT_LE(apart_mm(old, layout.points), tolerance + 3e-4) << n;
  }
}

TEST(Resegment, TheLengthIsFeedTimesBlockTime) {
  // KAKEN report: F8000 and 1 or 2 ms.
  EXPECT_NEAR(segment_length_mm(8000.0 / 60, 0.001), 0.1333, 1e-4);
  EXPECT_NEAR(segment_length_mm(8000.0 / 60, 0.002), 0.2667, 1e-4);
}

TEST(Resegment, EverythingElseStaysByteForByte) {
  const std::string before = "%\nO1 (PART)\nN10 G21 G90 G17\nT1 M6\nS8000 M3\nG0 X0. Y0. Z5.\n(CUT)\n";
  const std::string behind = "M9 ; off\nG1 X9. Y3. F400\nG0 Z20.\nM30\n%\n";
  std::string cut = "N20 G1 X0.05 Y0. Z5. F1200\n";
  for (int k = 2; k <= 60; ++k)
    cut += "N" + std::to_string(19 + k) + " X" + std::to_string(0.05 * k).substr(0, 4) + "\n";
  const Read old = read(before + cut + behind);
  ResegmentOptions options = within(0.01);
  options.length_mm = 0.5;
  const Resegmentation result = resegment(old.program, old.moves, options);
  EXPECT_EQ(result.text, before + "N29 G1 X0.5 F1200\nN39 X1.\nN49 X1.5\nN59 X2.\nN69 X2.5\nN79 X3.\n" + behind);
  options.feed_factor = 0.5;
  EXPECT_EQ(resegment(old.program, old.moves, options).text,
            before + "N29 G1 X0.5 F600.\nN39 X1.\nN49 X1.5\nN59 X2.\nN69 X2.5\nN79 X3.\nF1200.\n" + behind);
}

TEST(Resegment, ReadsAndWritesIncrementsAndInches) {
  for (const std::string head : {"G20 G91\n", "G21 G91\n", "G20 G90\n"}) {
    const bool incremental = head.find("G91") != std::string::npos;
    std::string text = head + "G0 X0. Y0. Z0.\nG1 X0. Y0. Z0. F50.\n";
    for (int k = 1; k <= 80; ++k)
      text += "X" + std::to_string(incremental ? 0.01 : 0.01 * k).substr(0, 6) + " Z" +
              std::to_string(incremental ? 0.0001 * (2 * k - 1) : 0.0001 * k * k).substr(0, 6) + "\n";
    text += "M30\n";
    const Read old = read(text);
    ResegmentOptions options = within(0.01);
    options.length_mm = head.starts_with("G20") ? 2.5 : 0.1;
    const Resegmentation result = resegment(old.program, old.moves, options);
    const Read now = read(result.text);
    EXPECT_LT(now.moves.moves.size(), old.moves.moves.size() / 2) << head;
    EXPECT_LE(tests::hausdorff_mm(old.moves, now.moves, 0.005), 0.0102) << head;
    EXPECT_LT((now.moves.moves.back().end_mm - old.moves.moves.back().end_mm).norm(), 1e-9);
  }
}

/// Rows over a bow in blocks of 0.1 mm, F8000.
std::string bow() {
  std::string text = "G21 G90 G17\nG0 X0. Y0. Z5.\nG1 F8000\n";
  for (int row = 0; row < 4; ++row)
    for (int k = 0; k <= 300; ++k) {
      const double x = 0.1 * (row % 2 ? 300 - k : k);
      text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", x, 0.5 * row, 3 * std::sin(x / 7));
    }
  return text + "M30\n";
}

TEST(Fastest, IsAsFastAsTheBestOfAllLengths) {
  const Read old = read(bow());
  for (const double block_time_s : {0.002, 0.0})
    for (const double position_gain : {0.0, 60.0}) {
      machine::Machine machine;
      machine.control.block_time_s = block_time_s;
      for (auto& axis : machine.axis) {
        axis.acceleration_mm_per_s2 = 3000;
        if (position_gain > 0) axis.position_gain_per_s = position_gain;
      }
      const ContourFigures before = contour_figures(old.moves, old.moves, machine);
      FastestOptions options;
      options.layout = within(0.01);
      options.contour_mm = 1;  // every length keeps to it
      const Fastest found = find_fastest(old.program, old.moves, machine, before, options);
      EXPECT_LT(found.tried.size(), 9u);
      double least = 1e9;
      for (const double factor : {1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 6.3, 10.0}) {
        ResegmentOptions layout = options.layout;
        layout.block_time_s = block_time_s;
        layout.length_factor = factor;
        const Read now = read(resegment(old.program, old.moves, layout).text);
        least = std::min(least, contour_figures(now.moves, old.moves, machine).time_s);
      }
      EXPECT_LE(found.tried[found.chosen].figures.time_s, 1.001 * least) << block_time_s << ' ' << position_gain;
    }
}

/// As bow(), in blocks of 0.03 to 0.5 mm, so that the control runs unevenly.
std::string uneven_bow() {
  std::string text = "G21 G90 G17\nG0 X0. Y0. Z5.\nG1 F8000\n";
  constexpr double kSteps[] = {0.03, 0.41, 0.07, 0.5, 0.11, 0.29, 0.05};
  for (int row = 0; row < 6; ++row) {
    double along = 0;
    for (int k = 0; along < 30; along = std::min(30.0, along + kSteps[++k % 7])) {
      const double x = row % 2 ? 30 - along : along;
      text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", x, 0.3 * row, 2 * std::sin(x / 9));
    }
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", row % 2 ? 0.0 : 30.0, 0.3 * row,
                        row % 2 ? 0.0 : 2 * std::sin(30.0 / 9));
  }
  return text + "M30\n";
}

/// Two milliseconds a block, axes that lag.
machine::Machine two_ms_control() {
  machine::Machine machine;
  machine.control.block_time_s = 0.002;
  for (auto& axis : machine.axis) {
    axis.acceleration_mm_per_s2 = 3000;
    axis.position_gain_per_s = 40;
  }
  return machine;
}

TEST(Fastest, KeepsToBothLimitsAndIsFasterThanAnyFeedAlone) {
  const Read old = read(uneven_bow());
  const machine::Machine machine = two_ms_control();
  const ContourFigures before = contour_figures(old.moves, old.moves, machine);
  FastestOptions options;
  options.layout = within(0.01);
  const Fastest found = find_fastest(old.program, old.moves, machine, before, options);
  ASSERT_TRUE(found.within_limit);
  ASSERT_TRUE(found.gains);
  const Candidate& chosen = found.tried[found.chosen];
  EXPECT_LE(chosen.figures.contour_max_mm, std::max(before.contour_max_mm, 0.01));
  EXPECT_LE(chosen.figures.contour_rms_mm, std::max(before.contour_rms_mm, 0.01));
  EXPECT_LT(chosen.figures.time_s, before.time_s);
  // What is written is what was predicted.
  const Read now = read(found.path.text);
  const ContourFigures again = contour_figures(now.moves, old.moves, machine);
  EXPECT_EQ(again.time_s, chosen.figures.time_s);
  EXPECT_EQ(again.contour_rms_mm, chosen.figures.contour_rms_mm);
  // The feed of all alone, in steps of a twentieth.
  for (double feed = 1; feed > 0.25; feed -= 0.05)
    for (const double length : {1.0, 4.0}) {
      ResegmentOptions layout = options.layout;
      layout.block_time_s = 0.002;
      layout.length_factor = length;
      layout.feed_factor = feed;
      const Read other = read(resegment(old.program, old.moves, layout).text);
      const ContourFigures f = contour_figures(other.moves, old.moves, machine);
      if (!found.limit.holds(f)) continue;
      EXPECT_LE(chosen.figures.time_s, f.time_s) << feed << ' ' << length;
    }
}

TEST(Fastest, WhereNothingKeepsToTheContourTheNearestIsTaken) {
  const Read old = read(bow());
  const machine::Machine machine = two_ms_control();
  FastestOptions options;
  options.layout = within(0.01);
  options.contour_mm = 1e-4;
  const Fastest found =
      find_fastest(old.program, old.moves, machine, contour_figures(old.moves, old.moves, machine), options);
  EXPECT_FALSE(found.within_limit);
  EXPECT_LE(found.tried.size(), 9u + 70);
  for (const Candidate& c : found.tried)
    EXPECT_GE(c.figures.contour_max_mm, found.tried[found.chosen].figures.contour_max_mm);
}

TEST(Fastest, AnOldProgramThatDoesNotKeepToTheContourIsNotSaidToDoSo) {
  // Blocks of 10 mm: nothing can be laid out again, and nothing becomes faster.
  const Read old = read("G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X10. F6000\nX20. Y1.\nX20. Y10.\nX10.\nM30\n");
  machine::Machine machine;
  for (auto& axis : machine.axis) axis.position_gain_per_s = 30, axis.acceleration_mm_per_s2 = 3000;
  FastestOptions options;
  options.layout = within(0.01);
  const ContourFigures before = contour_figures(old.moves, old.moves, machine);
  const Fastest kept = find_fastest(old.program, old.moves, machine, before, options);
  EXPECT_FALSE(kept.gains);
  EXPECT_TRUE(kept.within_limit);
  EXPECT_EQ(kept.path.text, old.program.source.text());
  options.contour_mm = 0.5 * before.contour_max_mm;
  const Fastest found = find_fastest(old.program, old.moves, machine, before, options);
  // Slower about its corners it may: then it must be so, and if not it must be said.
  if (found.within_limit) {
    const Read now = read(found.path.text);
    EXPECT_LE(contour_figures(now.moves, old.moves, machine).contour_max_mm, options.contour_mm);
  }
}

TEST(CornerFeeds, StepsBetweenSharpCornersTakeTheirTimeAndCornersTheirShare) {
  // Two rows of a level part, 0.3 mm apart, in blocks of 0.5 mm.
  std::string text = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 F6000\n";
  for (int row = 0; row < 2; ++row)
    for (int k = row; k <= 20; ++k) text += fmt::format("X{:.1f} Y{:.1f}\n", 0.5 * (row ? 21 - k : k), 0.3 * row);
  text.insert(text.rfind("X9.5 Y0.3"), "X10. Y0.3\n");
  const Read old = read(text + "M30\n");
  ResegmentOptions options = within(0.01);
  options.length_mm = 2.2;
  options.feed_factor = 0.5;
  options.corners = {0.25, 0.06};
  // 0.8 mm before a corner, 0.4 mm behind; 0.3 mm in 0.06 s are 300 mm/min.
  EXPECT_EQ(resegment(old.program, old.moves, options).text,
            "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 F6000\nX2.3 F3000.0\nX4.6\nX6.9\nX9.2\nX10.0 F750.0\nY0.3 F300.0\n"
            "X9.6 F750.0\nX7.325 F3000.0\nX5.05\nX2.775\nX0.5\nF6000.0\nM30\n");
}

TEST(Contour, ACircleShrinksAsThePositionLoopSays) {
  // First-order lag: radius R / sqrt(1 + (v / (R Kp))^2).
  const Read circle = read("G21 G90 G17\nG0 X20. Y0. Z0.\nG2 X20. Y0. I-20. J0. F3000\nG2 I-20. J0.\nM30\n");
  machine::Machine machine;
  for (auto& axis : machine.axis) {
    axis.position_gain_per_s = 40;
    axis.acceleration_mm_per_s2 = 1e5;
  }
  const ContourFigures figures = contour_figures(circle.moves, circle.moves, machine);
  const double ratio = 50.0 / (20 * 40);
  EXPECT_NEAR(figures.contour_max_mm, 20 - 20 / std::sqrt(1 + ratio * ratio), 1e-3);
  machine::Machine exact;
  EXPECT_LT(contour_figures(circle.moves, circle.moves, exact).contour_max_mm, 1e-3);
}
