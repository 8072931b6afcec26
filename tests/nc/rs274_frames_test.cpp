// Frames and cutter radius compensation against LinuxCNC's interpreter, where `rs274` is on the PATH.
#include <random>
#include <string_view>

#include "tests/nc/rs274_oracle.h"

namespace camber::nc {
namespace {

/// As LinuxCNC starts: every offset and reference point known, and zero.
InterpreterOptions all_known() {
  InterpreterOptions options = as("linuxcnc");
  for (const int number : {54, 55, 56, 57, 58, 59, 591, 592, 593}) options.work_offsets_mm[number] = Vec3::Zero();
  return options;
}

TEST_F(Rs274, FramesOfRandomProgramsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-20, 20);
  constexpr const char* kOffsets[] = {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"};
  for (int program = 0; program < 15; ++program) {
    SCOPED_TRACE(program);
    std::string text = "G21 G17 G90 G94\nG0 X0 Y0 Z20\nF100 S1000 M3\n";
    for (int i = 0; i < 60; ++i) {
      switch (random() % 12) {
        case 0:
          text += fmt::format("G52 X{:.3f} Z{:.3f}\n", u(random), u(random));
          break;
        case 1:
          text += fmt::format("G92 X{:.3f} Y{:.3f}\n", u(random), u(random));
          break;
        case 2:
          text += fmt::format("G92.{}\n", 1 + random() % 3);
          break;
        case 3:
          text += fmt::format("G10 L2 P{} X{:.3f} Y{:.3f} Z{:.3f}\n", random() % 10, u(random), u(random), u(random));
          break;
        case 4:
          text += fmt::format("G10 L20 P{} X{:.3f} Y{:.3f}\n", random() % 10, u(random), u(random));
          break;
        case 5:
          text += fmt::format("{}\n", kOffsets[random() % 9]);
          break;
        case 6:
          text += fmt::format("G91 G1 X{:.3f} Z{:.3f}\nG90\n", u(random), u(random));
          break;
        case 7:
          text += fmt::format("G17 G{} I{:.3f} J{:.3f}\n", 2 + random() % 2, u(random), u(random));
          break;
        case 8:
          text += fmt::format("G18 G2 I{:.3f} K{:.3f} Y{:.3f}\nG17\n", u(random), u(random), u(random));
          break;
        case 9:
          text += fmt::format("G91 G2 X{:.3f} Y1 R-{:.3f}\nG90\n", u(random), 25 + std::abs(u(random)));
          break;
        default:
          text += fmt::format("G{} X{:.3f} Y{:.3f} Z{:.3f}\n", random() % 2, u(random), u(random), u(random));
          break;
      }
    }
    expect_same_moves(text + "M2\n", all_known(), 0.0005);  // offsets are printed with four decimals: sums of them
  }
}

TEST_F(Rs274, TurnedWorkOffsetsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  expect_same_moves(
      "G21 G17 G90 G94\nG0 X1 Y2 Z3\nF100\nG92 X0 Y0\nG1 X5\nG10 L2 P1 X10 Y20 R30\nG1 X0 Y0\nX5\nG2 X8 Y3 I0 J3\n"
      "G55 G1 X0 Y0\nG52 X1\nG1 X0\nG54\nG92.1\nG1 X5\nG10 L20 P2 X0\nX1\nG55\nX1 Y1\nM2\n",
      all_known(), 0.0003);
}

/// A random contour of lines and tangent or sharp arcs that turns by 10 to 140 degrees at its corners, in a plane.
std::string random_contour(std::mt19937& random, int side, double radius, const char* plane) {
  std::uniform_real_distribution<double> u(0, 1);
  const bool xy = std::string_view(plane) == "G17";
  const char first = xy ? 'X' : 'Z', second = xy ? 'Y' : 'X';
  std::string text =
      fmt::format("G21 {} G90 G94 G40\nG0 X0 Y0 Z0\nF100\nG{}.1 D{} G1 {}10\n", plane, side, 2 * radius, first);
  double x = 10, y = 0, heading = 0;
  for (int i = 0; i < 12; ++i) {
    double turn = (10 + 130 * u(random)) * kPi / 180;
    if (random() % 2 == 0) turn = -turn;
    heading += turn;
    const double length = 12 + 10 * u(random);
    if (random() % 3 == 0) {
      // An arc that starts in the heading and turns by half a radian to two radians.
      const double sweep = (0.5 + 1.5 * u(random)) * (random() % 2 == 0 ? 1 : -1), r = 10 + 10 * u(random);
      const double side_of = sweep > 0 ? 1 : -1;
      const double cx = x - side_of * r * std::sin(heading), cy = y + side_of * r * std::cos(heading);
      const double nx = cx + side_of * r * std::sin(heading + sweep), ny = cy - side_of * r * std::cos(heading + sweep);
      text += fmt::format("G{} {}{:.6f} {}{:.6f} {}{:.6f} {}{:.6f}\n", sweep > 0 ? 3 : 2, first, nx, second, ny,
                          xy ? 'I' : 'K', cx - x, xy ? 'J' : 'I', cy - y);
      x = nx;
      y = ny;
      heading += sweep;
    } else {
      x += length * std::cos(heading);
      y += length * std::sin(heading);
      text += fmt::format("G1 {}{:.6f} {}{:.6f}\n", first, x, second, y);
    }
  }
  return text + fmt::format("G40 G1 {}{:.6f} {}{:.6f}\nM2\n", first, x + 20, second, y + 30);
}

TEST_F(Rs274, RandomContoursUnderCutterRadiusCompensationMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(5);
  int compared = 0, refused_by_both = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const std::string text = random_contour(random, 41 + i % 2, 1 + i % 3, i % 4 == 3 ? "G18" : "G17");
    const Read r = read_text(text, all_known());
    const bool ours = r.diagnostics.has_errors() || r.moves.moves.empty();
    const std::string output = run_rs274(text);
    const bool theirs = output.find("gouging") != std::string::npos;
    EXPECT_EQ(ours, theirs) << text << (r.messages.empty() ? "" : r.messages.back());
    if (ours || theirs) {
      refused_by_both += ours && theirs;
      continue;
    }
    ++compared;
    expect_same_moves(text, all_known(), 0.0002, output);
  }
  EXPECT_GT(compared, 20);
  EXPECT_GT(refused_by_both, 0);
  RecordProperty("compared", compared);
  RecordProperty("refused_by_both", refused_by_both);
}

}  // namespace
}  // namespace camber::nc
