// For controls that run arcs faster than lines: more blocks where they take lines away.
#include <random>

#include <gtest/gtest.h>

#include "repath/compress/compression.h"
#include "tests/nc/rs274_oracle.h"
#include "tests/support/path_distance.h"
#include "tests/support/path_kinks.h"

namespace camber::repath {
namespace {

using Points = std::vector<Vec2>;

Vec2 rounded(const Vec2& p) { return {std::round(p.x() * 1000) / 1000, std::round(p.y() * 1000) / 1000}; }

double lines_mm(const Points& points, const std::vector<Primitive>& chain) {
  double sum = 0;
  for (const Primitive& p : chain) sum += p.arc ? 0 : (points[p.last] - points[p.first]).norm();
  return sum;
}

/// Gentle curves as CAM cuts them, chords of 0.005 mm; long blocks where they bend the other way.
Points gentle_curve(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  Points points;
  const double a = 10 + 20 * u(random), b = 5 + 5 * u(random), phase = 6 * u(random);
  for (double x = 0; x < 60;) {
    points.push_back(rounded(Vec2(x, 3 * std::sin(x / a) + 0.5 * std::sin(x / b + phase))));
    const double bend = std::abs(3 / (a * a) * std::sin(x / a) + 0.5 / (b * b) * std::sin(x / b + phase));
    x += std::min(2.5, std::sqrt(8 * 0.005 / bend));
  }
  return points;
}

TEST(SpareLines, ComesNearTheLeastSumOfBlocksAndLines) {
  std::mt19937 random(3);
  FitOptions fewest;
  fewest.tangent = false;
  fewest.max_kink_rad = kPi;
  FitOptions spare = fewest;
  spare.primitives_per_line_mm = 2;
  double fewest_mm = 0, spared_mm = 0, spared_sum = 0, min_sum = 0;
  std::size_t fewest_blocks = 0, spared_blocks = 0;
  for (int i = 0; i < 60; ++i) {
    const Points points = gentle_curve(random);
    const auto few = fit(points, fewest), spared = fit(points, spare), best = fit_exhaustively(points, spare);
    const auto sum = [&](const std::vector<Primitive>& chain) {
      return static_cast<double>(chain.size()) + spare.primitives_per_line_mm * lines_mm(points, chain);
    };
    EXPECT_LE(sum(best), sum(spared) + 1e-6);
    EXPECT_LE(sum(spared), sum(few) + 1e-6);
    fewest_mm += lines_mm(points, few), spared_mm += lines_mm(points, spared);
    fewest_blocks += few.size(), spared_blocks += spared.size();
    spared_sum += sum(spared), min_sum += sum(best);
  }
  std::cout << fmt::format("lines {:.0f} mm in {} blocks, spared {:.0f} mm in {}; sum {:.0f}, least {:.0f}\n",
                           fewest_mm, fewest_blocks, spared_mm, spared_blocks, spared_sum, min_sum);
  EXPECT_LT(spared_mm, 0.92 * fewest_mm);
  EXPECT_LT(spared_sum, 1.03 * min_sum);
}

TEST(SpareLines, ABowOfManyPointsThatALineCouldBeBecomesArcs) {
  // An S that is one line within the tolerance.
  Points points;
  for (int i = 0; i <= 600; ++i) points.push_back(rounded(Vec2(0.05 * i, 0.024 * std::pow((0.05 * i - 15) / 15, 3))));
  FitOptions options;
  const double before = lines_mm(points, fit(points, options));
  EXPECT_GT(before, 29);
  options.primitives_per_line_mm = 5;
  const auto chain = fit(points, options);
  EXPECT_LT(lines_mm(points, chain), 0.35 * before);
}

TEST(SpareLines, WhatIsStraightStaysALine) {
  FitOptions options;
  options.primitives_per_line_mm = 1e4;
  // Rounded to increments; noise within the tolerance, where five points that lie like an arc are found somewhere.
  for (const double noise_mm : {0.0, 0.002, 0.004}) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(-noise_mm, noise_mm);
    Points row;
    for (int i = 0; i <= 200; ++i) row.push_back(rounded(Vec2(0.9 * i, 0.31 * i + u(random))));
    for (int i = 1; i <= 60; ++i) {  // and a bow behind it
      const double a = 0.02 * i, heading = std::atan2(0.31, 0.9);
      const Vec2 along(std::cos(heading), std::sin(heading)), across(-along.y(), along.x());
      row.push_back(rounded(Vec2(180, 62) + 20 * std::sin(a) * along + 20 * (1 - std::cos(a)) * across));
    }
    const auto chain = fit(row, options);
    EXPECT_FALSE(chain[0].arc) << noise_mm;
    EXPECT_GE(chain[0].last, 195u) << noise_mm;
    EXPECT_LE(chain.size(), 4u) << noise_mm;
  }
  // Sides of several blocks and the rounds between them.
  Points sides;
  for (int k = 0; k <= 40; ++k) sides.emplace_back(5 * std::cos(kPi / 80 * k), 5 * std::sin(kPi / 80 * k));
  for (int k = 1; k <= 10; ++k) sides.emplace_back(-0.3 * k, 5);
  const auto chain = fit(sides, options);
  ASSERT_EQ(chain.size(), 2u);
  EXPECT_TRUE(chain[0].arc);
  EXPECT_EQ(chain[0].last, 40u);
}

TEST(SpareLines, ToleranceAndKinksHoldAsWithoutIt) {
  std::mt19937 random(9);
  for (int i = 0; i < 12; ++i) {
    std::string text = "G21 G90 G94 G17\nG0 X0. Y0. Z0.\nG1 F600.\n";
    for (const Vec2& p : gentle_curve(random)) text += fmt::format("X{:.3f} Y{:.3f}\n", p.x(), p.y());
    text += "M2\n";
    const nc::Read before = nc::read_clean(text);
    CompressOptions options;
    const Compression fewest = compress(before.program, before.moves, options);
    options.feeds = FeedsByKind{4.5, 1000.0 / 60};
    const Compression spared = compress(before.program, before.moves, options);
    const nc::Read after = nc::read_clean(spared.text);
    EXPECT_LE(tests::hausdorff_mm(before.moves, after.moves, 0.002), 0.0101);
    EXPECT_LE(cutting_time_s(after.moves, *options.feeds),
              cutting_time_s(nc::read_clean(fewest.text).moves, *options.feeds) + 1e-6);
    EXPECT_LE(spared.max_kink_rad, std::max(options.fit.max_kink_rad, fewest.max_kink_rad) + 1e-6);
  }
}

TEST(SpareLines, TimeOfCutsIsThatOfTheirLengths) {
  const nc::Read r = nc::read_clean("G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X30. F100.\nG3 X30. Y20. J10.\nG0 X0.\nM2\n");
  EXPECT_NEAR(cutting_time_s(r.moves, {.line_mm_per_s = 5, .arc_mm_per_s = 20, .block_s = 0.1}),
              30 / 5.0 + kPi * 10 / 20 + 0.2, 1e-9);
}

}  // namespace
}  // namespace camber::repath
