// How much arcs kink against their neighbours: measured on the moves of the programs that come out.
#include <rapidcheck.h>

#include <random>

#include <gtest/gtest.h>

#include "base/units.h"
#include "repath/compress/compression.h"
#include "tests/nc/rs274_oracle.h"
#include "tests/support/path_distance.h"
#include "tests/support/path_kinks.h"

namespace camber::repath {
namespace {

using tests::kinks_between_moves;

constexpr double kAnyKink_deg = 180;
/// What ends whose radii differ by up to 0.002 mm change of a direction, and the differences taken.
constexpr double kMeasured_deg = 0.02;

std::string compressed(const std::string& text, double max_kink_deg, bool helices = false, double tolerance_mm = 0.01) {
  const nc::Read r = nc::read_clean(text);
  CompressOptions options{.tolerance_mm = tolerance_mm, .helices = helices};
  options.fit.max_kink_rad = rad_from_deg(max_kink_deg);
  return compress(r.program, r.moves, options).text;
}

/// The largest and the rms kink of a program, degrees, and its blocks.
struct Kinks {
  double max_deg = 0, rms_deg = 0;
  std::size_t blocks = 0;
};

Kinks kinks_of_text(const std::string& text) {
  const nc::Read r = nc::read_clean(text);
  Kinks out{.blocks = r.moves.moves.size()};
  const auto kinks = kinks_between_moves(r.moves);
  for (const auto& k : kinks) {
    out.max_deg = std::max(out.max_deg, deg_from_rad(k.rad));
    out.rms_deg += k.rad * k.rad;
  }
  out.rms_deg = deg_from_rad(std::sqrt(out.rms_deg / static_cast<double>(kinks.size())));
  return out;
}

constexpr char kHead[] = "G21 G90 G94 G17\nG0 X0. Y0. Z0.\nG1 F600.\n";

template <class Curve>
std::string program_of(int points, Curve curve) {
  std::string text = kHead;
  for (int i = 0; i <= points; ++i) {
    const Vec3 p = curve(i);
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", p.x(), p.y(), p.z());
  }
  return text + "M2\n";
}

Vec3 sine(int i) { return {0.05 * i, 3 * std::sin(0.05 * i / 4), 0}; }

TEST(Kinks, OfASmoothPathAreWithinTheBound) {
  const std::string text = program_of(1400, sine);
  const Kinks any = kinks_of_text(compressed(text, kAnyKink_deg));
  EXPECT_GT(any.max_deg, 2);  // or there is nothing to bound
  for (const double bound : {2.0, 1.0, 0.5, 0.2}) {
    SCOPED_TRACE(bound);
    const std::string out = compressed(text, bound);
    const Kinks kinks = kinks_of_text(out);
    EXPECT_LE(kinks.max_deg, bound + kMeasured_deg);
    EXPECT_LE(kinks.blocks, any.blocks * 1.15);
    EXPECT_LE(tests::hausdorff_mm(nc::read_clean(text).moves, nc::read_clean(out).moves, 0.002), 0.0101);
    EXPECT_NE(out.find("G3"), std::string::npos);
  }
}

TEST(Kinks, BetweenRunsAreWithinTheBoundWhereThePathIsSmooth) {
  // Where the feed changes, in a block of its own or in the next cut, or the spindle speed changes, or nothing does.
  for (const char* change : {"F300.\n", "S3000\n", " F300.", "(note)\n"}) {
    SCOPED_TRACE(change);
    const std::string what = change;
    std::string text = "S2000 M3\n" + std::string(kHead);
    int changes = 0;
    for (int i = 0; i <= 1400; ++i) {
      const Vec3 p = sine(i);
      const bool here = i % 97 == 50;
      changes += here;
      // every other time another value, or it were no change
      const std::string now =
          changes % 2 ? what : tests::replaced(tests::replaced(what, "300.", "500."), "3000", "2000");
      if (here && what.ends_with('\n')) text += now;
      text += fmt::format("X{:.3f} Y{:.3f}{}\n", p.x(), p.y(), here && !what.ends_with('\n') ? now : "");
    }
    text += "M2\n";
    const Kinks any = kinks_of_text(compressed(text, kAnyKink_deg));
    EXPECT_GT(any.max_deg, 2);
    for (const double bound : {1.0, 0.5}) {
      const std::string out = compressed(text, bound);
      EXPECT_LE(kinks_of_text(out).max_deg, bound + kMeasured_deg);
      EXPECT_LE(kinks_of_text(out).blocks, any.blocks * 1.3);
      EXPECT_LE(tests::hausdorff_mm(nc::read_clean(text).moves, nc::read_clean(out).moves, 0.002), 0.0101);
      std::size_t kept = 0;
      for (std::size_t at = 0; (at = out.find(what, at)) != std::string::npos; ++at) ++kept;
      EXPECT_GE(kept, 7u);
    }
  }
}

/// Of the joints beside an arc those that kink by more than the bound, or by the fraction of what the program turns
/// there that joints of arcs, and of arcs and lines, may have.
int too_sharp(const std::string& before, const std::string& after, double bound_deg, int& beside_arcs) {
  const nc::Read old = nc::read_clean(before), now = nc::read_clean(after);
  const auto turns = kinks_between_moves(old.moves);
  int out = 0;
  std::size_t at = 0;
  for (const auto& kink : kinks_between_moves(now.moves)) {
    while (turns.at(at).at_mm != kink.at_mm) ++at;  // throws where the end is no point of the program
    if (!kink.arc_before && !kink.arc_behind) continue;
    ++beside_arcs;
    const double fraction = kink.arc_before && kink.arc_behind ? 0.125 : 0.6;
    out += deg_from_rad(kink.rad) > std::max(bound_deg, fraction * deg_from_rad(turns[at].rad)) + kMeasured_deg;
  }
  return out;
}

TEST(Kinks, BesideSingleBlocksThatStayAreWithinTheBound) {
  // Two cuts that carry an S, one after the other: neither is a run.
  for (const bool in_space : {false, true}) {
    std::string text = kHead;
    for (int i = 0; i <= 700; ++i) {
      const Vec3 p = sine(2 * i);
      text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}{}\n", p.x(), p.y(), in_space ? 0.1 * p.x() : 0.0,
                          i % 47 == 20   ? " S2000"
                          : i % 47 == 21 ? " S3000"
                                         : "");
    }
    text += "M2\n";
    for (const double bound : {1.0, 0.5}) {
      SCOPED_TRACE(fmt::format("{} {}", bound, in_space));
      int beside_arcs = 0;
      const int unbounded = too_sharp(text, compressed(text, kAnyKink_deg, in_space), bound, beside_arcs);
      EXPECT_GT(unbounded, bound < 0.6 ? 4 : -1);
      beside_arcs = 0;
      const std::string out = compressed(text, bound, in_space);
      // Where slopes differ by more than half of the bound a joint may turn as the path does; runs begin and end at
      // every S.
      EXPECT_LE(too_sharp(text, out, bound, beside_arcs), in_space && bound < 0.6 ? 8 : 0);
      EXPECT_GT(beside_arcs, 25);
      EXPECT_LT(kinks_of_text(out).blocks, 170u);
      EXPECT_LE(tests::hausdorff_mm(nc::read_clean(text).moves, nc::read_clean(out).moves, 0.002), 0.0101);
      EXPECT_NE(out.find("S3000"), std::string::npos);
    }
  }
}

TEST(Kinks, BesideArcsOfTheProgramAreWithinTheBound) {
  std::string text = kHead;
  int arcs = 0;
  for (int i = 0; i <= 700; ++i) {
    const Vec2 from = sine(2 * i - 2).head<2>(), to = sine(2 * i + 8).head<2>();
    const double bow = std::abs(std::sin(0.05 * (2 * i + 3) / 4));
    if (i % 47 < 20 || bow < 0.5) {
      text += fmt::format("G1 X{:.3f} Y{:.3f}\n", sine(2 * i).x(), sine(2 * i).y());
      continue;
    }
    // Five steps as one arc of the program's own, through the middle.
    const Vec2 middle = sine(2 * i + 3).head<2>(), a = middle - from, b = to - from;
    const double twice = 2 * (a.x() * b.y() - a.y() * b.x());
    const Vec2 centre(std::round(1e3 * (b.y() * a.squaredNorm() - a.y() * b.squaredNorm()) / twice) / 1e3,
                      std::round(1e3 * (a.x() * b.squaredNorm() - b.x() * a.squaredNorm()) / twice) / 1e3);
    text += fmt::format("{} X{:.3f} Y{:.3f} I{:.3f} J{:.3f}\n", twice > 0 ? "G3" : "G2", to.x(), to.y(), centre.x(),
                        centre.y());
    i += 23;  // past it, and then lines for a while
    for (int k = i - 18; k <= i; ++k) text += fmt::format("G1 X{:.3f} Y{:.3f}\n", sine(2 * k).x(), sine(2 * k).y());
    ++arcs;
  }
  text += "M2\n";
  EXPECT_GT(arcs, 6);
  for (const double bound : {1.0, 0.6}) {
    SCOPED_TRACE(bound);
    int beside_arcs = 0;
    EXPECT_GT(too_sharp(text, compressed(text, kAnyKink_deg), bound, beside_arcs), 4);
    beside_arcs = 0;
    const std::string out = compressed(text, bound);
    // The program's own joints, of its arcs with lines that stay, are what they were.
    EXPECT_EQ(too_sharp(text, out, bound, beside_arcs), 0);
    EXPECT_GT(beside_arcs, 20);
    EXPECT_LT(kinks_of_text(out).blocks, 150u);
    EXPECT_LE(tests::hausdorff_mm(nc::read_clean(text).moves, nc::read_clean(out).moves, 0.002), 0.0101);
  }
}

TEST(Kinks, BlocksThatTurnAwayFromAnArcOfTheProgramStay) {
  // By 2 to 50 degrees, and back again: nothing can be tangent there, and what is drawn so is no fault.
  for (int turn_deg = 2; turn_deg <= 50; turn_deg += 4) {
    std::string text = kHead;
    text += "G3 X1. Y1. I0. J1.\nG1\n";
    double heading = rad_from_deg(90.0 + turn_deg);
    Vec2 at(1, 1);
    for (int i = 0; i < 9; ++i) {
      heading -= rad_from_deg(i % 3 == 0 ? turn_deg : 3);
      at += 0.3 * Vec2(std::cos(heading), std::sin(heading));
      text += fmt::format("X{:.3f} Y{:.3f}\n", at.x(), at.y());
    }
    text += fmt::format("G2 X{:.3f} Y{:.3f} I0.5 J0.\nM2\n", at.x() + 1, at.y());
    const std::string out = compressed(text, 1);
    EXPECT_LE(tests::hausdorff_mm(nc::read_clean(text).moves, nc::read_clean(out).moves, 0.002), 0.0101);
  }
}

TEST(Kinks, OfHelicesAreWithinTheBound) {
  // A ramp along a spiral: nothing of it is an arc for long.
  const std::string text = program_of(1500, [](int i) {
    const double a = 0.01 * i, r = 8 + 0.4 * a;
    return Vec3(r * std::cos(a) - 8, r * std::sin(a), -0.3 * a);
  });
  const std::string out = compressed(text, 0.5, true);
  const Kinks kinks = kinks_of_text(out);
  EXPECT_LE(kinks.max_deg, 0.5 + kMeasured_deg);
  EXPECT_LT(kinks.blocks, 60u);
  EXPECT_LE(tests::hausdorff_mm(nc::read_clean(text).moves, nc::read_clean(out).moves, 0.002), 0.0101);
}

TEST(Kinks, CornersAndGentleEdgesStaySharpWhereTheyWere) {
  for (const double edge_deg : {8.0, 12.0, 18.0, 30.0, 60.0}) {
    SCOPED_TRACE(edge_deg);
    // Two bows of 30 mm that meet in the edge.
    std::vector<Vec2> points{{0, 0}};
    double heading = 0;
    std::size_t edge = 0;
    for (int i = 0; i < 200; ++i) {
      if (i == 100) heading += rad_from_deg(edge_deg), edge = points.size() - 1;
      heading -= 0.1 / 30;
      points.emplace_back(points.back() + 0.1 * Vec2(std::cos(heading), std::sin(heading)));
    }
    const std::string text = program_of(200, [&](int i) {
      const Vec2& p = points[static_cast<std::size_t>(i)];
      return Vec3(p.x(), p.y(), 0);
    });
    const nc::Read out = nc::read_clean(compressed(text, 1));
    int sharp = 0;
    for (const auto& kink : kinks_between_moves(out.moves)) {
      if (deg_from_rad(kink.rad) < 1 + kMeasured_deg) continue;
      ++sharp;
      EXPECT_LT((kink.at_mm.head<2>() - points[edge]).norm(), 0.001);
      EXPECT_NEAR(deg_from_rad(kink.rad), edge_deg, 1.0);
    }
    EXPECT_EQ(sharp, 1);
  }
}

/// Lines, bows, edges and turns, of many blocks.
std::string random_program(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  double heading = 6 * u(random);
  Vec2 at = Vec2::Zero();
  std::string text = kHead;
  for (int piece = 0; piece < 6; ++piece) {
    if (random() % 3 == 0) heading += 1.5 * (u(random) - 0.5);
    const double curvature = random() % 3 == 0 ? 0 : (random() % 2 ? 1 : -1) / std::exp(std::log(0.5) + 5 * u(random));
    const double step = 0.07 + 0.4 * u(random) * u(random);
    for (int i = 0; i < 30; ++i) {
      heading += step * curvature * (1 + 0.5 * std::sin(0.3 * i));
      at += step * Vec2(std::cos(heading), std::sin(heading));
      text += fmt::format("X{:.3f} Y{:.3f}\n", at.x(), at.y());
    }
  }
  return text + "M2\n";
}

TEST(Kinks, OfRandomPathsAreWithinTheBoundOrWhatThePathTurnsThere) {
  int beside_arcs = 0;
  EXPECT_TRUE(rc::check([&] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    const std::string text = random_program(random);
    const double bound = random() % 2 ? 1.0 : 0.5;
    const nc::Read before = nc::read_clean(text), after = nc::read_clean(compressed(text, bound));
    const auto turns = kinks_between_moves(before.moves);
    std::size_t at = 0;
    for (const auto& kink : kinks_between_moves(after.moves)) {
      while (turns.at(at).at_mm != kink.at_mm) ++at;  // throws where the end is no point of the program
      if (!kink.arc_before && !kink.arc_behind) continue;
      const double turn = deg_from_rad(turns[at].rad), is = deg_from_rad(kink.rad);
      if (turn > 20) continue;  // a corner
      ++beside_arcs;
      const bool gentle = turn <= 5;  // no edge either
      const double fraction = !gentle ? 1 : kink.arc_before && kink.arc_behind ? 0.125 : 0.6;
      RC_ASSERT(is <= std::max(bound, fraction * turn) + kMeasured_deg);
    }
  }));
  EXPECT_GT(beside_arcs, 200);
}

}  // namespace
}  // namespace camber::repath
