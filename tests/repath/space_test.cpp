// Runs in space: lines, helices, and the same traps as in a plane.
#include <rapidcheck.h>

#include <random>

#include <gtest/gtest.h>

#include "repath/compress/compression.h"
#include "repath/compress/tangent.h"
#include "tests/nc/rs274_oracle.h"
#include "tests/support/path_distance.h"

namespace camber::repath {
namespace {

using nc::Read;

struct Points {
  std::vector<Vec2> flat;
  std::vector<double> heights;
  Polyline line() const { return {flat, heights}; }
  void add(double x, double y, double z, double increment = 0.001) {
    const auto round = [&](double v) { return increment > 0 ? std::round(v / increment) * increment : v; };
    flat.emplace_back(round(x), round(y));
    heights.push_back(round(z));
  }
};

/// `climb`: of the whole sweep; `bend`: how unevenly.
Points helix(double radius, double sweep, double climb, int n, double bend = 0) {
  Points out;
  for (int i = 0; i <= n; ++i) {
    const double u = static_cast<double>(i) / n, a = 0.3 + sweep * u;
    out.add(radius * std::cos(a), radius * std::sin(a), climb * (u + bend * u * (1 - u)));
  }
  return out;
}

/// As a control runs the primitive: the third axis evenly with the angle.
Vec3 point_of(const Points& points, const Primitive& p, double u) {
  const Vec2 a = points.flat[p.first], b = points.flat[p.last], c = a + p.center_from_start_mm;
  const double z = points.heights[p.first] + u * (points.heights[p.last] - points.heights[p.first]);
  const double r = (a - c).norm() + u * ((b - c).norm() - (a - c).norm());
  const double f = std::atan2(a.y() - c.y(), a.x() - c.x()) + u * p.sweep_rad;
  const Vec2 flat = p.arc ? Vec2(c + r * Vec2(std::cos(f), std::sin(f))) : Vec2(a + u * (b - a));
  return {flat.x(), flat.y(), z};
}

double to_polyline(const Vec3& p, const std::vector<Vec3>& line) {
  double nearest = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3 d = line[i + 1] - line[i];
    const double u = d.squaredNorm() > 0 ? std::clamp((p - line[i]).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    nearest = std::min(nearest, (p - line[i] - u * d).norm());
  }
  return nearest;
}

/// Ends join, arcs keep to their rules, and points laid on both paths are within the tolerance of the other.
void expect_sound(const Points& points, const std::vector<Primitive>& chain, const FitOptions& options) {
  ASSERT_FALSE(chain.empty());
  EXPECT_EQ(chain.front().first, 0u);
  EXPECT_EQ(chain.back().last, points.flat.size() - 1);
  std::vector<Vec3> old_line, new_line;
  for (std::size_t k = 0; k < points.flat.size(); ++k) old_line.push_back(points.line().at(k));
  for (std::size_t k = 0; k < chain.size(); ++k) {
    const Primitive& p = chain[k];
    EXPECT_EQ(p.first, k > 0 ? chain[k - 1].last : 0u);
    if (p.arc) {
      EXPECT_GE(p.last - p.first + 1, options.arc_points);
      const Vec2 c = points.flat[p.first] + p.center_from_start_mm;
      EXPECT_LE(std::abs((points.flat[p.first] - c).norm() - (points.flat[p.last] - c).norm()),
                options.radius_agreement_mm);
      EXPECT_TRUE(options.helices || points.heights[p.first] == points.heights[p.last]);
    }
    for (int i = 0; i <= 400; ++i) new_line.push_back(point_of(points, p, i / 400.0));
  }
  double worst = 0;
  for (const Vec3& p : new_line) worst = std::max(worst, to_polyline(p, old_line));
  for (std::size_t k = 0; k + 1 < old_line.size(); ++k)
    for (int i = 0; i <= 4; ++i)
      worst = std::max(worst, to_polyline(old_line[k] + i / 4.0 * (old_line[k + 1] - old_line[k]), new_line));
  EXPECT_LE(worst, options.tolerance_mm + 2e-5);  // the samples are chords of their own
}

constexpr FitOptions kHelices{.helices = true};

TEST(FitInSpace, PointsOnALineAreOneLine) {
  Points points;
  for (int i = 0; i <= 300; ++i) points.add(0.13 * i, -0.07 * i, 0.05 * i);
  const auto chain = fit(points.line(), {});
  expect_sound(points, chain, {});
  EXPECT_EQ(chain.size(), 1u);
}

TEST(FitInSpace, AHeightOfItsOwnIsNotLeftOut) {
  Points points;  // straight from above
  for (int i = 0; i <= 300; ++i) points.add(0.1 * i, 0, 2 * std::sin(0.02 * i));
  const auto chain = fit(points.line(), {});
  expect_sound(points, chain, {});
  EXPECT_GT(chain.size(), 10u);
  EXPECT_LT(chain.size(), 60u);
}

TEST(FitInSpace, PointsOnAHelixAreOneArc) {
  for (const double sweep : {0.5, -0.5, 2.0, -3.1, 3.5, -5.0, 6.0})
    for (const double climb : {0.4, -3.0, 20.0}) {
      SCOPED_TRACE(fmt::format("{} rad, {} mm", sweep, climb));
      const Points points = helix(20, sweep, climb, 150);
      const auto chain = fit(points.line(), kHelices);
      expect_sound(points, chain, kHelices);
      ASSERT_EQ(chain.size(), 1u);
      EXPECT_TRUE(chain[0].arc);
      EXPECT_NEAR(chain[0].sweep_rad, sweep, 1e-3);
      for (const Primitive& p : fit(points.line(), {})) EXPECT_FALSE(p.arc);  // not asked for
    }
}

TEST(FitInSpace, SmallHelicesAreArcs) {
  for (const double radius : {0.05, 0.1, 0.3}) {
    const Points points = helix(radius, 4.5, 0.05, 24);
    const auto chain = fit(points.line(), kHelices);
    expect_sound(points, chain, kHelices);
    EXPECT_EQ(chain.size(), 1u);
  }
}

TEST(FitInSpace, ManyTurnsAreAnArcEachOrFewer) {
  const Points points = helix(5, 20 * kPi, 8, 1500);  // points do not repeat from turn to turn
  const auto chain = fit(points.line(), kHelices);
  expect_sound(points, chain, kHelices);
  EXPECT_LE(chain.size(), 12u);
  EXPECT_GE(chain.size(), 10u);
}

TEST(FitInSpace, APitchThatChangesIsNoOneHelix) {
  const Points points = helix(10, 3, 4, 200, 0.3);
  const auto chain = fit(points.line(), kHelices);
  expect_sound(points, chain, kHelices);
  EXPECT_GT(chain.size(), 3u);
}

TEST(FitInSpace, HeightAndAngleAreComparedBetweenThePointsToo) {
  // Chords of half a radian, 10 mm a radian: 0.031 mm from the circle, and between the points the height runs ahead of
  // the angle by 0.002 rad or 0.02 mm.
  const Points points = helix(1, 4, 40, 8);
  const FitOptions coarse{.tolerance_mm = 0.05, .helices = true}, fine{.tolerance_mm = 0.034, .helices = true};
  const auto chain = fit(points.line(), coarse);
  expect_sound(points, chain, coarse);
  EXPECT_TRUE(chain.front().arc);
  for (const Primitive& p : fit(points.line(), fine)) EXPECT_FALSE(p.arc);
}

TEST(FitInSpace, AnEdgeInTheHeightStaysSharp) {
  Points points;  // an arc seen from above, with a ridge half way
  for (int i = 0; i <= 100; ++i) {
    const double a = 0.02 * i;
    points.add(20 * std::cos(a), 20 * std::sin(a), i <= 50 ? 0.3 * i : 0.3 * (100 - i));
  }
  const auto chain = fit(points.line(), kHelices);
  expect_sound(points, chain, kHelices);
  ASSERT_EQ(chain.size(), 2u);
  EXPECT_EQ(chain[0].last, 50u);
}

TEST(FitInSpace, PlungesAndReversalsStay) {
  Points points;
  for (int i = 0; i <= 10; ++i) points.add(0.1 * i, 0, 0);
  for (int i = 1; i <= 10; ++i) points.add(1, 0, -0.1 * i);  // straight down
  for (int i = 1; i <= 10; ++i) points.add(1, 0, -1 + 0.1 * i);
  for (int i = 1; i <= 10; ++i) points.add(1 + 0.1 * i, 0, 0.05 * i);
  const auto chain = fit(points.line(), kHelices);
  expect_sound(points, chain, kHelices);
  ASSERT_EQ(chain.size(), 4u);
  EXPECT_EQ(chain[0].last, 10u);
  EXPECT_EQ(chain[1].last, 20u);
  EXPECT_EQ(chain[2].last, 30u);
}

TEST(FitInSpace, ZigZagNoiseStaysLines) {
  Points points;
  for (int i = 0; i <= 200; ++i) points.add(0.1 * i, 0.03 * i, i % 2 ? 0.004 : -0.004);
  const auto one = fit(points.line(), kHelices);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_FALSE(one[0].arc);
  for (double& z : points.heights) z *= 10;
  EXPECT_EQ(fit(points.line(), kHelices).size(), 200u);
}

TEST(FitInSpace, AWholeCircleHasNoKinkWithItsTangents) {
  for (const double turn : {1.0, -1.0}) {
    Points points;
    for (int i = 0; i < 50; ++i) points.add(0.1 * i - 5, 0, 0);
    for (int i = 0; i <= 200; ++i) {
      const double a = turn * (2 * kPi * i / 200 - kPi / 2);
      points.add(5 * std::cos(a), turn * 5 + 5 * std::sin(a), 0.01 * i);
    }
    for (int i = 1; i <= 50; ++i) points.add(0.1 * i, 0, 2);
    FitOptions options = kHelices;
    options.tangent = false;
    const auto chain = fit(points.line(), options);
    expect_sound(points, chain, options);
    EXPECT_LE(chain.size(), 4u);
    for (const double kink : kinks_of(points.line(), chain)) EXPECT_LT(kink, 0.15);  // the pitch is 2 / 31.4
  }
}

Points random_path(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  Points points;
  points.add(0, 0, 0);
  double x = 0, y = 0, z = 0, heading = 6 * u(random);
  const int pieces = 1 + static_cast<int>(random() % 4);
  for (int piece = 0; piece < pieces; ++piece) {
    if (random() % 3 == 0) heading += 3 * (u(random) - 0.5);
    const double curvature = random() % 3 == 0 ? 0 : (random() % 2 ? 1 : -1) / std::exp(std::log(0.1) + 6 * u(random));
    const double step = 0.02 + 0.5 * u(random) * u(random), noise = random() % 4 == 0 ? 0.008 : 0;
    const double slope = random() % 3 == 0 ? 0 : 2 * (u(random) - 0.5);
    const int n = 2 + static_cast<int>(random() % 12);
    for (int i = 0; i < n; ++i) {
      heading += step * curvature;
      x += step * std::cos(heading), y += step * std::sin(heading), z += slope * step;
      const auto shaken = [&](double v) { return v + noise * (u(random) - 0.5); };
      points.add(shaken(x), shaken(y), shaken(z));
      const std::size_t last = points.flat.size() - 1;
      if (points.line().at(last) == points.line().at(last - 1)) points.flat.pop_back(), points.heights.pop_back();
    }
  }
  if (points.flat.size() < 2) points.add(1, 0, 1);
  return points;
}

TEST(FitInSpace, RandomPathsStayWithinTheTolerance) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    const Points points = random_path(random);
    const FitOptions options{.tolerance_mm = std::array{0.003, 0.01, 0.05}[random() % 3], .helices = random() % 3 > 0};
    expect_sound(points, fit(points.line(), options), options);
    RC_ASSERT(!testing::Test::HasFailure());
  }));
}

TEST(FitInSpace, RandomPathsOfLinesAloneStayWithinTheTolerance) {
  for (std::uint32_t seed = 0; seed < 3000; ++seed) {
    std::mt19937 random(seed);
    const Points points = random_path(random);
    const FitOptions options{.tolerance_mm = std::array{0.003, 0.01, 0.05}[seed % 3]};
    expect_sound(points, fit(points.line(), options), options);
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

/// Against every chain whose ends are points of the path.
TEST(FitInSpace, RandomPathsTakeTheFewestPrimitivesButForOneInAHundred) {
  std::mt19937 random(9);
  int worse = 0, more = 0, primitives = 0;
  constexpr int kPaths = 400;
  for (int i = 0; i < kPaths; ++i) {
    const Points points = random_path(random);
    constexpr FitOptions kAnyKink{.helices = true, .max_kink_rad = kPi};
    const auto found = fit(points.line(), kAnyKink).size(), fewest = fit_exhaustively(points.line(), kAnyKink).size();
    EXPECT_GE(found, fewest);
    worse += found > fewest;
    more += static_cast<int>(found - fewest);
    primitives += static_cast<int>(fewest);
  }
  std::cout << worse << " of " << kPaths << " paths take " << more << " primitives more than the fewest, " << primitives
            << "\n";
  EXPECT_LE(worse, kPaths / 100);
}

std::string compressed(const std::string& text, const CompressOptions& options = {.helices = true}) {
  const Read r = nc::read_clean(text);
  return compress(r.program, r.moves, options).text;
}

double distance_mm(const std::string& before, const std::string& after, double step_mm = 0.01) {
  return tests::hausdorff_mm(nc::read_clean(before).moves, nc::read_clean(after).moves, step_mm);
}

const std::string kHead = "G21 G90 G17\nS1000 M3\nG0 X10. Y0. Z0.\nG1 F500\n";

/// Words of `n` points of a helix from the angle 0; `axes`: of the plane, and along the helix.
std::string helix_words(double r, double sweep, double climb, int n, const std::string& axes = "XYZ") {
  std::string out;
  for (int i = 1; i <= n; ++i)
    out += fmt::format("{}{:.3f} {}{:.3f} {}{:.3f}\n", axes[0], r * std::cos(sweep * i / n), axes[1],
                       r * std::sin(sweep * i / n), axes[2], climb * i / n);
  return out;
}

TEST(CompressInSpace, ARampIsOneArcThatAlsoMovesZ) {
  const std::string text = kHead + helix_words(10, 2.0, -3, 60) + "G0 Z5.\nM30\n";
  const std::string out = compressed(text);
  EXPECT_EQ(out, kHead + "G3 X-4.161 Y9.093 Z-3. I-10. J0.\nG0 Z5.\nM30\n");
  EXPECT_LE(distance_mm(text, out), 0.0101 + 0.0013);
  const std::string lines = compressed(text, {});
  EXPECT_EQ(lines.find("G3 "), std::string::npos);
  EXPECT_LE(distance_mm(text, lines), 0.0101 + 0.0013);
}

TEST(CompressInSpace, AWholeTurnSaysZAndCentre) {
  std::string words = helix_words(10, -2 * kPi, 2, 180);
  words = tests::replaced(words, "X10.000 Y0.000 Z2.000\n", "X10. Y-0. Z2.\n");
  EXPECT_EQ(compressed(kHead + words + "M30\n"), kHead + "G2 Z2. I-10. J0.\nM30\n");
}

TEST(CompressInSpace, OtherPlanesAndIncrementalPrograms) {
  const std::string zx = "G21 G90 G18\nG0 X10. Y0. Z0.\nG1 F500\n" + helix_words(10, 0.5, 1, 40, "XZY") + "M30\n";
  EXPECT_NE(compressed(zx).find("G2 X8.776 Y1. Z4.794 I-10. K0.\n"), std::string::npos) << compressed(zx);
  std::string g91 = "G21 G90 G17\nG0 X10. Y0. Z0.\nG91 G1 F500\n";
  double x = 10, y = 0;
  for (int i = 1; i <= 60; ++i) {
    const double nx = std::round(1e4 * std::cos(i / 30.0)) / 1e3, ny = std::round(1e4 * std::sin(i / 30.0)) / 1e3;
    g91 += fmt::format("X{:.3f} Y{:.3f} Z-0.010\n", nx - x, ny - y);
    x = nx, y = ny;
  }
  EXPECT_EQ(compressed(g91 + "M30\n"),
            "G21 G90 G17\nG0 X10. Y0. Z0.\nG91 G1 F500\nG3 X-14.161 Y9.093 Z-0.6 I-10. J0.\nM30\n");
}

TEST(CompressInSpace, FeedSpindleCommentAndCodesAreBoundaries) {
  for (const char* middle : {"F300\n", "S2000\n", "(note)\n", "M8\n", "\n"}) {
    SCOPED_TRACE(middle);
    const std::string first = helix_words(10, 0.5, 1, 20), second = "X20. Y5. Z2.\nX30. Y5. Z3.\nX40. Y5. Z4.\n";
    const std::string out = compressed(kHead + first + middle + second + "M30\n");
    EXPECT_TRUE(out.starts_with(kHead + "G3 X8.776 Y4.794 Z1. I-10. J0.\n")) << out;
    EXPECT_NE(out.find(middle), std::string::npos);
    EXPECT_TRUE(out.ends_with("X40. Z4.\nM30\n")) << out;
  }
}

TEST(CompressInSpace, RunsOfAnotherPlaneKeepTheirArcsBetweenRunsInSpace) {
  std::string text = kHead + "X10. Y0.5 Z-1.\nX10. Y1. Z-2.\nX10. Y1.5 Z-3.\nX10. Y0. Z0.\n";
  for (int i = 1; i <= 40; ++i)
    text += fmt::format("X{:.3f} Z{:.3f}\n", 10 * std::cos(i / 80.0), 10 * std::sin(i / 80.0));
  text += "X0. Y1. Z0.\nX-1. Y2. Z1.\nX-2. Y3. Z2.\nM30\n";
  CompressOptions options;
  options.switch_planes = true;
  const std::string out = compressed(text, options);
  EXPECT_EQ(out, kHead +
                     "Y1.5 Z-3.\nY0. Z0.\nG18 G2 X8.776 Z4.794 I-10. K0.\nG17 G1\nX0. Y1. Z0.\n"
                     "X-2. Y3. Z2.\nM30\n");
}

/// A random program in space, some of its pieces in a plane.
std::string random_program(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  const bool inch = random() % 4 == 0;
  const int plane = 17 + static_cast<int>(random() % 3);
  const char* axes = plane == 17 ? "XYZ" : plane == 18 ? "ZXY" : "YZX";
  std::string text = fmt::format("G{} G90 G94 G{}\nG0 X0. Y0. Z0.\nG1 F300.\n", inch ? 20 : 21, plane);
  double x = 0, y = 0, z = 0, heading = 6 * u(random);
  for (int piece = 0; piece < 6; ++piece) {
    if (random() % 3 == 0) heading += 3 * (u(random) - 0.5);
    const double curvature = random() % 3 == 0 ? 0 : (random() % 2 ? 1 : -1) / std::exp(std::log(0.2) + 6 * u(random));
    const double step = 0.05 + 0.3 * u(random), slope = random() % 3 == 0 ? 0 : u(random) - 0.5;
    for (int i = 0; i < 25; ++i) {
      heading += step * curvature;
      x += step * std::cos(heading), y += step * std::sin(heading), z += slope * step;
      const double unit = inch ? 25.4 : 1;
      text += fmt::format("{}{:.{}f} {}{:.{}f} {}{:.{}f}\n", axes[0], x / unit, inch ? 4 : 3, axes[1], y / unit,
                          inch ? 4 : 3, axes[2], z / unit, inch ? 4 : 3);
    }
    if (random() % 3 == 0) text += fmt::format("F{}.\n", 200 + piece);
  }
  return text + "M2\n";
}

TEST(CompressInSpace, RandomProgramsStayWithinTheToleranceBothWays) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    const std::string text = random_program(random);
    const std::string out = compressed(text);
    RC_ASSERT(out.size() <= text.size());
    RC_ASSERT(distance_mm(text, out) <= 0.0101 + 0.0013);  // samples 0.01 mm apart: sqrt(0.01^2 + 0.005^2) - 0.01
    const Read before = nc::read_clean(text), after = nc::read_clean(out);
    RC_ASSERT((before.moves.moves.back().end_mm - after.moves.moves.back().end_mm).norm() < 1e-9);
  }));
}

class CompressInSpaceRs274 : public nc::Rs274 {};

TEST_F(CompressInSpaceRs274, ReadsWhatComesOut) {
  if (!nc::rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) expect_same_moves(compressed(random_program(random)), nc::as("linuxcnc"), 0.00011);
  EXPECT_GT(arcs_, 20u);
}

}  // namespace
}  // namespace camber::repath
