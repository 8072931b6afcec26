// G40, G41, G42: paths by hand, what is refused, and the distance to the contour by a second method.
#include "nc/cutter_radius.h"

#include <cmath>
#include <random>

#include <fmt/format.h>

#include "nc/emit.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

const std::string kNote =
    " is computed here, cutter radius 2.0000 mm; compensation leaves these moves unchanged [not-editable]";

/// "l 8 2; a 10 12; ": kind and end of each move in the plane of X and Y.
std::string path_of(const Read& r) {
  std::string out;
  for (const Move& m : r.moves.moves) {
    const char kind = m.kind == MoveKind::rapid   ? 'r'
                      : m.kind == MoveKind::arc   ? 'a'
                      : m.kind == MoveKind::dwell ? 'd'
                                                  : 'l';
    const auto shown = [](double v) { return std::round(v * 1e4) / 1e4 + 0.0; };
    out += fmt::format("{} {} {} {}; ", kind, shown(m.end_mm.x()), shown(m.end_mm.y()), shown(m.end_mm.z()));
  }
  return out;
}

std::string path(const std::string& text, const InterpreterOptions& o = as("linuxcnc")) {
  const Read r = read_text("G0 X0 Y0 Z0 F100\n" + text, o);
  for (const auto& m : r.messages) EXPECT_NE(m.find("[not-editable]"), std::string::npos) << m;
  return path_of(r).substr(std::string("r 0 0 0; ").size());
}

std::string complaint(const std::string& text, const InterpreterOptions& o = as("linuxcnc")) {
  const Read r = read_text("G0 X0 Y0 Z0 F100\n" + text, o);
  for (const auto& m : r.messages)
    if (m.find("error") != std::string::npos) return m;
  return {};
}

InterpreterOptions fanuc() {
  InterpreterOptions o = units();
  o.dialect = *dialect_named("fanuc");
  o.tool_offsets[4].radius_mm = 2;
  return o;
}

TEST(CutterRadius, InsideCornersMeetAndOutsideCornersAreArcs) {
  // Left of the way, radius 2: inside at (20, 0), outside at (20, 10).
  EXPECT_EQ(path("G41.1 D4 G1 X10\nX20\nY10\nX30\nG40 Y20\n"),
            "l 10 2 0; l 18 2 0; l 18 10 0; a 20 12 0; l 30 12 0; l 30 20 0; ");
  EXPECT_EQ(path("G42.1 D4 G1 X10\nX20\nY10\nX30\nG40 Y20\n"),
            "l 10 -2 0; l 20 -2 0; a 22 0 0; l 22 8 0; l 30 8 0; l 30 20 0; ");
}

TEST(CutterRadius, OutsideCornersOfFanucAreLines) {
  // A right angle: the lines meet at (18, 12). The entry ends square to the start of the next move.
  EXPECT_EQ(path("G41 D4 G1 X10 Y5\nX20\nY15\nX30\nG40 Y30\n", fanuc()),
            "l 10 7 0; l 18 7 0; l 18 17 0; l 30 17 0; l 30 30 0; ");
  // A turn by 135 degrees to the right: one radius further each, a line between.
  const double h = std::sqrt(0.5);
  EXPECT_EQ(path("G41 D4 G1 X10\nX20\nX10 Y-10\nG40 X0\n", fanuc()),
            fmt::format("l 10 2 0; l 22 2 0; l {:.4f} 0 0; l {:.4f} {:.4f} 0; l 0 -10 0; ", 20 + 2 * h + 2 * h,
                        10 + 2 * h, -10 - 2 * h));
  // Beside an arc the tangents are moves of their own.
  EXPECT_EQ(path("G41 D4 G1 X10\nX20\nG2 X30 Y-10 J-10\nX20 Y-20 I-10\nG1 X10\nY-10\nG40 X0\n", fanuc()),
            "l 10 2 0; l 20 2 0; a 32 -10 0; a 20 -22 0; l 8 -22 0; l 8 -10 0; l 0 -10 0; ");
  EXPECT_EQ(path("G41 D4 G1 X10\nX20\nG3 X30 Y-10 I10\nG40 G1 Y20\n", fanuc()),
            "l 10 2 0; l 22 2 0; l 22 0 0; a 30 -8 0; l 30 20 0; ");
}

TEST(CutterRadius, ArcsInsideAndOutside) {
  // A tangent arc of radius 10 to the left: 8 inside, 12 outside.
  EXPECT_EQ(path("G41.1 D4 G1 X10\nX20\nG3 X30 Y10 J10\nG1 Y20\nG40 X20\n"),
            "l 10 2 0; l 20 2 0; a 28 10 0; l 28 20 0; l 20 20 0; ");
  EXPECT_EQ(path("G42.1 D4 G1 X10\nX20\nG3 X30 Y10 J10\nG1 Y20\nG40 X40\n"),
            "l 10 -2 0; l 20 -2 0; a 32 10 0; l 32 20 0; l 40 20 0; ");
  // A full circle from inside, entered square: radius 8 about (20, 0).
  const Read r = read_text("G0 X20 Y0 Z0\nG41.1 D4 G1 X25 Y-5 F100\nG3 X30 Y0 J5\nG3 I-10\nX25 Y5 I-5\nG40 G1 X20 Y0\n",
                           as("linuxcnc"));
  ASSERT_EQ(r.moves.moves.size(), 6u);
  EXPECT_NEAR(r.moves.arcs[1].sweep_rad, 2 * kPi, 1e-9);
  expect_near_mm(r.moves.moves[3].start_mm, {28, 0, 0});
  EXPECT_NEAR(length_mm(r.moves, r.moves.moves[3]), 2 * kPi * 8, 1e-9);
}

TEST(CutterRadius, LineAndArcMeetInsideACorner) {
  // Line y = 2; circle of radius 12 about (30, 0) (G2 round the outside): x = 30 - sqrt(144 - 4).
  EXPECT_EQ(path("G41.1 D4 G1 X10\nX20\nG2 X30 Y10 I10\nG1 X40\nG40 Y20\n"),
            fmt::format("l 10 2 0; l {:.4f} 2 0; a 30 12 0; l 40 12 0; l 40 20 0; ", 30 - std::sqrt(140.0)));
}

TEST(CutterRadius, MovesAlongTheNormalKeepThePlace) {
  EXPECT_EQ(path("G41.1 D4 G1 X10\nX20\nZ-5\nY10\nG40 X0\n"), "l 10 2 0; l 18 2 0; l 18 2 -5; l 18 10 -5; l 0 10 -5; ");
  EXPECT_EQ(path("Z5\nG41.1 D4\nZ4\nG1 X10 Z3\nX20 Z2\nG40 Y10\n"),
            "r 0 0 5; r 0 0 4; l 10 2 3; l 20 2 2; l 20 10 2; ");
}

TEST(CutterRadius, TheExitStartsBesideTheContour) {
  // LinuxCNC comes back with the first move of any kind; Fanuc with the first word of the plane.
  EXPECT_EQ(path("G41.1 D4 G1 X10\nX20\nG40\nZ5\nX30\n"), "l 10 2 0; l 20 2 0; l 20 0 5; l 30 0 5; ");
  EXPECT_EQ(path("G41 D4 G1 X10\nX20\nG40\nZ5\nX30\n", fanuc()), "l 10 2 0; l 20 2 0; l 20 2 5; l 30 0 5; ");
  EXPECT_EQ(path("G41.1 D4 G1 X10\nX20\nG40\nG91 X10 Y1\n"), "l 10 2 0; l 20 2 0; l 30 1 0; ");
}

TEST(CutterRadius, InOtherPlanes) {
  const Read g18 = read_text("G18 G0 X0 Y0 Z0\nG41.1 D4 G1 Z10 F100\nZ20\nX10\nG40 Z0\n", as("linuxcnc"));
  // Z, X: left of +Z is +X.
  expect_near_mm(g18.moves.moves[1].end_mm, {2, 0, 10});
  expect_near_mm(g18.moves.moves[2].end_mm, {2, 0, 18});
  expect_near_mm(g18.moves.moves[3].end_mm, {10, 0, 18});
  const Read g19 = read_text("G19 G0 X0 Y0 Z0\nG42.1 D4 G1 Y10 F100\nY20\nZ10\nG40 Y0\n", as("linuxcnc"));
  expect_near_mm(g19.moves.moves[1].end_mm, {0, 10, -2});
  expect_near_mm(g19.moves.moves[2].end_mm, {0, 20, -2});
  EXPECT_EQ(g19.moves.moves[3].kind, MoveKind::arc);
  expect_near_mm(g19.moves.moves[3].end_mm, {0, 22, 0});
  expect_near_mm(g19.moves.arcs[0].normal, Vec3::UnitX());
  EXPECT_NEAR(g19.moves.arcs[0].sweep_rad, kPi / 2, 1e-12);
}

TEST(CutterRadius, RadiusComesFromWhereItIsGiven) {
  const std::string contour = " G1 X10\nX20\nG40 Y20\n";
  EXPECT_EQ(path("G41 D4" + contour, fanuc()), "l 10 2 0; l 20 2 0; l 20 20 0; ");
  EXPECT_EQ(path("G10 L12 P7 R2.5\nG10 L13 P7 R-0.5\nG41 D7" + contour), "l 10 2 0; l 20 2 0; l 20 20 0; ");
  EXPECT_EQ(path("G10 L1 P3 Z50 R2\nT3 M6\nG41" + contour), "l 10 2 0; l 20 2 0; l 20 20 0; ");
  EXPECT_EQ(path("G10 P3 R-2\nG41 D3" + contour), "l 10 -2 0; l 20 -2 0; l 20 20 0; ");
  EXPECT_EQ(path("G20\nG41.1 D0.5 G1 X1\nX2\nG40 Y2\n"), "l 25.4 6.35 0; l 50.8 6.35 0; l 50.8 50.8 0; ");
}

TEST(CutterRadius, WithoutARadiusItIsZeroAndSaysSo) {
  const Read r = read_text("G0 X0 Y0 Z0\nG41 D3 G1 X10 F100\nY10\nG40 X0\n", as("linuxcnc"));
  EXPECT_EQ(r.messages, Messages{"p.nc:2:1: warning: no radius is given for D3; G41 takes 0, as in a program of the "
                                 "cutter centre, where D has the wear only [radius-unknown]"});
  EXPECT_EQ(path_of(r), "r 0 0 0; l 10 0 0; l 10 10 0; l 0 10 0; ");
  for (const Move& m : r.moves.moves) EXPECT_TRUE(m.editable);  // these can be edited
  EXPECT_EQ(read_clean("G0 X0 Y0 Z0\nG41 D0 G1 X10 F100\nG40 X0\n").moves.moves.size(), 3u);
}

TEST(CutterRadius, SaysOnceThatCompensationLeavesTheMoves) {
  const Read r =
      read_text("G0 X0 Y0 Z0\nG41.1 D4 G1 X10 F100\nX20\nG40 Y9\nG42.1 D4 X9\nX0\nG40 Y0\nX5\n", as("linuxcnc"));
  EXPECT_EQ(r.messages, Messages{"p.nc:2:1: warning: the path under G41.1" + kNote});
  std::vector<bool> editable;
  for (const Move& m : r.moves.moves) editable.push_back(m.editable);
  EXPECT_EQ(editable, (std::vector<bool>{true, false, false, false, false, false, false, true}));
}

TEST(CutterRadius, TurnsOverUnderAMirrorImageAndTurnsWithARotation) {
  EXPECT_EQ(path("G51.1 X0\nG41.1 D4 G1 X10\nX20\nG40 Y20\n"), "l -10 2 0; l -20 2 0; l -20 20 0; ");
  EXPECT_EQ(path("G68 X0 Y0 R90\nG41.1 D4 G1 X10\nX20\nG40 Y20\n"), "l -2 10 0; l -2 20 0; l -20 20 0; ");
}

TEST(CutterRadius, TellsWhatDoesNotWork) {
  const auto said = [&](const std::string& place, const std::string& what) {
    return "p.nc:" + place + ": error: G41 with a cutter radius of 2.0000 mm: " + what + " [cutter-radius]";
  };
  EXPECT_EQ(complaint("G41.1 D4 G2 X10 Y0 I5\nG40 G1 X0\n"),
            said("2:1", "compensation begins on an arc; a straight entry move (G0, G1) was expected"));
  EXPECT_EQ(complaint("G41.1 D4 G1 X2\nX20\nG40 Y9\n"),
            said("2:1", "the entry move is 2.0000 mm long; more than the radius was expected"));
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nG3 X21.5 Y1.5 J1.5\nG1 Y20\nG40 X0\n"),
            said("4:1",
                 "the cutter does not fit into the arc of radius 1.5000 mm; a larger arc or a smaller cutter was "
                 "expected"));
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nY3\nX10\nG40 X0\n"),
            said("4:1",
                 "the cutter gouges at the inside corners of this move: they take 4.0000 mm off its offset, which "
                 "is 3.0000 mm long; a longer move or a smaller cutter was expected"));
  EXPECT_EQ(complaint("G41 D4 G1 X10\nX20\nZ1\nZ2\nY10\nG40 X0\n", fanuc()),
            said("6:1",
                 "2 moves without motion in the plane stand before this one; the control looks 1 ahead and would "
                 "gouge, at most 1 was expected"));
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nG3 X30 Y15 J10 L1\nG1 Y30\nG40 X0\n"),
            said("4:1", "a spiral has no offset of the same kind; an arc or a line was expected"));
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nM30\n"),
            "p.nc:2:1: error: G41 is never cancelled; G40 with a straight move off the contour was expected before the "
            "end [cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nG18\nX20\nG40 Y9\n"),
            "p.nc:3:1: error: G18 changes the plane under G41; G40 was expected before [cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nG55 X20\nG40 Y9\n"),
            "p.nc:3:1: error: G55 changes the work offset under G41; G40 was expected before [cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nG52 X20\nG40 Y9\n"),
            "p.nc:3:1: error: G52 under G41; G40 was expected before [cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nG42.1 D4 X20\nG40 Y9\n"),
            "p.nc:3:1: error: G42.1 while G41 is active; G40 was expected before [cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nG91 G28 Z0\n"),
            "p.nc:4:1: error: G28 under G41; G40 with a straight move off the contour was expected before "
            "[cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nG81 X30 Z-1 R1\n"),
            "p.nc:4:1: error: a drilling cycle under G41; G40 with a straight move off the contour was expected before "
            "[cutter-radius]");
  EXPECT_EQ(complaint("G41.1 D4 G1 X10\nX20\nG40\nG2 X30 Y0 I5\n"),
            "p.nc:5:1: error: the move off the contour after G40 is an arc (G2); a straight move (G0, G1) was expected "
            "[cutter-radius]");
  EXPECT_EQ(complaint("G41.1 X10\n"), "p.nc:2:1: error: G41.1 has no diameter; D was expected [cutter-radius]");
  EXPECT_EQ(
      complaint("G41 D1.5 X10\n"),
      "p.nc:2:5: error: D1.5 is not an offset number; a whole number of zero or more was expected [cutter-radius]");
  InterpreterOptions normal_direction = fanuc();
  EXPECT_EQ(complaint("G41.1 X10\n", normal_direction),
            "p.nc:2:1: error: G41.1 (normal direction control) is not supported [not-read]");
}

TEST(CutterRadius, EmissionLeavesTheContourAlone) {
  const std::string text = "G0 X0 Y0 Z0\nG1 X5 F100\nG41.1 D4 G1 X15\nX25\nY10\nG40 X0\nG1 X-5\n";
  const Read r = read_text(text, as("linuxcnc"));
  std::vector<MoveEdit> edits;
  for (std::uint32_t i = 1; i < r.moves.moves.size(); ++i)
    edits.push_back({.move = i, .end_mm = r.moves.moves[i].end_mm + Vec3(0, 0.01, 0)});
  EXPECT_EQ(emit(r.program, r.moves, edits, {}),
            "G0 X0 Y0 Z0\nG1 X5 Y0.01 F100\nG41.1 D4 G1 X15\nX25\nY10\nG40 X0\nG1 X-5 Y10.01\n");
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), text);
}

// --- by a second method ---------------------------------------------------------------------------------------------

std::vector<Vec3> sampled(const Interpretation& moves, std::size_t first, std::size_t end, double step_mm) {
  std::vector<Vec3> out;
  for (std::size_t m = first; m < end; ++m) {
    const int n = std::max(1, static_cast<int>(length_mm(moves, moves.moves[m]) / step_mm));
    for (int i = 0; i <= n; ++i) out.push_back(point_at(moves, moves.moves[m], static_cast<double>(i) / n));
  }
  return out;
}

/// A closed chain of gentle lines and arcs that never comes near itself: a spiral outwards with corners.
std::string open_contour(std::mt19937& random, const char* g) {
  std::uniform_real_distribution<double> u(0, 1);
  std::string text = fmt::format("{} G1 X10 Y0\nX20\n", g);
  double x = 20, y = 0;
  for (int i = 0; i < 8; ++i) {
    const double nx = x + 12 + 6 * u(random), ny = 20 * (u(random) - 0.5);
    const double chord = std::hypot(nx - x, ny - y);
    if (random() % 2 == 0)
      text += fmt::format("G1 X{:.6f} Y{:.6f}\n", nx, ny);
    else
      text += fmt::format("G{} X{:.6f} Y{:.6f} R{:.6f}\n", 2 + random() % 2, nx, ny, chord * (0.6 + u(random)));
    x = nx;
    y = ny;
  }
  return text + fmt::format("G40 G1 X{:.6f} Y60\n", x + 40);
}

TEST(CutterRadius, KeepsItsDistanceToTheContour) {
  // Every point of the path lies one radius from the programmed contour: no less anywhere, and no more but at the
  // drawn-out corners of the Fanuc kind. Sampled every 0.05 mm: the nearest sample may be off by
  // step^2 / (8 R) = 0.0002 mm.
  std::mt19937 random(77);
  constexpr double kRadius = 2, kStep = 0.05, kTolerance = 5e-4;
  int contours = 0;
  for (int i = 0; i < 40; ++i) {
    const bool lines = i % 2 == 1;
    const std::string contour = open_contour(random, i % 4 < 2 ? "G41 D4" : "G42 D4");
    InterpreterOptions o = fanuc();
    o.dialect = *dialect_named("fanuc");
    o.dialect->radius_corner_lines = lines;
    o.dialect->radius_entry_square = false;
    const Read path = read_text("G0 X0 Y0 Z0 F100\n" + contour, o);
    o.tool_offsets[4].radius_mm = 0;
    const Read programmed = read_text("G0 X0 Y0 Z0 F100\n" + contour, o);
    if (path.diagnostics.has_errors() || path.moves.moves.empty()) continue;
    ++contours;
    // Without the entry's and the exit's run.
    const auto on_path = sampled(path.moves, 2, path.moves.moves.size() - 1, 0.5);
    const auto on_contour = sampled(programmed.moves, 1, programmed.moves.moves.size() - 1, kStep);
    for (const Vec3& p : on_path) {
      double nearest = 1e9;
      for (const Vec3& q : on_contour) nearest = std::min(nearest, (p - q).norm());
      ASSERT_GE(nearest, kRadius - kTolerance) << contour << p.transpose();
      ASSERT_LE(nearest, (lines ? kRadius * std::sqrt(2.0) + 1e-3 : kRadius) + kTolerance) << contour << p.transpose();
    }
    for (std::size_t m = 1; m < path.moves.moves.size(); ++m)
      expect_near_mm(path.moves.moves[m].start_mm, path.moves.moves[m - 1].end_mm);
  }
  EXPECT_GE(contours, 15);
}

}  // namespace
}  // namespace camber::nc
