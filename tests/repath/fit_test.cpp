// Polylines to lines and arcs: the traps, against densely sampled paths and against every chain that there is.
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "repath/compress/fit.h"
#include "repath/compress/tangent.h"

namespace camber::repath {
namespace {

using Points = std::vector<Vec2>;

Vec2 rounded(const Vec2& p, double increment = 0.001) {
  return Vec2(std::round(p.x() / increment) * increment, std::round(p.y() / increment) * increment);
}

/// n + 1 points of a circle about the origin.
Points circle(double radius, double from_rad, double sweep_rad, int n, bool round = true) {
  Points out;
  for (int i = 0; i <= n; ++i) {
    const double a = from_rad + sweep_rad * i / n;
    const Vec2 p(radius * std::cos(a), radius * std::sin(a));
    out.push_back(round ? rounded(p) : p);
  }
  if (std::abs(std::abs(sweep_rad) - 2 * kPi) < 1e-12) out.back() = out.front();
  return out;
}

/// Points of the chain as a control runs it: the radius goes evenly from the one at the start to the one at the end.
Points sampled(const Points& points, const std::vector<Primitive>& chain, double step) {
  Points out;
  for (const Primitive& p : chain) {
    const Vec2 a = points[p.first], b = points[p.last], c = a + p.center_from_start_mm;
    const double r0 = (a - c).norm(), r1 = (b - c).norm(), angle = std::atan2(a.y() - c.y(), a.x() - c.x());
    const double length = p.arc ? std::abs(p.sweep_rad) * r0 : (b - a).norm();
    // Also so many that a chord leaves its arc by no more than this.
    constexpr double kSagitta = 1e-6;
    const double chords = p.arc ? std::abs(p.sweep_rad) * std::sqrt(r0 / (8 * kSagitta)) : 0;
    const int n = std::max(2, static_cast<int>(std::ceil(std::max(length / step, chords))));
    for (int i = 0; i <= n; ++i) {
      const double u = static_cast<double>(i) / n, r = r0 + u * (r1 - r0), f = angle + u * p.sweep_rad;
      out.push_back(p.arc ? Vec2(c + r * Vec2(std::cos(f), std::sin(f))) : Vec2(a + u * (b - a)));
    }
  }
  return out;
}

double distance_to_polyline(const Vec2& p, const Points& line) {
  double nearest = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec2 d = line[i + 1] - line[i];
    const double u = d.squaredNorm() > 0 ? std::clamp((p - line[i]).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    nearest = std::min(nearest, (p - line[i] - u * d).norm());
  }
  return nearest;
}

/// Both ways, each path as points against the other as a polyline.
double hausdorff(const Points& points, const std::vector<Primitive>& chain, double step = 0.01) {
  const Points fitted = sampled(points, chain, step);
  Points dense;
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (int k = 0; k <= 8; ++k) dense.push_back(points[i] + k / 8.0 * (points[i + 1] - points[i]));
  double worst = 0;
  for (const Vec2& p : fitted) worst = std::max(worst, distance_to_polyline(p, points));
  for (const Vec2& p : dense) worst = std::max(worst, distance_to_polyline(p, fitted));
  return worst;
}

/// What must hold for every chain.
void expect_sound(const Points& points, const std::vector<Primitive>& chain, const FitOptions& options) {
  ASSERT_FALSE(chain.empty());
  EXPECT_EQ(chain.front().first, 0u);
  EXPECT_EQ(chain.back().last, points.size() - 1);
  for (std::size_t k = 0; k < chain.size(); ++k) {
    const Primitive& p = chain[k];
    EXPECT_EQ(p.first, k > 0 ? chain[k - 1].last : 0u);
    if (!p.arc) continue;
    EXPECT_GE(p.last - p.first + 1, options.arc_points);
    const Vec2 c = points[p.first] + p.center_from_start_mm;
    EXPECT_LE(std::abs((points[p.first] - c).norm() - (points[p.last] - c).norm()), options.radius_agreement_mm);
    EXPECT_LE(p.center_from_start_mm.norm(), options.max_radius_mm);
    const Vec2 steps = p.center_from_start_mm / options.increment_mm;
    EXPECT_LT((steps - rounded(steps, 1)).norm(), 1e-5) << "a centre that the words cannot say";
  }
  EXPECT_LE(hausdorff(points, chain), options.tolerance_mm + 1e-5);  // the samples are chords of their own
}

TEST(Fit, PointsOnACircleAreOneArc) {
  for (const double sweep : {0.5, -0.5, 2.0, -3.1, 3.5, -5.0, 6.0, 2 * kPi, -2 * kPi}) {
    SCOPED_TRACE(sweep);
    const Points points = circle(20, 0.3, sweep, 150);
    const auto chain = fit(points, {});
    expect_sound(points, chain, {});
    ASSERT_EQ(chain.size(), 1u);
    EXPECT_TRUE(chain[0].arc);
    EXPECT_NEAR(chain[0].sweep_rad, sweep, 1e-3);
    EXPECT_NEAR((points[0] + chain[0].center_from_start_mm).norm(), 0, 0.01);
  }
}

TEST(Fit, SmallCirclesAreArcs) {
  for (const double radius : {0.03, 0.05, 0.1, 0.3}) {
    SCOPED_TRACE(radius);
    const Points points = circle(radius, 0.3, 4.5, 24);
    const auto chain = fit(points, {});
    expect_sound(points, chain, {});
    EXPECT_EQ(chain.size(), 1u);
  }
  const Points dot = circle(0.015, 0.3, 4.5, 12);
  expect_sound(dot, fit(dot, {}), {});
}

TEST(Fit, AHugeRadiusIsALine) {
  const Points points = circle(1e5, 0, 1e-4, 50);
  const auto chain = fit(points, {});
  ASSERT_EQ(chain.size(), 1u);
  EXPECT_FALSE(chain[0].arc);
  FitOptions narrow;
  narrow.max_radius_mm = 50;
  for (const Primitive& p : fit(circle(100, 0, 1, 50), narrow)) EXPECT_FALSE(p.arc);
}

TEST(Fit, LessThanFivePointsAreNoArc) {
  const FitOptions wide{.tolerance_mm = 0.1};
  const auto chain = fit(circle(5, 0, 0.9, 3), wide);
  for (const Primitive& p : chain) EXPECT_FALSE(p.arc);
  EXPECT_TRUE(fit(circle(5, 0, 0.9, 4), wide).front().arc);
}

TEST(Fit, TheDistanceHoldsBetweenThePointsToo) {
  // A square's corners lie on a circle exactly; its sides do not.
  Points points = circle(10, 0, 2 * kPi, 8);
  for (const Primitive& p : fit(points, {})) EXPECT_FALSE(p.arc);
}

TEST(Fit, CornersStaySharp) {
  Points points;
  for (int i = 0; i <= 50; ++i) points.push_back(rounded(Vec2(0.01 * i, 0)));
  for (int i = 1; i <= 50; ++i) points.push_back(rounded(Vec2(0.5, 0.01 * i)));
  const auto chain = fit(points, {});
  ASSERT_EQ(chain.size(), 2u);
  EXPECT_EQ(chain[0].last, 50u);
  // Two arcs that meet in an edge of 60 degrees: a character line.
  Points arcs = circle(10, 0, kPi / 3, 40);
  for (const Vec2& p : circle(10, -kPi / 3, kPi / 3, 40)) {
    const Vec2 moved = rounded(p + arcs[40] - 10 * Vec2(std::cos(-kPi / 3), std::sin(-kPi / 3)));
    if ((moved - arcs.back()).norm() > 0.01) arcs.push_back(moved);
  }
  const auto two = fit(arcs, {});
  expect_sound(arcs, two, {});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].last, 40u);
}

TEST(Fit, ReversalsStay) {
  Points points;
  for (int i = 0; i <= 10; ++i) points.emplace_back(i, 0);
  for (int i = 9; i >= 3; --i) points.emplace_back(i, 0);
  for (int i = 4; i <= 10; ++i) points.emplace_back(i, 0);
  const auto chain = fit(points, {});
  ASSERT_EQ(chain.size(), 3u);
  EXPECT_EQ(chain[0].last, 10u);
  EXPECT_EQ(chain[1].last, 17u);
  Points back = circle(10, 0, 1, 50);
  const Points again = circle(10, 1, -1, 50);
  back.insert(back.end(), again.begin() + 1, again.end());
  const auto there_and_back = fit(back, {});
  ASSERT_EQ(there_and_back.size(), 2u);
  EXPECT_EQ(there_and_back[0].last, 50u);
}

TEST(Fit, ZigZagNoiseStaysLines) {
  Points points;
  for (int i = 0; i <= 200; ++i) points.emplace_back(0.1 * i, i % 2 ? 0.004 : -0.004);
  const auto one = fit(points, {});
  expect_sound(points, one, {});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_FALSE(one[0].arc);
  for (Vec2& p : points) p.y() *= 10;  // beyond the tolerance: nothing can be left out
  const auto all = fit(points, {});
  EXPECT_EQ(all.size(), 200u);
  for (const Primitive& p : all) EXPECT_FALSE(p.arc);
}

TEST(Fit, NothingDriftsOverManyArcs) {
  Points points;
  for (int i = 0; i <= 20000; ++i) points.push_back(rounded(Vec2(0.05 * i, 3 * std::sin(0.05 * i / 4))));
  const auto chain = fit(points, {});
  EXPECT_LT(chain.size(), 1500u);
  for (const Primitive& p : chain) {
    const auto away = p.arc ? 0.0 : *line_deviation(points, p.first, p.last, 0.01);
    EXPECT_LE(std::max(away, p.deviation_mm), 0.01 + 1e-8);
  }
  EXPECT_EQ(chain.back().last, 20000u);
}

TEST(Fit, SmoothPathsHaveSmallKinks) {
  Points points;
  for (int i = 0; i <= 700; ++i) points.push_back(rounded(Vec2(0.05 * i, 3 * std::sin(0.05 * i / 4))));
  FitOptions as_fitted;
  as_fitted.tangent = false;
  const auto rms = [&](const std::vector<Primitive>& chain) {
    double sum = 0;
    const auto kinks = kinks_of(Polyline{points}, chain);
    for (const double k : kinks) sum += k * k;
    return std::sqrt(sum / static_cast<double>(kinks.size()));
  };
  const auto tangent = fit(points, {}), plain = fit(points, as_fitted);
  expect_sound(points, tangent, {});
  EXPECT_EQ(tangent.size(), plain.size());
  EXPECT_LE(rms(tangent), rms(plain));
  EXPECT_LT(rms(tangent), 0.03);  // 1.7 degrees
}

TEST(Fit, MoreToleranceNeverTakesMoreBlocksOnASmoothCurve) {
  Points points;
  for (int i = 0; i <= 700; ++i) points.push_back(rounded(Vec2(0.05 * i, 3 * std::sin(0.05 * i / 4))));
  std::size_t before = points.size();
  for (const double tolerance : {0.002, 0.005, 0.01, 0.02, 0.05}) {
    const FitOptions options{.tolerance_mm = tolerance};
    const auto chain = fit(points, options);
    expect_sound(points, chain, options);
    EXPECT_LE(chain.size(), before);
    before = chain.size();
  }
}

/// A path of lines, arcs, corners, noise and turning back.
Points random_path(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  Points points{Vec2::Zero()};
  Vec2 at = Vec2::Zero();
  double heading = 6 * u(random);
  const int pieces = 1 + static_cast<int>(random() % 4);
  for (int piece = 0; piece < pieces; ++piece) {
    if (random() % 3 == 0) heading += 3 * (u(random) - 0.5);
    const double curvature = random() % 3 == 0 ? 0 : (random() % 2 ? 1 : -1) / std::exp(std::log(0.1) + 6 * u(random));
    const double step = 0.02 + 0.5 * u(random) * u(random), noise = random() % 4 == 0 ? 0.008 : 0;
    const int n = 2 + static_cast<int>(random() % 12);
    for (int i = 0; i < n; ++i) {
      heading += step * curvature;
      at += step * Vec2(std::cos(heading), std::sin(heading));
      const Vec2 p = rounded(at + noise * Vec2(u(random) - 0.5, u(random) - 0.5));
      if (p != points.back()) points.push_back(p);
    }
  }
  if (points.size() < 2) points.emplace_back(1, 0);
  return points;
}

TEST(Fit, RandomPathsStayWithinTheTolerance) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    const Points points = random_path(random);
    const FitOptions options{.tolerance_mm = std::array{0.003, 0.01, 0.05}[random() % 3]};
    expect_sound(points, fit(points, options), options);
    RC_ASSERT(!testing::Test::HasFailure());
  }));
}

/// Against every chain whose ends are points of the path.
TEST(Fit, RandomPathsTakeTheFewestPrimitivesButForOneInAHundred) {
  std::mt19937 random(5);
  int worse = 0, more = 0, primitives = 0;
  constexpr int kPaths = 600;
  for (int i = 0; i < kPaths; ++i) {
    const Points points = random_path(random);
    const FitOptions options{.tolerance_mm = 0.01, .max_kink_rad = kPi};
    const auto found = fit(points, options).size(), fewest = fit_exhaustively(points, options).size();
    EXPECT_GE(found, fewest);
    worse += found > fewest;
    more += static_cast<int>(found - fewest);
    primitives += static_cast<int>(fewest);
  }
  std::cout << worse << " of " << kPaths << " paths take " << more << " primitives more than the fewest, " << primitives
            << "\n";
  EXPECT_LE(worse, kPaths / 100);
}

/// A gentle curve with straight blocks where it bends the other way: lines that arcs could take the place of.
TEST(Fit, NoLineIsLongerThanItMustBeAndStraightSidesStay) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(0, 1);
  double found_mm = 0, min_mm = 0, plain_mm = 0;
  const auto lines_mm = [](const Points& points, const std::vector<Primitive>& chain) {
    double sum = 0;
    for (const Primitive& p : chain) sum += p.arc ? 0 : (points[p.last] - points[p.first]).norm();
    return sum;
  };
  FitOptions options;
  options.tangent = false;
  options.max_kink_rad = kPi;
  for (int i = 0; i < 100; ++i) {
    Points points;
    const double a = 10 + 20 * u(random), b = 5 + 5 * u(random), phase = 6 * u(random);
    for (double x = 0; x < 60;) {
      points.push_back(rounded(Vec2(x, 3 * std::sin(x / a) + 0.5 * std::sin(x / b + phase))));
      const double bend = std::abs(3 / (a * a) * std::sin(x / a) + 0.5 / (b * b) * std::sin(x / b + phase));
      x += std::min(4.0, std::sqrt(8 * 0.005 / bend));  // chords of 0.005 mm
    }
    const auto chain = fit(points, options);
    const auto best = fit_exhaustively(points, options);
    EXPECT_EQ(chain.size(), best.size());
    found_mm += lines_mm(points, chain);
    min_mm += lines_mm(points, best);
    plain_mm += 60;
  }
  std::cout << fmt::format("lines: {:.0f} of {:.0f} mm, {:.0f} at least\n", found_mm, plain_mm, min_mm);
  EXPECT_LT(found_mm, 1.05 * min_mm);
  // A rounded rectangle: arcs do not eat what is straight, even where they could within the tolerance.
  for (const int blocks : {1, 10})
    for (const bool line_first : {false, true}) {
      Points sides = circle(5, 0, kPi / 2, 40);
      for (int k = 1; k <= blocks; ++k) sides.emplace_back(-1.5 * k, 5);
      if (line_first) std::reverse(sides.begin(), sides.end());
      const auto chain = fit(sides, {});
      ASSERT_EQ(chain.size(), 2u);
      EXPECT_NE(chain[0].arc, line_first);
      EXPECT_EQ(chain[0].last, line_first ? static_cast<std::uint32_t>(blocks) : 40u);
      EXPECT_EQ(chain[1].arc, line_first);
    }
}

}  // namespace
}  // namespace camber::repath
