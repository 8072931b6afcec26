// The parts of an error whose truth is known.
#include "compensate/error_split.h"

#include <cmath>

#include <gtest/gtest.h>

#include "compensate/gouge_guard.h"
#include "compensate/sensitivity.h"
#include "removal/form_error.h"

namespace camber::compensate {
namespace {

constexpr double kEnds_um = 0.15;  // the chain's first point is fixed and the fit smooth

nc::Interpretation line_program(int n) {
  nc::Interpretation p;
  p.states.emplace_back();
  for (int i = 0; i < n; ++i) {
    nc::Move m;
    m.kind = nc::MoveKind::linear;
    m.start_mm = {static_cast<double>(i), 0, 0};
    m.end_mm = {i + 1.0, 0, 0};
    m.block = static_cast<std::uint32_t>(i);
    p.moves.push_back(m);
  }
  return p;
}

struct Wall {
  nc::Interpretation program = line_program(40);
  ShiftPath path{program, std::vector<bool>(40, true), 1.0};
  Observed observed;

  /// A wall that faces +Y, from x = 2 on, ten points high.
  void add(auto error_of, const Vec3& normal = Vec3::UnitY()) {
    for (int i = 2; i < 40; ++i)
      for (int k = 0; k < 10; ++k)
        for (double u = 0.1; u < 1; u += 0.2) {
          Observation o;
          o.place = path.find(static_cast<std::uint32_t>(i), u);
          o.normal = normal;
          o.error_mm = error_of(i + u, 0.1 * k + 0.05);
          o.area_mm2 = 0.02;
          observed.points.push_back(o);
          observed.compensated.push_back(true);
        }
  }
};

TEST(ErrorSplit, AnEvenErrorIsCorrectable) {
  Wall wall;
  wall.add([](double, double) { return 0.01; });
  const ErrorSplit s = split_error(wall.path, wall.observed, {});
  EXPECT_NEAR(s.correctable_um, 10, kEnds_um);
  EXPECT_LT(s.not_correctable_um(), 1.0);
}

TEST(ErrorSplit, WhatVariesAlongTheCutterIsBow) {
  Wall wall;  // the best constant shift leaves a line's rms: range / sqrt(12)
  wall.add([](double, double height) { return 0.01 + 0.006 * (height - 0.5); });
  const ErrorSplit s = split_error(wall.path, wall.observed, {});
  EXPECT_NEAR(s.correctable_um, 10, kEnds_um);
  EXPECT_NEAR(s.bow_um, 6 * std::sqrt((1 - 0.01) / 12), 0.05);
  EXPECT_NEAR(s.opposed_um, 0, 1e-6);
}

TEST(ErrorSplit, BothSidesOfASlotAreOpposed) {
  Wall wall;  // material left on both sides: no shift helps
  wall.add([](double, double) { return 0.01; });
  wall.add([](double, double) { return 0.01; }, -Vec3::UnitY());
  for (auto& o : wall.observed.points) o.opposed = true;  // as observe() finds them
  const ErrorSplit s = split_error(wall.path, wall.observed, {});
  EXPECT_NEAR(s.opposed_um, 10, 0.05);
  EXPECT_LT(s.correctable_um, 0.5);
}

TEST(ErrorSplit, SaysWhatTheLimitHoldsBack) {
  Wall wall;
  wall.add([](double, double) { return 0.01; });
  const ErrorSplit s = split_error(wall.path, wall.observed, {.max_shift_mm = 0.004});
  EXPECT_NEAR(s.correctable_um, std::sqrt(10 * 10 - 6 * 6), 0.3);
  EXPECT_NEAR(s.limited_um, 6, 0.3);
}

TEST(ErrorSplit, SquaresAddUpWithOtherMoves) {
  Wall wall;
  wall.add([](double x, double height) { return 0.01 * std::sin(x) + 0.004 * height; });
  for (std::size_t i = 0; i < wall.observed.points.size(); i += 3) wall.observed.compensated[i] = false;
  double sum = 0, area = 0;
  for (const auto& o : wall.observed.points) {
    sum += o.area_mm2 * o.error_mm * o.error_mm;
    area += o.area_mm2;
  }
  const ErrorSplit s = split_error(wall.path, wall.observed, {});
  EXPECT_GT(s.not_compensated_um, 1);
  EXPECT_NEAR(std::sqrt(s.correctable_um * s.correctable_um + s.limited_um * s.limited_um +
                        s.not_correctable_um() * s.not_correctable_um() + s.not_compensated_um * s.not_compensated_um),
              1000 * std::sqrt(sum / area), 1e-6);
}

TEST(ErrorSplit, TheGuardGetsWhatIsLeftBeyondTheBestWithoutIt) {
  ErrorSplit lifted{.correctable_um = 5}, lower{.correctable_um = 2};
  lifted.give_to_guard(3);
  EXPECT_NEAR(lifted.correctable_um, 3, 1e-12);
  EXPECT_NEAR(lifted.guard_um, 4, 1e-12) << "squares add up";
  lower.give_to_guard(3);
  EXPECT_NEAR(lower.correctable_um, 2, 1e-12);
  EXPECT_NEAR(lower.guard_um, 0, 1e-12);
}

/// The surface after rounds of the guard: it follows the shift, to which each round adds its lifts.
Observed guarded(Wall& wall, double limit_mm, double reach_mm) {
  Guard guard(wall.path, limit_mm, reach_mm);
  Observed now = wall.observed;
  const auto deepest = [&] {
    double out = 0;
    for (const auto& o : now.points) out = std::max(out, -o.error_mm);
    return out;
  };
  for (int round = 0; round < 6 && deepest() > limit_mm; ++round) {
    guard.clear();
    guard.learn(now, deepest());
    std::vector<Observation> wanted = now.of_path();
    guard.apply_to(wanted);
    fit_lifts(wall.path, wanted, {});
    for (std::size_t i = 0; i < now.points.size(); ++i)
      now.points[i].error_mm =
          wall.observed.points[i].error_mm + now.points[i].normal.dot(wall.path.shift_at(now.points[i].place));
  }
  return now;
}

double min_depth_mm(const Observed& observed) {
  double out = 0;
  for (const auto& o : observed.points) out = std::min(out, o.error_mm);
  return out;
}

TEST(Guard, LiftsWhatLiesTooDeepAndNoFartherThanAskedFor) {
  Wall wall;
  wall.add([](double, double height) { return 0.010 * (height - 0.5); });  // -4.5 ... 4.5 um
  const double least = min_depth_mm(guarded(wall, 0.002, 2));
  EXPECT_GE(least, -0.002);
  EXPECT_LT(least, -0.0005);
}

TEST(Guard, LiftsWithoutSpikes) {
  constexpr double kReach_mm = 5, kDeep_mm = 0.014, kLimit_mm = 0.003;
  Wall wall;  // one place bows, the rest is exact
  wall.add([](double x, double height) { return std::abs(x - 20.5) < 0.5 ? kDeep_mm * (height - 0.5) / 0.45 : 0.0; });
  EXPECT_GE(min_depth_mm(guarded(wall, kLimit_mm, kReach_mm)), -kLimit_mm);
  const auto& points = wall.path.points();
  // cos^2 falls by no more than pi / 2 of its height over the reach; the fit smooths it further.
  constexpr double kSteepest = kPi / 2 * kDeep_mm / kReach_mm;
  double highest = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = (points[i].shift_mm - points[i - 1].shift_mm).norm();
    EXPECT_LE(step, 1.05 * kSteepest * (points[i].place_mm - points[i - 1].place_mm).norm()) << i;
    highest = std::max(highest, points[i].shift_mm.y());
  }
  EXPECT_GE(highest, kDeep_mm - kLimit_mm);
  EXPECT_LE(highest, kDeep_mm);
  EXPECT_NEAR(points[10].shift_mm.norm(), 0, 1e-4) << "ten millimetres away";
}

TEST(Guard, LeavesTheRestOfThePathAsItIs) {
  Wall wall;  // one place is too deep, the rest has excess material, which is not the guard's business
  wall.add([](double x, double) { return std::abs(x - 20.5) < 0.5 ? -0.010 : 0.004; });
  EXPECT_GE(min_depth_mm(guarded(wall, 0.003, 2)), -0.003);
  EXPECT_NEAR(wall.path.points()[10].shift_mm.norm(), 0, 1e-4) << "ten millimetres away";
}

TEST(DepthLimit, LeavesRoomForWhatNoShiftTakesAway) {
  Wall bow, even;
  bow.add([](double, double height) { return 0.010 + 0.010 * (height - 0.5); });
  even.add([](double, double) { return 0.010; });
  // The best shift leaves -4.5 ... 4.5 um.
  EXPECT_NEAR(default_depth_limit_um(bow.path, bow.observed, {}, 2), 1.25 * 4.5, 0.3);
  EXPECT_EQ(default_depth_limit_um(bow.path, bow.observed, {}, 8), 8);
  EXPECT_EQ(default_depth_limit_um(even.path, even.observed, {}, 2), 2);
}

/// 95th percentile of what the best shift leaves of a wall, um.
double left_p95_um(const Wall& wall, const FitShiftOptions& options) {
  std::vector<double> left_um, area;
  for (const double left_mm : left_by_shift_mm(wall.path, wall.observed.points, options)) {
    left_um.push_back(1000 * left_mm);
    area.push_back(1);
  }
  return removal::error_figures(left_um, area).p95;
}

/// Nine tenths of the height are even, the rest is 10 um deeper: least squares leave 9 um there, the middle 5 um.
TEST(Centring, BringsALopsidedBowNearTheMiddleOfItsRange) {
  Wall wall;
  wall.add([](double, double height) { return height > 0.9 ? -0.010 : 0.0; });
  EXPECT_NEAR(left_p95_um(wall, {}), 9, 0.3);
  EXPECT_LT(left_p95_um(wall, {.centred = true}), 7);
  EXPECT_GE(left_p95_um(wall, {.centred = true}), 5) << "the middle of the range is the least there is";
}

TEST(Centring, LeavesAnEvenBowAndWhatFewPlacesHaveToLeastSquares) {
  Wall even, few;
  even.add([](double, double height) { return 0.010 * (height - 0.5); });
  few.add([](double x, double height) { return x > 20 && x < 21 && height > 0.5 ? 0.030 : 0.002 * (height - 0.5); });
  EXPECT_NEAR(left_p95_um(even, {.centred = true}), left_p95_um(even, {}), 0.1);
  EXPECT_LE(left_p95_um(few, {.centred = true}), left_p95_um(few, {}));
}

TEST(Centring, GoesNoDeeperThanADefaultLimitHasRoomFor) {
  Wall wall;  // the middle would be 5 um deep, least squares are 1 um deep
  wall.add([](double, double height) { return height > 0.9 ? 0.010 : 0.0; });
  double deepest_mm = 0;
  for (const double left_mm : left_by_shift_mm(wall.path, wall.observed.points, {.centred = true}))
    deepest_mm = std::max(deepest_mm, -left_mm);
  EXPECT_LT(deepest_mm, 0.0013);
}

TEST(ErrorSplit, NamesTheCauseOfEveryPoint) {
  Wall wall;
  wall.add([](double x, double height) { return x < 20 ? 0.010 : 0.020 * (height - 0.5); });
  for (std::size_t i = 0; i < 100; ++i) wall.observed.compensated[i] = false;
  std::vector<PointCause> causes;
  split_error(wall.path, wall.observed, {}, &causes);
  ASSERT_EQ(causes.size(), wall.observed.points.size());
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const double x = wall.observed.points[i].place.lower + wall.observed.points[i].place.upper_fraction;
    if (i < 100) {
      EXPECT_EQ(causes[i].cause, Cause::not_compensated) << i;
    } else if (x > 8 && x < 16) {
      EXPECT_EQ(causes[i].cause, Cause::correctable) << i;
      EXPECT_NEAR(causes[i].error_mm, 0.010, 0.001);
    } else if (x > 24 && x < 36 && std::abs(wall.observed.points[i].error_mm) > 0.004) {
      EXPECT_EQ(causes[i].cause, Cause::bow) << i;
    }
  }
}

TEST(Sensitivity, LearnsTheGainOfEveryStretch) {
  Wall wall;
  wall.add([](double, double) { return 0.02; });
  const std::vector<Vec3> none = wall.path.shifts();
  fit_shift(wall.path, wall.observed.of_path(), {});
  Observed now = wall.observed;
  const auto truth = [&](const Observation& o) { return o.place.lower < 20 ? 0.6 : 1.2; };
  for (auto& o : now.points) o.error_mm += truth(o) * o.normal.dot(wall.path.shift_at(o.place));
  Sensitivity sensitivity(wall.path);
  sensitivity.learn(wall.path, none, wall.observed, now);
  std::vector<Observation> asked = now.of_path();
  sensitivity.apply_to(asked);
  for (const auto& o : asked) {
    if (o.place.lower > 12 && o.place.lower < 28) continue;  // averaged over a few millimetres
    EXPECT_NEAR(o.gain, truth(o), 0.06);
  }
}

}  // namespace
}  // namespace camber::compensate
