// Programs: what is rewritten, what is left alone, and what comes out, byte by byte.
#include <rapidcheck.h>

#include <random>

#include <gtest/gtest.h>

#include "repath/compress.h"
#include "tests/nc/rs274_oracle.h"
#include "tests/support/path_distance.h"

namespace camber::repath {
namespace {

using nc::Read;

/// Words of `n` points of a circle of radius r about 0 0, from the angle 0.
std::string arc_words(double r, double sweep, int n, const std::string& axes = "XY", int decimals = 3) {
  std::string out;
  for (int i = 1; i <= n; ++i)
    out += fmt::format("{}{:.{}f} {}{:.{}f}\n", axes[0], r * std::cos(sweep * i / n), decimals, axes[1],
                       r * std::sin(sweep * i / n), decimals);
  return out;
}

std::string compressed(const std::string& text, const CompressOptions& options = {}) {
  const Read r = nc::read_clean(text);
  return compress(r.program, r.moves, options).text;
}

/// Reads both; independent distance both ways.
double distance_mm(const std::string& before, const std::string& after, double step_mm = 0.01) {
  return tests::hausdorff_mm(nc::read_clean(before).moves, nc::read_clean(after).moves, step_mm);
}

const std::string kHead = "G21 G90 G17\nS1000 M3\nG0 X10. Y0. Z0.\nG1 F500\n";

TEST(Compress, ARunOfG1BecomesAnArcAndTheRestStays) {
  const std::string text = kHead + arc_words(10, 2.0, 60) + "G0 Z5.\nM30\n";
  const std::string out = compressed(text);
  EXPECT_EQ(out, kHead + "G3 X-4.161 Y9.093 I-10. J0.\nG0 Z5.\nM30\n");
  EXPECT_LE(distance_mm(text, out), 0.0101);
}

TEST(Compress, AWholeCircleIsOneBlock) {
  const std::string text = kHead + arc_words(10, -2 * kPi, 180) + "G0 Z5.\nM30\n";
  const std::string closed = tests::replaced(text, "X10.000 Y0.000\n", "X10. Y-0.\n");
  EXPECT_EQ(compressed(closed), kHead + "G2 I-10. J0.\nG0 Z5.\nM30\n");
}

TEST(Compress, KeepsNumbersOfKeptBlocksAndTheWayOfWriting) {
  std::string text = "%\r\nN10 G21 G90 G17\r\nN20 G00 X10.000 Y0.000 Z0.000\r\nN30 G01 X10.000 Y0.000 F500\r\n";
  for (int i = 1; i <= 30; ++i)
    text += fmt::format("N{} G01 X{:.3f} Y{:.3f}\r\n", 30 + 10 * i, 10 * std::cos(0.05 * i), 10 * std::sin(0.05 * i));
  text += "N340 G01 X0.000 Y20.000\r\nN350 M30\r\n%\r\n";
  EXPECT_EQ(compressed(text),
            "%\r\nN10 G21 G90 G17\r\nN20 G00 X10.000 Y0.000 Z0.000\r\n"
            "N330 G03 X0.707 Y9.975 I-10.000 J0.000 F500\r\nN340 G01 X0.000 Y20.000\r\nN350 M30\r\n%\r\n");
}

TEST(Compress, ModalG1BehindTheRunIsRestored) {
  const std::string out = compressed(kHead + arc_words(10, 2.0, 60) + "X0. Y0. Z1. (off)\nM30\n");
  EXPECT_EQ(out, kHead + "G3 X-4.161 Y9.093 I-10. J0.\nG1\nX0. Y0. Z1. (off)\nM30\n");
}

TEST(Compress, FeedSpindleCommentAndCodesAreBoundaries) {
  for (const char* middle : {"F300\n", "S2000\n", "(note)\n", "M8\n", "\n", "/X10. Y0.\n", "G4 P1.\n", "G64 P0.1\n"}) {
    SCOPED_TRACE(middle);
    const std::string first = arc_words(10, 0.5, 20),
                      second = "X20. Y5.\n" + std::string("X30. Y5.\nX40. Y5.\nX50. Y5.\n");
    std::string text = kHead + first + middle + second + "M30\n";
    const std::string out = compressed(text);
    EXPECT_NE(out.find(middle), std::string::npos);
    EXPECT_TRUE(out.starts_with(kHead + "G3 X8.776 Y4.794 I-10. J0.\n")) << out;
    EXPECT_TRUE(out.ends_with("X20. Y5.\nX50.\nM30\n")) << out;
    EXPECT_LE(distance_mm(text, out), 0.0101);
  }
}

TEST(Compress, AFeedInABlockBeginsARun) {
  std::string text = kHead + "X11.\nX12.\nX13. F300\nX14.\nX15.\nM30\n";
  EXPECT_EQ(compressed(text), kHead + "X12.\nX15. F300\nM30\n");
}

TEST(Compress, AnotherPlaneGetsLinesOnlyUnlessItMaySwitch) {
  const std::string text = kHead + arc_words(10, 0.5, 40, "XZ") + "X0. Y1. Z0.\nM30\n";
  const std::string lines = compressed(text);
  EXPECT_EQ(lines.find("G2"), lines.find("G21")) << lines;
  EXPECT_EQ(lines.find("G3"), std::string::npos);
  EXPECT_LT(lines.size(), text.size() / 2);
  CompressOptions options;
  options.switch_planes = true;
  EXPECT_EQ(compressed(text, options), kHead + "G18 G2 X8.776 Z4.794 I-10. K0.\nG17 G1\nX0. Y1. Z0.\nM30\n");
  EXPECT_LE(distance_mm(text, lines), 0.0113);
  EXPECT_LE(distance_mm(text, compressed(text, options)), 0.0101);
}

TEST(Compress, EveryPlaneHasItsCentreWords) {
  const std::string zx = "G21 G90 G18\nG0 X10. Y0. Z0.\nG1 F500\n" + arc_words(10, 0.5, 40, "XZ") + "M30\n";
  EXPECT_NE(compressed(zx).find("G2 X8.776 Z4.794 I-10. K0.\n"), std::string::npos) << compressed(zx);
  const std::string yz = "G21 G90 G19\nG0 X0. Y10. Z0.\nG1 F500\n" + arc_words(10, 0.5, 40, "YZ") + "M30\n";
  EXPECT_NE(compressed(yz).find("G3 Y8.776 Z4.794 J-10. K0.\n"), std::string::npos) << compressed(yz);
}

TEST(Compress, IncrementalAndInchProgramsAndAbsoluteCentres) {
  std::string g91 = "G21 G90 G17\nG0 X10. Y0. Z0.\nG91 G1 F500\n";
  double x = 10, y = 0;
  for (int i = 1; i <= 60; ++i) {
    const double nx = std::round(1e4 * std::cos(i / 30.0)) / 1e3, ny = std::round(1e4 * std::sin(i / 30.0)) / 1e3;
    g91 += fmt::format("X{:.3f} Y{:.3f}\n", nx - x, ny - y);
    x = nx, y = ny;
  }
  EXPECT_EQ(compressed(g91 + "M30\n"),
            "G21 G90 G17\nG0 X10. Y0. Z0.\nG91 G1 F500\nG3 X-14.161 Y9.093 I-10. J0.\nM30\n");
  const std::string inch = "G20 G90 G17\nG0 X1. Y0. Z0.\nG1 F50\n" + arc_words(1, 2.0, 120, "XY", 4) + "M30\n";
  EXPECT_EQ(compressed(inch), "G20 G90 G17\nG0 X1. Y0. Z0.\nG1 F50\nG3 X-0.4161 Y0.9093 I-1. J0.\nM30\n");
  const std::string absolute = "G21 G90 G90.1 G17\nG0 X10. Y0. Z0.\nG1 F500\n" + arc_words(10, 2.0, 60) + "M30\n";
  EXPECT_NE(compressed(absolute).find("G3 X-4.161 Y9.093 I0. J0.\n"), std::string::npos) << compressed(absolute);
}

TEST(Compress, LeavesAloneWhatIsNotItsOwn) {
  const std::string run = arc_words(10, 0.5, 20);
  for (const std::string& text :
       {"G21 G90 G17\nG0 X0 Y0 Z0\nG1 G41 X10. Y0. D1 F500\n" + run + "G40 X0 Y0\nM30\n",
        "G21 G90 G17 F500\nG0 X10. Y0. Z5.\nG81 Z-1. R1.\n" + run + "G80\nM30\n",
        "G21 G90 G93 G17\nG0 X10. Y0. Z0.\nG1 X10. F9\n" + tests::replaced(run, "\n", " F9\n") + "M30\n",
        "G21 G90 G17 G61.1\nG0 X10. Y0. Z0.\nG1 F500\n" + run + "M30\n"}) {
    nc::InterpreterOptions options{.inch = false};
    options.tool_offsets[1] = {.radius_mm = 1.0};
    const Read r = nc::read_text(text, options);
    const auto result = compress(r.program, r.moves, {});
    EXPECT_EQ(result.text, text);
    EXPECT_TRUE(result.runs.empty());
  }
}

class CompressRs274 : public nc::Rs274 {};

/// A random program in one plane, three decimals or four in inches.
std::string random_program(std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  const bool inch = random() % 4 == 0;
  const int plane = 17 + static_cast<int>(random() % 3);
  const char* axes = plane == 17 ? "XY" : plane == 18 ? "XZ" : "YZ";
  std::string text = fmt::format("G{} G90 G94 G{}\nG0 X0. Y0. Z0.\nG1 F300.\n", inch ? 20 : 21, plane);
  double x = 0, y = 0, heading = 6 * u(random);
  for (int piece = 0; piece < 6; ++piece) {
    if (random() % 3 == 0) heading += 3 * (u(random) - 0.5);
    const double curvature = random() % 3 == 0 ? 0 : (random() % 2 ? 1 : -1) / std::exp(std::log(0.2) + 6 * u(random));
    const double step = 0.05 + 0.3 * u(random);
    for (int i = 0; i < 25; ++i) {
      heading += step * curvature;
      x += step * std::cos(heading);
      y += step * std::sin(heading);
      text += fmt::format("{}{:.{}f} {}{:.{}f}\n", axes[0], x / (inch ? 25.4 : 1), inch ? 4 : 3, axes[1],
                          y / (inch ? 25.4 : 1), inch ? 4 : 3);
    }
    if (random() % 3 == 0) text += fmt::format("F{}.\n", 200 + piece);
  }
  return text + "M2\n";
}

TEST(Compress, RandomProgramsStayWithinTheToleranceBothWays) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    const std::string text = random_program(random);
    CompressOptions options;
    options.tolerance_mm = 0.01;
    const std::string out = compressed(text, options);
    RC_ASSERT(out.size() <= text.size());
    RC_ASSERT(distance_mm(text, out) <= 0.0101 + 0.0013);  // samples 0.01 mm apart: sqrt(0.01^2 + 0.005^2) - 0.01
    const Read before = nc::read_clean(text), after = nc::read_clean(out);
    RC_ASSERT((before.moves.moves.back().end_mm - after.moves.moves.back().end_mm).norm() < 1e-9);
  }));
}

TEST_F(CompressRs274, ReadsWhatComesOut) {
  if (!nc::rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) {
    const std::string out = compressed(random_program(random));
    expect_same_moves(out, nc::as("linuxcnc"), 0.00011);
  }
  EXPECT_GT(arcs_, 20u);
}

}  // namespace
}  // namespace camber::repath
