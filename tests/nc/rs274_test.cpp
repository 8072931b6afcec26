// Our moves against the canonical output of LinuxCNC's interpreter, where `rs274` is on the PATH.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "base/units.h"
#include "tests/nc/nc_text.h"
#include "tests/support/temp_folder.h"

namespace camber::nc {
namespace {

struct CanonMove {
  MoveKind kind;
  Vec3 end_mm;
  double unit_mm;
};

/// Numbers behind the first bracket of a line.
std::vector<double> arguments(const std::string& line) {
  std::vector<double> out;
  std::stringstream in(line.substr(line.find('(') + 1));
  for (std::string item; std::getline(in, item, ',');) out.push_back(std::strtod(item.c_str(), nullptr));
  return out;
}

/// Traverses, feeds and arcs in order, lines without length left out. Arc ends come in the order of the plane.
std::vector<CanonMove> canonical(const std::string& output) {
  std::vector<CanonMove> moves;
  Vec3 at = Vec3::Zero();
  const auto add = [&](MoveKind kind, const Vec3& end_mm, double unit_mm) {
    if (kind == MoveKind::arc || end_mm != at) moves.push_back({kind, end_mm, unit_mm});
    at = end_mm;
  };
  double unit = 1, turn_rad = 0;
  Vec3 g5x = Vec3::Zero(), g92 = Vec3::Zero();
  // What it prints is in the work offset; what we give is in the machine's axes (the tests give all offsets as 0).
  const auto place = [&](const Vec3& p) -> Vec3 {
    const Vec3 q = p + g92;
    const double c = std::cos(turn_rad), d = std::sin(turn_rad);
    return g5x + Vec3(c * q.x() - d * q.y(), d * q.x() + c * q.y(), q.z());
  };
  std::string plane = "XY";
  std::stringstream in(output);
  for (std::string line; std::getline(in, line);) {
    const auto a = arguments(line);
    const auto has = [&](const char* name) { return line.find(name) != std::string::npos; };
    if (has("USE_LENGTH_UNITS")) unit = has("INCHES") ? kMmPerInch : 1;
    if (has("SELECT_PLANE")) plane = has("PLANE_XZ") ? "XZ" : has("PLANE_YZ") ? "YZ" : "XY";
    if (has("SET_G5X_OFFSET")) g5x = unit * Vec3(a[1], a[2], a[3]);
    if (has("SET_G92_OFFSET")) g92 = unit * Vec3(a[0], a[1], a[2]);
    if (has("SET_XY_ROTATION")) turn_rad = a[0] * kPi / 180;
    if (has("STRAIGHT_TRAVERSE")) add(MoveKind::rapid, place(unit * Vec3(a[0], a[1], a[2])), unit);
    if (has("STRAIGHT_FEED")) add(MoveKind::linear, place(unit * Vec3(a[0], a[1], a[2])), unit);
    if (!has("ARC_FEED")) continue;
    const Vec3 end = plane == "XY"   ? Vec3(a[0], a[1], a[5])
                     : plane == "XZ" ? Vec3(a[1], a[5], a[0])
                                     : Vec3(a[5], a[0], a[1]);
    add(MoveKind::arc, place(unit * end), unit);
  }
  return moves;
}

bool rs274_present() { return std::system("command -v rs274 >/dev/null 2>&1") == 0; }

std::string run_rs274(const std::string& text, bool must_succeed = true) {
  tests::TempFolder folder;
  folder.write("program.ngc", text);
  // rs274 keeps its variables in the working directory and its tool table in ~/.tool.mmap, which a second one
  // cuts off under the first (bus error): a folder and a home of its own, as tests run side by side.
  const std::string command = "cd '" + folder.path() + "' && HOME=\"$PWD\" rs274 -g program.ngc 2>&1";
  std::string out;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return out;
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  const int status = pclose(pipe);
  if (must_succeed) {
    EXPECT_EQ(status, 0) << out;
  }
  return out;
}

/// Returns the largest difference, mm; moves without length may be missing on either side.
double expect_same_moves(const std::string& text, const InterpreterOptions& options = {}, double tolerance = 0.00006,
                         const std::string& output = {}) {
  const Read r = read_text(text, options);
  for (const auto& m : r.messages) EXPECT_EQ(m.find("error"), std::string::npos) << m;
  const std::vector<CanonMove> canon = canonical(output.empty() ? run_rs274(text) : output);
  double largest = 0;
  std::size_t at = 0;
  for (const Move& m : r.moves.moves) {
    if (m.kind == MoveKind::dwell || (m.kind != MoveKind::arc && m.start_mm == m.end_mm)) continue;
    if (at == canon.size()) {
      ADD_FAILURE() << "rs274 has " << canon.size() << " moves only";
      return largest;
    }
    const CanonMove& c = canon[at++];
    const double difference = (m.end_mm - c.end_mm).cwiseAbs().maxCoeff();
    largest = std::max(largest, difference);
    const bool alike = m.kind == c.kind && difference <= tolerance * c.unit_mm;  // it prints four decimals
    EXPECT_TRUE(alike) << "block " << m.block + 1 << ": " << m.end_mm.transpose() << " and " << c.end_mm.transpose();
    if (!alike) return largest;
  }
  EXPECT_EQ(at, canon.size());
  return largest;
}

TEST(Rs274, LinuxCncProgramsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  const auto files = shared_files("linuxcnc/programs");
  if (files.empty()) GTEST_SKIP() << "no shared data at " << CAMBER_SHARED_DATA_DIR;
  for (const auto& f : files) {
    if (!f.ends_with(".ngc")) continue;
    SCOPED_TRACE(f);
    expect_same_moves(SourceText::read(f).text());
  }
}

TEST(Rs274, BallFinishingOfBoxOp5MovesAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  const std::string path = shared_file("nist/box_op5.nc");
  if (path.empty()) GTEST_SKIP() << "no shared data at " << CAMBER_SHARED_DATA_DIR;
  std::string text = "G20 G17 G40 G49 G90 G94\n", line;
  std::ifstream in(path);
  bool ours = false;
  while (std::getline(in, line)) {
    if (ours && line.find("G28") != std::string::npos) break;
    if (ours) text += line + "\n";
    ours = ours || line.find("T9M6") != std::string::npos;
  }
  EXPECT_LT(expect_same_moves(text + "M2\n"), 0.0015);
}

TEST(Rs274, RandomProgramsMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-10, 10);
  for (int program = 0; program < 20; ++program) {
    SCOPED_TRACE(program);
    std::string text = "G21 G17 G90 G94 G64 P0.01\nG0 X0 Y0 Z20\nF100 S1000 M3\n";
    for (int i = 0; i < 60; ++i) {
      switch (random() % 8) {
        case 0:
          text += fmt::format("G0 X{:.3f} Z{:.3f}\n", u(random), u(random));
          break;
        case 1:
          text += fmt::format("g1x{:.3f}y{:.3f}\n", u(random), u(random));
          break;
        case 2:
          text += fmt::format("G91 G1 X{:.3f} Z{:.3f} (inc)\nG90\n", u(random), u(random));
          break;
        case 3:
          text += fmt::format("G17 G{} I{:.3f} J{:.3f} P2\n", 2 + random() % 2, u(random), u(random));
          break;
        case 4:
          text += fmt::format("G18 G2 I{:.3f} K{:.3f} Y{:.3f}\nG17\n", u(random), u(random), u(random));
          break;
        case 5:
          text += fmt::format("G19 G3 J{:.3f} K{:.3f}\nG17\n", u(random), u(random));
          break;
        case 6:
          text += fmt::format("G91 G2 X{:.3f} Y1 R-{:.3f}\nG90\n", u(random), 12 + std::abs(u(random)));
          break;
        default:
          text += fmt::format("G20\nG1 X{:.4f}\nG21\n", u(random) / 25);
          break;
      }
    }
    expect_same_moves(text + "M2\n");
  }
}

TEST(Rs274, DrillingCyclesMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  for (const char* cycle : {"G81 X5 Y5 Z-3 R1", "G82 X5 Y5 Z-3 R1 P0.5", "G83 X5 Y5 Z-3 R1 Q1.5",
                            "G73 X5 Y5 Z-3 R1 Q1.5", "G85 X5 Y5 Z-3 R1", "G89 X5 Y5 Z-3 R1 P0.5"})
    for (const char* level : {"G98", "G99"}) {
      SCOPED_TRACE(cycle);
      // G85 and G89 feed out to R and go on in rapid, as Fanuc does; LinuxCNC feeds up to the initial level.
      const bool feeds_out = std::string_view(cycle).starts_with("G85") || std::string_view(cycle).starts_with("G89");
      if (feeds_out && std::string_view(level) == "G98") continue;
      expect_same_moves(fmt::format(
          "G21 G17 G90 G94\nG0 X0 Y0 Z20\nF100 S1000 M3\n{} {}\nX9\nX12 Y3\nG80\nG0 Z20\nM2\n", level, cycle));
    }
}

// --- frames and cutter radius compensation
// ------------------------------------------------------------------------------

/// As LinuxCNC starts: every offset and reference point known, and zero.
InterpreterOptions all_known() {
  InterpreterOptions options;
  for (const int number : {54, 55, 56, 57, 58, 59, 591, 592, 593}) options.work_offsets_mm[number] = Vec3::Zero();
  options.radius_look_ahead = 1000;
  return options;
}

TEST(Rs274, FramesOfRandomProgramsMoveAlike) {
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

TEST(Rs274, TurnedWorkOffsetsMoveAlike) {
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

TEST(Rs274, RandomContoursUnderCutterRadiusCompensationMoveAlike) {
  if (!rs274_present()) GTEST_SKIP() << "rs274 (package linuxcnc-uspace) is not on the PATH";
  std::mt19937 random(5);
  int compared = 0, refused_by_both = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const std::string text = random_contour(random, 41 + i % 2, 1 + i % 3, i % 4 == 3 ? "G18" : "G17");
    const Read r = read_text(text, all_known());
    const bool ours = r.diagnostics.has_errors() || r.moves.moves.empty();
    const std::string output = run_rs274(text, false);
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
