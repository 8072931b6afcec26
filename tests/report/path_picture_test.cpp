// Paths for pictures: what is left out, and what never.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "nc/interpreter.h"
#include "report/path_picture.h"

namespace camber::report {
namespace {

nc::Interpretation moves_of(const std::string& text) {
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(SourceText("p.nc", text), diagnostics);
  return nc::interpret(program, {}, diagnostics);
}

const std::string kHead = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 F500\n";

TEST(PathPicture, TellsRapidsLinesAndArcsAndWhatWasRewritten) {
  const auto moves = moves_of(kHead + "X10.\nG3 X20. Y10. I0. J10.\nG1 X0.\nG0 Z5.\nM30\n");
  const PathPicture p = path_picture(moves, {{3, 4}}, 1000);
  EXPECT_FALSE(p.thinned);
  ASSERT_GT(p.points.size(), 10u);
  EXPECT_EQ(p.kind.front(), PathKind::start);
  EXPECT_EQ(p.kind.back(), PathKind::rapid);
  EXPECT_EQ(p.kind[p.kind.size() - 2], PathKind::kept_line);
  EXPECT_EQ(p.kind[1], PathKind::line);
  EXPECT_EQ(std::count(p.ends.begin(), p.ends.end(), 1), 5);
  int arcs = 0;
  for (std::size_t k = 0; k < p.points.size(); ++k)
    if (p.kind[k] == PathKind::arc) {
      ++arcs;
      EXPECT_NEAR((p.points[k] - Vec3(10, 10, 0)).norm(), 10, 1e-9);
      EXPECT_EQ(p.block[k], 4u);
    }
  EXPECT_GT(arcs, 20);
}

TEST(PathPicture, ThinningKeepsCornersAndExtremes) {
  std::string text = kHead;
  for (int row = 0; row < 100; ++row)
    for (int i = 0; i <= 400; ++i) {
      const int k = row % 2 ? 400 - i : i;
      // A peak of one point in one row; everything else is straight.
      text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", 0.25 * k, 1.0 * row, row == 42 && k == 137 ? 3.0 : 0.0);
    }
  const auto moves = moves_of(text + "M30\n");
  const PathPicture p = path_picture(moves, {}, 5000);
  EXPECT_TRUE(p.thinned);
  EXPECT_LE(p.points.size(), 5000u);
  const auto has = [&](const Vec3& place) {
    return std::any_of(p.points.begin(), p.points.end(),
                       [&](const Vec3& q) { return (p.chord_mm + 1e-9) > (q - place).norm(); });
  };
  EXPECT_TRUE(has(Vec3(0.25 * 137, 42, 3)));
  for (int row = 0; row < 100; ++row) {
    EXPECT_TRUE(has(Vec3(0, row, 0)));
    EXPECT_TRUE(has(Vec3(100, row, 0)));
  }
  // No point of the path is farther from the picture than it says.
  for (const nc::Move& m : moves.moves) {
    double nearest = 1e9;
    for (std::size_t k = 1; k < p.points.size(); ++k) {
      const Vec3 ab = p.points[k] - p.points[k - 1];
      const double t = std::clamp((m.end_mm - p.points[k - 1]).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (m.end_mm - p.points[k - 1] - t * ab).norm());
    }
    ASSERT_LE(nearest, p.chord_mm + 1e-9);
  }
}

}  // namespace
}  // namespace camber::report
