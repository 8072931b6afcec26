// ,R ,C and ,A at the end of a block: closed forms, other planes, frames, increments, G41.
#include <cmath>

#include <fmt/format.h>

#include "tests/nc/macro_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

double cut_mm(const Read& r) {
  double sum = 0;
  for (const Move& m : r.moves.moves)
    if (m.feed_mm_per_s > 0) sum += length_mm(r.moves, m);
  return sum;
}

double cut_mm(const std::string& text, std::string_view dialect = "fanuc") {
  return cut_mm(read_clean("G21 G90 G17 F500.\nG0 X0. Y0. Z0.\n" + text, as(dialect)));
}

std::string said_of(const std::string& text, std::string_view dialect = "fanuc") {
  const Read r = read_text("G21 G90 G17 F500.\nG0 X0. Y0. Z0.\n" + text, as(dialect));
  return r.messages.empty() ? "" : r.messages.front();
}

constexpr double kRoot2 = 1.4142135623730951;

TEST(CornerWords, RoundAndChamferTheCornerWithTheNextBlock) {
  for (const char* dialect : {"fanuc", "haas", "mazak"}) {
    const Read r =
        read_clean("G21 G90 G17\nG0 X0. Y0. Z0.\nG1 X20. ,R5. F500.\nG1 Y20. ,C2.\nG1 X0.\nM30\n", as(dialect));
    EXPECT_NEAR(cut_mm(r), 15 + 2.5 * kPi + 13 + 2 * kRoot2 + 18, 1e-9);
    EXPECT_EQ(ends_of(r), "0 0 0; 15 0 0; 20 5 0; 20 18 0; 18 20 0; 0 20 0");
    EXPECT_EQ(r.moves.moves[2].kind, MoveKind::arc);
    expect_near_mm(r.moves.arcs[0].center_mm, {15, 5, 0});
    EXPECT_NEAR(r.moves.arcs[0].sweep_rad, kPi / 2, 1e-12);
    for (std::size_t m = 1; m < r.moves.moves.size(); ++m) {
      EXPECT_EQ(r.moves.moves[m].start_mm, r.moves.moves[m - 1].end_mm);
      EXPECT_NEAR(r.moves.moves[m].feed_mm_per_s * 60, 500, 1e-9);
    }
  }
}

TEST(CornerWords, ACornerThatTurnsByTHasAnArcOfRTimesT) {
  for (const double turn : {20.0, 60.0, 90.0, 135.0, -30.0, -120.0}) {
    const double t = turn * kPi / 180, size = 3;
    const std::string second = fmt::format("G1 X{:.9f} Y{:.9f}\n", 50 + 40 * std::cos(t), 40 * std::sin(t));
    const double cut = size * std::tan(std::abs(t) / 2);
    EXPECT_NEAR(cut_mm("G1 X50. ,R3.\n" + second), 90 - 2 * cut + size * std::abs(t), 1e-6) << turn;
    EXPECT_NEAR(cut_mm("G1 X50. ,C3.\n" + second), 90 - 2 * size + 2 * size * std::cos(t / 2), 1e-6) << turn;
  }
}

/// Line and arc, arc and line, arc and arc: the rounding touches both, which is its definition.
TEST(CornerWords, RoundingsTouchLinesAndArcs) {
  const struct {
    const char* text;
    double radius_mm;
  } pairs[] = {
      {"G1 X20. ,R2.\nG3 X30. Y10. I10. J0.\n", 2},          // up to an arc that begins square
      {"G1 X20. ,R2.\nG2 X30. Y10. R10.\n", 2},              // the other sense
      {"G2 X20. Y0. R12. ,R2.\nG1 X20. Y30.\n", 2},          // arc, then line
      {"G3 X20. Y0. R12. ,R2.\nG1 X40. Y10.\n", 2},          // arc, then line
      {"G2 X20. Y0. R12. ,R1.5\nG2 X40. Y0. R12.\n", 1.5},   // two bows
      {"G3 X20. Y0. R12. ,R1.5\nG2 X40. Y0. R12.\n", 1.5},   // opposite senses
      {"G2 X20. Y0. R12. ,R1.5\nG3 X40. Y10. R15.\n", 1.5},  // likewise
  };
  for (const auto& [pair, radius_mm] : pairs) {
    SCOPED_TRACE(pair);
    const Read r = read_clean(std::string("G21 G90 G17 F500.\nG0 X0. Y0. Z0.\n") + pair, as("fanuc"));
    ASSERT_EQ(r.moves.moves.size(), 4u);
    const Move& corner = r.moves.moves[2];
    ASSERT_EQ(corner.kind, MoveKind::arc);
    const double radius = (corner.start_mm - r.moves.arcs[corner.arc].center_mm).norm();
    EXPECT_NEAR(radius, radius_mm, 1e-9);
    EXPECT_LT(std::abs(r.moves.arcs[corner.arc].sweep_rad), kPi);
    for (const std::size_t m : {2u, 3u}) {
      const Vec3 before = direction_at(r.moves, r.moves.moves[m - 1], 1),
                 behind = direction_at(r.moves, r.moves.moves[m], 0);
      EXPECT_NEAR(before.dot(behind), 1, 1e-9);
      EXPECT_EQ(r.moves.moves[m].start_mm, r.moves.moves[m - 1].end_mm);
    }
    // The shortened arcs still end where they say.
    for (const Move& m : r.moves.moves)
      if (m.kind == MoveKind::arc) expect_near_mm(point_at(r.moves, m, 0.999999999), m.end_mm, 1e-5);
  }
}

TEST(CornerWords, ChamferBetweenLineAndArcTakesItsLengthOffBoth) {
  const Read r = read_clean("G21 G90 G17 F500.\nG0 X0. Y0. Z0.\nG1 X20. ,C2.\nG3 X30. Y10. I10. J0.\n", as("fanuc"));
  ASSERT_EQ(r.moves.moves.size(), 4u);
  const Vec3 corner(20, 0, 0);
  EXPECT_NEAR((r.moves.moves[2].start_mm - corner).norm(), 2, 1e-9);
  EXPECT_NEAR((r.moves.moves[2].end_mm - corner).norm(), 2, 1e-9);
  EXPECT_NEAR((r.moves.moves[2].end_mm - Vec3(30, 0, 0)).norm(), 10, 1e-9);
}

TEST(CornerWords, InOtherPlanesIncrementsInchesAndFrames) {
  EXPECT_NEAR(cut_mm("G18 G1 Z-20. ,R5.\nX20.\n"), 30 + 2.5 * kPi, 1e-9);
  EXPECT_NEAR(cut_mm("G19 G1 Y20. ,R5.\nZ-20.\n"), 30 + 2.5 * kPi, 1e-9);
  // Increments of the next block, and its I J, count from the corner that is not cut.
  EXPECT_NEAR(cut_mm("G91 G1 X20. ,R5.\nY20. ,C2.\nX-20.\n"), 15 + 2.5 * kPi + 13 + 2 * kRoot2 + 18, 1e-9);
  const Read r = read_clean("G21 G90 G17 F500.\nG0 X0. Y0. Z0.\nG91 G1 X20. ,R5.\nY20.\nX5.\n", as("fanuc"));
  expect_near_mm(r.moves.moves.back().end_mm, {25, 20, 0});
  EXPECT_NEAR(cut_mm("G20 G1 X2. ,R.5\nY2.\n"), 25.4 * (3 + 0.25 * kPi), 1e-9);
  EXPECT_NEAR(cut_mm("G68 X0. Y0. R30.\nG1 X20. ,R5.\nY20.\n"), 30 + 2.5 * kPi, 1e-9);
  EXPECT_NEAR(cut_mm("G51.1 X0.\nG1 X20. ,R5.\nY20.\n"), 30 + 2.5 * kPi, 1e-9);
  EXPECT_NEAR(cut_mm("G51 X0. Y0. Z0. P2.\nG1 X20. ,R5.\nY20.\n"), 2 * (30 + 2.5 * kPi), 1e-9);
  EXPECT_NEAR(cut_mm("#1=5.\nG1 X20. ,R#1\nY20.\n"), 30 + 2.5 * kPi, 1e-9);
}

TEST(CornerWords, FollowOneAnotherAndLetOtherBlocksStandBetween) {
  const double corner = 2.5 * kPi;
  EXPECT_NEAR(cut_mm("G1 X20. ,R5.\nY20. ,R5.\nX0. ,R5.\nY5.\n"), 15 + 10 + 10 + 10 + 3 * corner, 1e-9);
  EXPECT_NEAR(cut_mm("G1 X20. ,R5.\nG4 P100\nY20.\n"), 30 + corner, 1e-9);
  EXPECT_NEAR(cut_mm("G1 X20. ,R5.\n(a comment)\nM8\nY20.\n"), 30 + corner, 1e-9);
  EXPECT_NEAR(cut_mm("G1 X20. ,R5.\nX40.\n"), 40, 1e-9);  // no corner
  EXPECT_NEAR(cut_mm("G1 X20. ,R0.\nY20.\n"), 40, 1e-9);
  EXPECT_NEAR(cut_mm("G1 X20. , R 5. \nY20.\n"), 30 + corner, 1e-9);
  EXPECT_NEAR(cut_mm("G1,R5.X20.\nY20.\n"), 30 + corner, 1e-9);
}

/// The control rounds the contour, then keeps the cutter beside it: inside, the rounding has its radius less the
/// cutter's.
TEST(CornerWords, AreCompensatedUnderG41) {
  const Read r = read_text(
      "G21 G90 G17 F500.\nG10 L12 P1 R2.\nG0 X-10. Y-10. Z0.\nG41 D1 G1 Y0.\nX20. ,R5.\nY20.\nG40 G1 Y30.\nM30\n",
      as("fanuc"));
  double arc_mm = 0;
  for (const Move& m : r.moves.moves)
    if (m.kind == MoveKind::arc) arc_mm += length_mm(r.moves, m);
  EXPECT_NEAR(arc_mm, 3 * kPi / 2, 1e-9);
}

TEST(CornerWords, AngleGivesTheOtherCoordinate) {
  const Read r = read_clean("G21 G90 G17 F500.\nG0 X0. Y0. Z0.\nG1 X20. ,A30.\nY0. ,A-45.\n", as("fanuc"));
  expect_near_mm(r.moves.moves[1].end_mm, {20, 20 * std::tan(kPi / 6), 0});
  expect_near_mm(r.moves.moves[2].end_mm, {20 + 20 * std::tan(kPi / 6), 0, 0});
  EXPECT_NEAR(cut_mm("G1 X20. ,A0. ,R5.\nY20.\n"), 30 + 2.5 * kPi, 1e-9);
}

TEST(CornerWords, SayWhatIsWrong) {
  EXPECT_EQ(said_of("G1 X20. ,R5.\nG0 Y20.\n"),
            "p.nc:3:9: error: ,R5. is not followed by a line or an arc of its kind; G1, G2 or G3 in the plane was "
            "expected [corner-word]");
  EXPECT_EQ(said_of("G1 X20. ,R5.\nM30\n"),
            "p.nc:3:9: error: ,R5. is not followed by a further move; G1, G2 or G3 was expected [corner-word]");
  EXPECT_EQ(said_of("G1 X20. ,R25.\nY20.\n"),
            "p.nc:3:9: error: ,R25. takes 25.0000 mm off the first move, which is 20.0000 mm long; a longer move was "
            "expected [corner-word]");
  EXPECT_EQ(said_of("G0 X20. ,R5.\nG1 Y20.\n"),
            "p.nc:3:9: error: ,R5. in a block without a cut; G1, G2 or G3 was expected [corner-word]");
  EXPECT_EQ(said_of("G1 X20. ,R5. ,C2.\nY20.\n"),
            "p.nc:3:14: error: ,R5. and ,C2. in one block; one of them was expected [corner-word]");
  EXPECT_EQ(said_of("G1 X20. ,R5.\nY20. Z-1.\n"),
            "p.nc:3:9: error: ,R5. beside a move that leaves the plane G17; two moves in it were expected "
            "[corner-word]");
  EXPECT_EQ(
      said_of("G1 X20. ,R5.\nY20.\n", "linuxcnc"),
      "p.nc:3:9: error: ,R5. is no word of a LinuxCNC program; a letter and a number were expected [corner-word]");
  EXPECT_EQ(said_of("G1 X20. ,Q5.\nY20.\n"),
            "p.nc:3:9: error: a comma and `Q`; ,R (rounding), ,C (chamfer) or ,A (angle) was expected [corner-word]");
  EXPECT_EQ(said_of("G1 X20. ,R\nY20.\n"), "p.nc:3:9: error: ,R has no number; a number was expected [no-number]");
  EXPECT_EQ(said_of("G1 X20. Y20. ,A45.\n"),
            "p.nc:3:14: error: ,A in a block with both of X and Y; one of them was expected [corner-word]");
}

}  // namespace
}  // namespace camber::nc
