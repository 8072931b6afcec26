#include "nc/arcs.h"

#include <cmath>
#include <random>

#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

TEST(Arcs, MoreThanHalfATurnByANegativeRadius) {
  ArcWords w{.start_mm = {10, 0, 0}, .end_mm = {0, 10, 0}, .plane = Plane::xy, .clockwise = false};
  w.r_mm = 10.0;
  expect_near_mm(make_arc(w).arc.center_mm, {0, 0, 0});
  EXPECT_NEAR(make_arc(w).arc.sweep_rad, kPi / 2, 1e-12);
  w.r_mm = -10.0;
  expect_near_mm(make_arc(w).arc.center_mm, {10, 10, 0});
  EXPECT_NEAR(make_arc(w).arc.sweep_rad, 1.5 * kPi, 1e-12);
  w.clockwise = true;
  expect_near_mm(make_arc(w).arc.center_mm, {0, 0, 0});
  EXPECT_NEAR(make_arc(w).arc.sweep_rad, -1.5 * kPi, 1e-12);
}

/// The ends of a spiral in one direction from its centre: a full turn, on whatever side of zero the angle is rounded.
TEST(Arcs, ASpiralWhoseEndsLieInOneDirectionIsAFullTurn) {
  for (int degrees = 0; degrees < 360; degrees += 7)
    for (const bool clockwise : {false, true}) {
      const double angle = degrees * kPi / 180;
      const Vec3 out(std::cos(angle), std::sin(angle), 0);
      ArcWords w{.start_mm = 10 * out, .end_mm = 13 * out, .plane = Plane::xy, .clockwise = clockwise};
      w.i_mm = -10 * out.x(), w.j_mm = -10 * out.y();
      w.spiral = true;
      EXPECT_NEAR(make_arc(w).arc.sweep_rad, (clockwise ? -2 : 2) * kPi, 1e-9) << degrees;
      w.turns = 2;
      EXPECT_NEAR(make_arc(w).arc.sweep_rad, (clockwise ? -4 : 4) * kPi, 1e-9) << degrees;
    }
}

TEST(Arcs, AChordThatMissesTheDiameterByLittleIsHalfATurn) {
  ArcWords w{.start_mm = {0, 0, 0}, .end_mm = {20.008, 0, 0}, .plane = Plane::xy, .clockwise = true};
  w.r_mm = 10.0;
  const ArcResult half = make_arc(w);
  EXPECT_EQ(half.error, "");
  EXPECT_NEAR(half.arc.sweep_rad, -kPi, 1e-9);
  w.end_mm = {20.02, 0, 0};
  EXPECT_EQ(make_arc(w).error,
            "the end of the arc is 20.0200 mm from its start; with R 10.0000 mm at most 20.0000 mm can be reached");
}

TEST(Arcs, WordsThatMakeNoArcAreNamed) {
  ArcWords w{.start_mm = {0, 0, 0}, .end_mm = {1, 0, 0}, .plane = Plane::zx};
  EXPECT_EQ(make_arc(w).error, "the arc has neither a centre nor a radius; I J K or R was expected");
  w.i_mm = 1.0;
  w.j_mm = 2.0;
  EXPECT_EQ(make_arc(w).error, "J does not belong to an arc in this plane; I and K were expected");
  w.j_mm.reset();
  w.r_mm = 1.0;
  EXPECT_EQ(make_arc(w).error, "the arc has both R and a centre (I J K); one of them was expected");
  w.i_mm.reset();
  w.end_mm = w.start_mm;
  EXPECT_EQ(make_arc(w).error,
            "an arc with R ends where it starts, which leaves its centre open; an arc by its centre was expected for a "
            "full turn");
}

/// Any arc, by its centre and by its radius, in every plane: the same circle, the same way round.
TEST(Arcs, CentreAndRadiusAgreeInAllPlanes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-50, 50), angle(-kPi, kPi), sweeps(0.05, 2 * kPi - 0.05), radii(0.5, 30);
  for (int i = 0; i < 3000; ++i) {
    const Plane plane = static_cast<Plane>(i % 3);
    const PlaneAxes axes = axes_of(plane);
    const double radius = radii(random), from = angle(random), sweep = sweeps(random) * (i % 2 ? 1 : -1);
    if (std::abs(std::abs(sweep) - kPi) < 0.01) continue;  // half a turn: R leaves the side open
    Vec3 centre(place(random), place(random), place(random));
    ArcWords w{.plane = plane, .clockwise = sweep < 0};
    w.start_mm = w.end_mm = centre;
    w.start_mm[axes.first] += radius * std::cos(from);
    w.start_mm[axes.second] += radius * std::sin(from);
    w.end_mm[axes.first] += radius * std::cos(from + sweep);
    w.end_mm[axes.second] += radius * std::sin(from + sweep);
    w.end_mm[axes.normal] += place(random);
    ArcWords by_radius = w;
    by_radius.r_mm = std::abs(sweep) > kPi ? -radius : radius;
    const Vec3 offset = centre - w.start_mm;
    w.i_mm = offset.x();
    w.j_mm = offset.y();
    w.k_mm = offset.z();
    const ArcResult a = make_arc(w), b = make_arc(by_radius);
    ASSERT_EQ(a.error + b.error, "");
    EXPECT_NEAR(a.arc.sweep_rad, sweep, 1e-9);
    EXPECT_NEAR(b.arc.sweep_rad, sweep, 1e-6);
    expect_near_mm(a.arc.center_mm, centre);
    expect_near_mm(b.arc.center_mm, centre, 1e-6);
  }
}

}  // namespace
}  // namespace camber::nc
