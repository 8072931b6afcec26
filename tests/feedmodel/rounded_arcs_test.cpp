// Arcs whose two radii differ by what the decimals of a program leave.
#include <gtest/gtest.h>

#include <cmath>

#include "feedmodel/path_tracker.h"
#include "feedmodel/segment.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

/// Half turns as CAM writes a small bore in inches with four decimals: 0.0138 and 0.0137 from the centre.
nc::Interpretation rounded_bore() {
  tests::TestProgram p;
  const double left = 25.4 * -0.0137, right = 25.4 * 0.0138;
  p.rapid(right, 0, 0);
  for (int i = 0; i < 6; ++i) p.arc_xy(left, 0, 0, 0, kPi, 600).arc_xy(right, 0, 0, 0, kPi, 600);
  return p.program;
}

/// Axes that follow the command without any lag.
machine::Machine exact_machine() {
  machine::Machine m;
  m.control.corner.law = machine::CornerLaw::blend;
  m.control.corner.tolerance_mm = 0.01;
  for (machine::Axis& axis : m.axis) axis.acceleration_mm_per_s2 = 500;
  return m;
}

TEST(RoundedArcs, LeaveNoContourErrorWithoutLag) {
  const nc::Interpretation program = rounded_bore();
  PathTracker tracker(program);
  double farthest_mm = 0, longest_step_mm = 0;
  Vec3 last = program.moves.front().end_mm;
  bool cutting = false;
  predict_feed(program, exact_machine(), [&](std::span<const TimedSample> run) {
    for (const TimedSample& s : run) {
      if (cutting) longest_step_mm = std::max(longest_step_mm, (s.position_mm - last).norm());
      cutting = cutting || s.move > 0;
      last = s.position_mm;
      farthest_mm = std::max(farthest_mm, tracker(s).distance_mm);
    }
  });
  EXPECT_LT(farthest_mm, 1e-7);
  EXPECT_LT(longest_step_mm, 10.1 / 1000);  // 10 mm/s for a millisecond: no jump of 2.5 um from arc to arc
}

TEST(RoundedArcs, TurnNoCornerAndEndWhereTheNextBegins) {
  const double growth = -0.00254;
  const Segment arc = arc_segment({0.35, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), kPi, -0.1, growth);
  EXPECT_NEAR(arc.point_at(arc.length_mm).x(), -(0.35 + growth), 1e-12);
  EXPECT_NEAR(arc.point_at(arc.length_mm).z(), -0.1, 1e-12);
  for (const double u : {0.0, 0.3, 1.0}) {
    const Vec3 d = arc.direction_at(u * arc.length_mm);
    EXPECT_NEAR(d.norm(), 1, 1e-12);
    EXPECT_NEAR(d.x(), -arc.in_plane() * std::sin(kPi * u), 1e-12);
  }
  const Segment rest = part_of(arc, 0.4 * arc.length_mm, arc.length_mm);
  EXPECT_NEAR((rest.point_at(rest.length_mm) - arc.point_at(arc.length_mm)).norm(), 0, 1e-12);
}

TEST(RoundedArcs, EvenArcsAreAsTheyWere) {
  const Segment arc = arc_segment({2, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), 1.5, 0.3, 1e-12);
  EXPECT_EQ(arc.radius_growth, 0);
  EXPECT_EQ(arc.length_mm, std::hypot(3.0, 0.3));
}

}  // namespace
}  // namespace camber::feedmodel
