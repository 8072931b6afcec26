// Programs: what is rewritten, what is left alone, and what comes out, byte by byte.
#include <rapidcheck.h>

#include <random>

#include <gtest/gtest.h>

#include "base/units.h"
#include "repath/compress/compression.h"
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

/// Of two paths 0.01 mm apart, measured at points every 0.01 mm: the nearest may be half of that beside.
constexpr double kSampled_mm = 0.0112;

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

/// Chords of 1 degree on a radius of 20 mm, each with further words; `first` in the first of them.
std::string half_circle(const std::string& before, const std::string& behind, const std::string& first = "") {
  std::string out = "G21 G90 G17\nS3000 M3\nG0 X20. Y0 Z5.\nG1 Z-1. F300\n";
  for (int i = 1; i <= 180; ++i)
    out += fmt::format("{}X{:.3f} Y{:.3f}{}{}\n", before, 20 * std::cos(i * kPi / 180), 20 * std::sin(i * kPi / 180),
                       i == 1 ? first : "", behind);
  return out + "G0 Z5.\nM30\n";
}

std::size_t lines_of(const std::string& text) { return static_cast<std::size_t>(std::ranges::count(text, '\n')); }

TEST(Compress, WordsThatRepeatWhatIsInForceStopNothing) {
  const struct {
    const char *before, *behind, *first;
    const char* arc;
  } forms[] = {
      {"", "", " F800", "G3 X-20. Y0. I-20. J0. F800\n"},
      {"", " F800", "", "G3 X-20. Y0. I-20. J0. F800\n"},
      {"G1 ", " F800.", "", "G3 X-20. Y0. I-20. J0. F800.\n"},
      {"G1 ", " Z-1.000 F800.000", "", "G3 X-20. Y0. I-20. J0. F800.000\n"},
      {"G1 ", " S3000", " F800", "G3 X-20. Y0. I-20. J0. F800 S3000\n"},
      {"", " M8", " F800", "G3 X-20. Y0. I-20. J0. F800 M8\n"},
      {"", " M3 S3000 F800", "", "G3 X-20. Y0. I-20. J0. M3 S3000 F800\n"},
      {"G90 G17 G01 ", " F800", "", "G90 G17 G03 X-20. Y0. I-20. J0. F800\n"},
  };
  for (const auto& form : forms) {
    const std::string text = half_circle(form.before, form.behind, form.first), out = compressed(text);
    EXPECT_EQ(lines_of(out), 7u) << form.before << form.behind;
    EXPECT_NE(out.find(form.arc), std::string::npos) << out;
    EXPECT_LE(distance_mm(text, out), 0.0101);
    const auto before = nc::read_clean(text).moves, behind = nc::read_clean(out).moves;
    EXPECT_EQ(behind.states.size(), before.states.size());
    EXPECT_EQ(behind.moves[2].feed_mm_per_s, before.moves[2].feed_mm_per_s);
  }
}

TEST(Compress, WordsThatChangeWhatIsInForceEndARunAndStandWhereTheyStood) {
  std::string text = half_circle("", " F1000");
  const auto from = text.find("X-0.349");
  std::string rest = text.substr(from);
  for (std::size_t at = 0; (at = rest.find("F1000", at)) != std::string::npos;) rest.replace(at, 5, "F700");
  const std::string out = compressed(text.substr(0, from) + rest);
  // No G1 between the two arcs.
  EXPECT_NE(out.find("G3 X0. Y20. I-20. J0. F1000\nG3 X-20. Y0. I0. J-20. F700\nG0 Z5.\n"), std::string::npos) << out;
  // A coolant that is switched in the middle, a speed that changes.
  for (const char* word : {" M8", " S3500", " G40 M9"}) {
    std::string other = half_circle("", " F800");
    const auto line = other.find('\n', other.find("X0.000 Y20.000"));
    other.insert(line, word);
    EXPECT_NE(compressed(other).find(word), std::string::npos) << word;
    EXPECT_LE(distance_mm(other, compressed(other)), kSampled_mm);
  }
}

/// The path keeps to the tolerance with the switch on and off.
TEST(Compress, ABlockThatMayBeSkippedSplitsARunOnBothReadings) {
  const auto read = [](const std::string& text, bool skips) {
    nc::InterpreterOptions options = nc::units();
    options.skip_slash_blocks = skips;
    return nc::read_clean(text, options).moves;
  };
  for (const char* skipped : {"/X25. Y30.", "/X-3.", "/Z-2.", "/X-3. Y21. F300", "/M8", "/G4 X0.1", "/G91 X1.\nG90"}) {
    std::string text = half_circle("", " F800");
    const auto line = text.find('\n', text.find("X0.000 Y20.000"));
    text.insert(line + 1, std::string(skipped) + "\n");
    const std::string out = compressed(text);
    // Behind a Z that may be skipped the height is not known: those lines stay.
    if (std::string_view(skipped) != "/Z-2.") {
      EXPECT_LT(lines_of(out), 20u) << out;
    }
    for (const bool skips : {false, true})
      EXPECT_LE(tests::hausdorff_mm(read(text, skips), read(out, skips), 0.01), kSampled_mm) << skipped << skips << out;
  }
}

TEST(Compress, SaysWhatKeptRunsApart) {
  const auto why = [](const std::string& text) {
    const Read r = nc::read_clean(text);
    return why_unchanged(r.program, r.moves, RunKind::in_space);
  };
  EXPECT_EQ(why(half_circle("", " F800 (note)")),
            "181 cuts in 0 runs; what ends runs most often (180 times) is a comment or a sign in the block");
  EXPECT_EQ(why("G21 G90\nG0 X0 Y0 Z0\nG1 X1 F100\nX5\nM30\n"), "2 cuts in 1 runs");
}

TEST(Compress, NamesTheLineOfTheLargestKink) {
  // A straight line, then a coarse circle that leaves it with a kink.
  std::string text = kHead + "Z-1.\nX20. Y0.\n";
  for (int i = 1; i <= 40; ++i)
    text += fmt::format("X{:.3f} Y{:.3f}\n", 20 + 10 * std::sin(i * 0.03 + 0.2) - 10 * std::sin(0.2),
                        10 * std::cos(0.2) - 10 * std::cos(i * 0.03 + 0.2));
  const Read r = nc::read_clean(text + "M30\n");
  CompressOptions options;
  options.fit.max_kink_rad = 0.5 * kPi;
  const Compression out = compress(r.program, r.moves, options);
  ASSERT_GT(out.max_kink_rad, 0);
  std::vector<std::string> lines;
  std::stringstream in(out.text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_LT(out.max_kink_block, lines.size());
  EXPECT_TRUE(lines[out.max_kink_block].starts_with("G3") || lines[out.max_kink_block].starts_with("G2") ||
              lines[out.max_kink_block].starts_with("X"))
      << lines[out.max_kink_block];
}

TEST(Compress, NamesTheKinkThatTheProgramItselfHas) {
  // The first line behind a rapid meets a circle of 20 mm at an angle that is no corner; nothing beside it is smooth.
  const auto met_at = [](double angle_deg) {
    std::string text =
        fmt::format("G21 G90 G17\nG0 X{:.4f} Y-5. Z0.\nG1 X20. Y0. F800\n", 20 - 5 * std::tan(rad_from_deg(angle_deg)));
    for (int i = 1; i <= 90; ++i)
      text += fmt::format("X{:.4f} Y{:.4f}\n", 20 * std::cos(rad_from_deg(i)), 20 * std::sin(rad_from_deg(i)));
    const Read r = nc::read_clean(text + "M30\n");
    return compress(r.program, r.moves, {.tolerance_mm = 0.005});
  };
  const Compression out = met_at(8);
  EXPECT_NEAR(deg_from_rad(out.max_edge_rad), 8, 0.1);
  std::stringstream in(out.text);
  std::string line;
  for (std::uint32_t i = 0; i <= out.max_edge_block; ++i) std::getline(in, line);
  EXPECT_TRUE(line.starts_with("G3 X0. Y20.")) << out.text;
  EXPECT_EQ(met_at(0).max_edge_rad, 0);
  EXPECT_EQ(met_at(45).max_edge_rad, 0) << "a corner";
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
