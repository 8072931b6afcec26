#include "nc/move.h"

#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

constexpr double kStep = 1e-6;  ///< of the differences that check directions

TEST(Move, LengthOfLinesArcsHelicesAndSeveralTurns) {
  const Read r = read_clean(
      "G17 G0 X0 Y0 Z0\nG1 X3 Y4 F100\nG0 X10 Y0\nG3 X0 Y10 I-10\nG0 X10 Y0\nG3 X10 Y0 Z30 I-10 J0 P2\nG4 P1\n");
  const auto& m = r.moves.moves;
  EXPECT_NEAR(length_mm(r.moves, m[1]), 5, 1e-12);
  EXPECT_NEAR(length_mm(r.moves, m[3]), 5 * kPi, 1e-9);
  EXPECT_NEAR(length_mm(r.moves, m[5]), std::hypot(40 * kPi, 30), 1e-9);
  EXPECT_EQ(length_mm(r.moves, m[6]), 0);
}

TEST(Move, PointsLieOnTheArcAndMeetBothEnds) {
  const Read r = read_clean("G18 G0 X10 Y0 Z0\nG2 X0 Z10 I-10 K0 Y4 F100\n");
  const Move& m = r.moves.moves[1];
  EXPECT_EQ(point_at(r.moves, m, 0), m.start_mm);
  EXPECT_EQ(point_at(r.moves, m, 1), m.end_mm);
  for (double u = 0; u <= 1; u += 0.125) {
    const Vec3 p = point_at(r.moves, m, u);
    EXPECT_NEAR(std::hypot(p.x(), p.z()), 10, 1e-9);
    EXPECT_NEAR(p.y(), 4 * u, 1e-9);
  }
}

TEST(Move, DirectionIsTheDerivativeOfThePoint) {
  const Read r = read_clean("G19 G0 X0 Y10 Z0\nG2 Y0 Z10 X5 J-10 K0 F100\nG1 X9 Y9 Z9\n");
  for (std::size_t i = 1; i < r.moves.moves.size(); ++i) {
    const Move& m = r.moves.moves[i];
    for (double u = 0.1; u < 1; u += 0.2) {
      const Vec3 difference = point_at(r.moves, m, u + kStep) - point_at(r.moves, m, u - kStep);
      expect_near_mm(direction_at(r.moves, m, u), difference.normalized(), 1e-6);
    }
  }
}

TEST(Move, AMoveWithoutLengthHasNoDirection) {
  const Read r = read_clean("G0 X1 Y1 Z1\nG0 X1\n");
  EXPECT_TRUE(direction_at(r.moves, r.moves.moves[1], 0.5).isZero());
}

}  // namespace
}  // namespace camber::nc
