// Arcs in what is laid out again: short ones are taken in, good blocks stay.
#include "repath/resegment/resegmentation.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "repath/resegment/fastest.h"
#include "tests/nc/rs274_oracle.h"
#include "tests/support/path_distance.h"

namespace camber::repath {
namespace {

using nc::Read;

struct ArcStyle {
  int plane = 17;
  char form = 'I';  ///< I from the start, A absolute, R
  bool helix = false, incremental = false;
};

/// A smooth path of tangent arcs of `length_mm` on a radius of 3 to 8 mm, now and then a line; the axis across the
/// plane moves along where it is a helix. Places are rounded to 1e-4 mm, so that radii agree.
std::string tangent_arcs(const ArcStyle& style, std::mt19937& random, int blocks, double length_mm) {
  const std::string axes = style.plane == 17 ? "XYZ" : style.plane == 18 ? "ZXY" : "YZX";
  const std::string centres = style.plane == 17 ? "IJ" : style.plane == 18 ? "KI" : "JK";
  std::uniform_real_distribution<double> radius(3, 8), fraction(0.4, 1.6), any(0, 1);
  std::string text = fmt::format("G21 G90 G{}\nG0 X0. Y0. Z0.\n", style.plane);
  if (style.form == 'A') text += "G90.1\n";
  if (style.incremental) text += "G91\n";
  text += "F3000\n";
  const auto round4 = [](double v) { return std::round(v * 1e4) / 1e4; };
  double heading = 0, up = 0;
  Vec2 at(0, 0);
  const auto place = [&](const Vec2& to, double to_up) {
    const Vec2 from = style.incremental ? at : Vec2(0, 0);
    std::string out = fmt::format(" {}{:.4f} {}{:.4f}", axes[0], to.x() - from.x(), axes[1], to.y() - from.y());
    if (style.helix) out += fmt::format(" {}{:.4f}", axes[2], to_up - (style.incremental ? up : 0));
    return out;
  };
  for (int k = 0; k < blocks; ++k) {
    const double length = length_mm * fraction(random), to_up = style.helix ? round4(up + 0.15 * length) : 0;
    if (k % 6 == 5) {
      const Vec2 end = at + length * Vec2(std::cos(heading), std::sin(heading));
      const Vec2 to(round4(end.x()), round4(end.y()));
      text += "G1" + place(to, to_up) + "\n";
      at = to, up = to_up;
      continue;
    }
    const double r = radius(random), side = k / 12 % 2 ? 1.0 : -1.0, sweep = side * length / r;
    const Vec2 centre = at + side * r * Vec2(-std::sin(heading), std::cos(heading));
    const double c = std::cos(sweep), s = std::sin(sweep);
    const Vec2 spoke = at - centre, end = centre + Vec2(c * spoke.x() - s * spoke.y(), s * spoke.x() + c * spoke.y());
    const Vec2 to(round4(end.x()), round4(end.y()));
    text += side > 0 ? "G3" : "G2";
    text += place(to, to_up);
    if (style.form == 'R')
      text += fmt::format(" R{:.4f}\n", r);
    else
      text += fmt::format(" {}{:.4f} {}{:.4f}\n", centres[0], centre.x() - (style.form == 'A' ? 0 : at.x()), centres[1],
                          centre.y() - (style.form == 'A' ? 0 : at.y()));
    heading += sweep;
    at = to, up = to_up;
  }
  return text + "G90\nG0 X0.\nM30\n";
}

std::vector<ArcStyle> all_styles() {
  std::vector<ArcStyle> out;
  for (const int plane : {17, 18, 19})
    for (const char form : {'I', 'A', 'R'})
      for (const bool helix : {false, true}) out.push_back({plane, form, helix, (plane + helix) % 2 == 0});
  return out;
}

std::size_t arcs_of(const Read& r) { return r.moves.arcs.size(); }

Read laid_out(const std::string& text, double tolerance_mm, double length_mm) {
  const Read old = nc::read_clean(text);
  const Resegmentation now = resegment(old.program, old.moves, {.tolerance_mm = tolerance_mm, .length_mm = length_mm});
  Read out = nc::read_clean(now.text);
  // Points 0.004 mm apart on both, each no farther from its neighbours' line than a fifth of a micrometre.
  EXPECT_LE(tests::hausdorff_mm(old.moves, out.moves, 0.004), tolerance_mm + 4e-4);
  EXPECT_LE(now.max_deviation_mm, tolerance_mm);
  return out;
}

class ShortArcsRs274 : public nc::Rs274 {};

}  // namespace

TEST(ShortArcs, BecomeSegmentsInEveryPlaneAndForm) {
  std::mt19937 random(5);
  for (const ArcStyle& style : all_styles()) {
    const std::string text = tangent_arcs(style, random, 120, 0.1);
    SCOPED_TRACE(text.substr(0, 300));
    const Read old = nc::read_clean(text), now = laid_out(text, 0.01, 0.4);
    EXPECT_EQ(arcs_of(old), 100u);
    EXPECT_EQ(arcs_of(now), 0u);
    EXPECT_LT(now.moves.moves.size(), old.moves.moves.size() / 3);
    EXPECT_LT((now.moves.moves.back().start_mm - old.moves.moves.back().start_mm).norm(), 1e-9);
  }
}

TEST(ShortArcs, AreThoseThatASegmentWithinTheToleranceIsLongerThan) {
  std::mt19937 random(6);
  // Radii of 3 to 8 mm at 0.002 mm: chords of 0.22 to 0.36 mm; the arcs are 0.2 to 0.8 mm long.
  const std::string text = tangent_arcs({}, random, 120, 0.5);
  EXPECT_GT(arcs_of(laid_out(text, 0.002, 5)), 80u);
  EXPECT_LT(arcs_of(laid_out(text, 0.05, 5)), 10u);
  // And the length asked for: none is shorter than 0.2 mm.
  EXPECT_EQ(arcs_of(laid_out(text, 0.05, 0.19)), 100u);
}

TEST(ShortArcs, ALoneOneStaysAndSoDoesOneBeyondACorner) {
  const std::string rounded = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X10. F3000\nG3 X10.1 Y0.1 I0. J0.1\nG1 Y10.\nM30\n";
  Read old = nc::read_clean(rounded);
  EXPECT_EQ(resegment(old.program, old.moves, {.length_mm = 1}).text, rounded);
  const std::string before = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X10. F3000\nG3 X10.1 Y0.1 I0. J0.1\n";
  old = nc::read_clean(before + "G1 X10.2\nX10.25\nM30\n");
  EXPECT_EQ(resegment(old.program, old.moves, {.length_mm = 1}).text, before + "G1 X10.25\nM30\n");
}

TEST(ShortArcs, OneBetweenTwoCornersStaysAmongShortLines) {
  std::string text = "G21 G90 G17\nG0 X0. Y0. Z0.\nF3000\n", up;
  for (int k = 1; k <= 10; ++k) text += fmt::format("{}X{:.1f}\n", k == 1 ? "G1 " : "", 0.1 * k);
  const std::string arc = "G3 X0.9 Y0.1 I-0.1 J0.\n";
  for (int k = 2; k <= 11; ++k) up += fmt::format("{}Y{:.1f}\n", k == 2 ? "G1 " : "", 0.1 * k);
  const Read old = nc::read_clean(text + arc + up + "M30\n");
  const std::string now = resegment(old.program, old.moves, {.tolerance_mm = 0.05, .length_mm = 0.5}).text;
  EXPECT_NE(now.find(arc), std::string::npos) << now;
  EXPECT_LT(std::count(now.begin(), now.end(), '\n'), 14) << now;
}

TEST(ShortArcs, FullCirclesAndLongArcsStayByteForByteAndLinesBetweenThemAreLaidOut) {
  std::string lines;
  for (int k = 1; k <= 40; ++k) lines += fmt::format("{}X{:.3f}\n", k == 1 ? "G1 " : "", 5 + 0.05 * k);
  const std::string head = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X5. F3000\n",
                    circle = "G3 X5. Y0. I0. J5.\nG2 X5. Y0. I0. J-1. Z-0.5\n", behind = "G3 X9. Y2. I0. J2.\nM30\n";
  const Read old = nc::read_clean(head + circle + lines + behind);
  EXPECT_EQ(resegment(old.program, old.moves, {.length_mm = 0.5}).text,
            head + circle + "G1 X5.5\nX6.\nX6.5\nX7.\n" + behind);
}

TEST(ShortArcs, ASmallFullCircleAmongShortBlocksIsReadAsTheControlRunsIt) {
  // Smaller than half the tolerance: nothing of it needs to be left, but nothing may be farther than the tolerance.
  const std::string text =
      "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X0.05 F3000\nX0.1\nG3 X0.1 Y0. I0. J0.03\nG1 X0.15\nX0.2\nX0.25\nM30\n";
  laid_out(text, 0.01, 1);
  laid_out(text, 0.1, 1);
}

TEST(ShortArcs, WhatReliesOnTheModeOfAnArcKeepsIt) {
  // The last of the short arcs gives its G2 to a long one, which says none.
  std::string text = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X0.02 F3000\n";
  for (int k = 1; k <= 12; ++k) {
    const double from = (k - 1) * 0.02, to = k * 0.02;
    text += fmt::format("{}X{:.4f} Y{:.4f} I{:.4f} J{:.4f}\n", k == 1 ? "G2 " : "", 0.02 + 5 * std::sin(to),
                        5 * std::cos(to) - 5, -5 * std::sin(from), -5 * std::cos(from));
  }
  const std::string last = fmt::format("X5.02 Y-5. I{:.4f} J{:.4f}\n", -5 * std::sin(0.24), -5 * std::cos(0.24));
  const Read old = nc::read_clean(text + last + "M30\n");
  const Read now = laid_out(text + last + "M30\n", 0.01, 0.5);
  // All but that arc and the line would do; what says G2 at their head cannot go without it.
  EXPECT_EQ(arcs_of(now), arcs_of(old));
  // With a G2 of its own the others may.
  EXPECT_EQ(arcs_of(laid_out(text + "G2 " + last + "M30\n", 0.01, 0.5)), 1u);
}

TEST(ShortArcs, KeepNumbersOfBlocksAndSayG1) {
  std::string text = "G21 G90 G17\nG0 X0. Y0. Z0.\nN1 G3 X0.1 Y0.001 I0. J5. F3000\n";
  for (int k = 2; k <= 10; ++k) {
    const double from = (k - 1) * 0.02, to = k * 0.02;
    text += fmt::format("N{} X{:.4f} Y{:.4f} I{:.4f} J{:.4f}\n", k, 5 * std::sin(to), 5 - 5 * std::cos(to),
                        -5 * std::sin(from), 5 * std::cos(from));
  }
  const Read old = nc::read_clean(text + "G0 X0.\nM30\n");
  const std::string now = resegment(old.program, old.moves, {.tolerance_mm = 0.02, .length_mm = 0.5}).text;
  EXPECT_EQ(now, "G21 G90 G17\nG0 X0. Y0. Z0.\nN6 G1 X0.6371 Y0.0501 F3000\nN10 X0.9933 Y0.0997\nG0 X0.\nM30\n");
}

TEST(ShortArcs, AreLaidOutFasterForAControlThatNeedsTimeForABlock) {
  std::mt19937 random(7);
  const Read old = nc::read_clean(tangent_arcs({.plane = 18}, random, 200, 0.08));
  for (const double block_time_s : {0.002, 0.001}) {
    machine::Machine machine;
    machine.control.block_time_s = block_time_s;
    for (auto& axis : machine.axis) axis.acceleration_mm_per_s2 = 3000;
    FastestOptions options;
    options.layout.tolerance_mm = 0.01;
    const ContourFigures before = contour_figures(old.moves, old.moves, machine);
    const Fastest found = find_fastest(old.program, old.moves, machine, before, options);
    const ContourFigures& now = found.tried[found.chosen].figures;
    EXPECT_LT(now.time_s, (block_time_s > 0.0015 ? 0.75 : 0.98) * before.time_s);
  }
}

TEST_F(ShortArcsRs274, ReadsWhatComesOut) {
  if (!nc::rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(8);
  for (const ArcStyle& style : all_styles()) {
    const Read old = nc::read_clean(tangent_arcs(style, random, 60, 0.25));
    const Resegmentation now = resegment(old.program, old.moves, {.tolerance_mm = 0.004, .length_mm = 0.4});
    EXPECT_FALSE(now.runs.empty());
    expect_same_moves(now.text, nc::as("linuxcnc"), 0.00011);
  }
  EXPECT_GT(arcs_, 20u);
}

}  // namespace camber::repath
