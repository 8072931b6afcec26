// fit-feed finds the law of a control, whatever the machine file that it starts from says.
#include "calib/control_laws.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "calib/fit_acceleration.h"
#include "calib/fit_feed_model.h"
#include "feedmodel/axes.h"
#include "tests/support/synthetic_control.h"

namespace camber::calib {
namespace {

using machine::CornerLaw;
using machine::Machine;
using tests::Dice;

constexpr double kNoiseMm = 0.0005;
constexpr double kSigmas = 3;

/// What a user may start from: a file that says nothing of the control, one with wrong values, one with some.
Machine start_of(unsigned seed, const Machine& known) {
  Machine start;
  start.control.kind = known.control.kind;
  start.cycle.rapid_path = known.cycle.rapid_path;
  if (known.control.corner.law == CornerLaw::blend)
    start.control.corner = {.law = CornerLaw::blend, .tolerance_mm = machine::kNoLimit};
  if (seed % 3 == 0) return start;
  if (seed % 3 == 1) {
    for (machine::Axis& axis : start.axis) axis.acceleration_mm_per_s2 = 1000;
    start.control.block_time_s = 0.02;
    start.control.arc_normal_fraction = 0.3;
    if (known.control.corner.law != CornerLaw::blend)
      start.control.corner = {.law = CornerLaw::speed_difference, .speed_difference_mm_per_s = 0.5};
    return start;
  }
  start.axis[0].acceleration_mm_per_s2 = 5000;
  start.axis[2].acceleration_mm_per_s2 = 100;
  return start;
}

std::map<std::string, double> truths_of(const Machine& known) {
  std::map<std::string, double> out;
  for (int i = 0; i < 3; ++i)
    out[fmt::format("axis.{}.acceleration_mm_per_s2", "xyz"[i])] = known.axis[i].acceleration_mm_per_s2;
  const machine::Corner& corner = known.control.corner;
  if (corner.law == CornerLaw::speed_difference)
    out["control.corner.speed_difference_mm_per_min"] = 60 * corner.speed_difference_mm_per_s;
  if (corner.law == CornerLaw::angle) out["control.corner.time_ms"] = 1000 * corner.time_s;
  if (corner.law == CornerLaw::radius) out["control.corner.acceleration_mm_per_s2"] = corner.acceleration_mm_per_s2;
  // A control that stops at every chord never comes near its block time.
  if (corner.law != CornerLaw::exact_stop) out["control.block_time_ms"] = 1000 * known.control.block_time_s;
  return out;
}

class ControlLawSeeds : public testing::TestWithParam<unsigned> {};

TEST_P(ControlLawSeeds, IsChosenAndItsNumbersComeBack) {
  const unsigned seed = GetParam();
  constexpr CornerLaw kLaws[] = {CornerLaw::speed_difference, CornerLaw::angle, CornerLaw::radius,
                                 CornerLaw::exact_stop, CornerLaw::blend};
  const CornerLaw law = kLaws[seed % 5];
  const Machine known = tests::synthetic_control(seed, law);
  const FeedRun run = tests::traced_run(tests::ShortProtocol().program(), known, {kNoiseMm, seed});
  const FitFeedResult fit = fit_feed({run}, start_of(seed, known), {});
  EXPECT_TRUE(fit.converged) << fit.message;
  for (const JudgedCornerLaw& l : fit.laws)
    printf("seed %2u: %-44s %8.3f %% %8.4f%s\n", seed, l.name.c_str(), l.held_out_percent, l.held_out_cost,
           fit.law.starts_with(l.name) ? "  taken" : "");
  EXPECT_EQ(fit.machine.control.corner.law, law) << fit.law;
  EXPECT_TRUE(std::isinf(fit.machine.control.corner.stop_angle_rad)) << fit.law;
  EXPECT_LT(fit.held_out.part_time_percent, 0.5);
  const auto truths = truths_of(known);
  for (const FitParameter& p : fit.parameters) {
    const auto truth = truths.find(p.name);
    if (truth == truths.end()) continue;
    ASSERT_TRUE(p.std_error) << p.name << ": " << p.note;
    printf("seed %2u: %-44s %10.4g, fitted %10.4g +- %.2g\n", seed, p.name.c_str(), truth->second, p.value,
           *p.std_error);
    EXPECT_LT(std::abs(p.value - truth->second), kSigmas * *p.std_error) << p.name;
    EXPECT_LT(*p.std_error, 0.2 * p.value) << p.name;
  }
}

// Each law once; bench/feed/random-machines draws more of them.
INSTANTIATE_TEST_SUITE_P(Each, ControlLawSeeds, testing::Range(1u, 6u));

/// The control of the KAKEN report: an allowed speed difference of 246 mm/min, a ramp of 64 ms on every axis. The ramp
/// may stand before or behind the place where the command is traced.
TEST(ControlLawSlow, ARampAfterInterpolationIsFound) {
  Machine known = tests::synthetic_control(3, CornerLaw::speed_difference);
  known.control.corner.speed_difference_mm_per_s = 4.1;
  for (machine::Axis& axis : known.axis) {
    axis.acceleration_mm_per_s2 = 2000;
    axis.filter_s = 0.064;
  }
  FeedRun run = tests::traced_run(tests::ShortProtocol().program(), known, {});
  Machine start;
  start.control.corner = {.law = CornerLaw::speed_difference, .speed_difference_mm_per_s = 1000 / 60.0};
  for (machine::Axis& axis : start.axis) axis.acceleration_mm_per_s2 = 1000;
  for (const bool behind : {false, true}) {
    if (behind) {
      for (int axis = 0; axis < 3; ++axis) {
        feedmodel::AxisFilter ramp(64, 0);
        for (Vec3& c : run.trace.command_mm) c[axis] = ramp(c[axis]);
      }
    }
    const FitFeedResult fit = fit_feed({run}, start, {});
    EXPECT_EQ(fit.machine.control.corner.law, CornerLaw::speed_difference) << fit.law;
    EXPECT_NEAR(60 * fit.machine.control.corner.speed_difference_mm_per_s, 246, 0.02 * 246);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(fit.machine.axis[i].acceleration_mm_per_s2, 2000, 0.03 * 2000) << i;
      // A limit of jerk is such an average as well.
      EXPECT_NEAR(feedmodel::filter_times_s(fit.machine)[i], 0.064, 0.002) << i << (behind ? " behind" : " before");
    }
  }
}

/// A block that waits for a period takes half a period more on average; without that in the plan accelerations come out
/// too low.
TEST(ControlLaw, FindsWhetherABlockAfterAStopWaitsForAPeriod) {
  for (const bool starts : {false, true}) {
    Machine known = tests::synthetic_control(4, CornerLaw::exact_stop);
    known.control.period_s = 0.004;
    known.control.starts_on_period = starts;
    const FeedRun run = tests::traced_run(tests::ShortProtocol().program(), known, {});
    Machine start;
    start.control.period_s = known.control.period_s;
    const FitFeedResult fit = fit_feed({run}, start, {});
    EXPECT_EQ(fit.machine.control.starts_on_period, starts);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(fit.machine.axis[i].acceleration_mm_per_s2 / known.axis[i].acceleration_mm_per_s2, 1, 0.01)
          << i << " " << starts;
  }
}

/// Polygons under exact stop.
nc::Interpretation exact_stop_program() {
  tests::TestProgram p;
  p.new_state().path_control = nc::PathControl::exact_stop;
  for (const double feed : {600.0, 2000.0, 4000.0})
    for (int plane = 0; plane < 3; ++plane) {
      Vec3 at = Vec3::Zero();
      for (int i = 0; i < 8; ++i) {
        at[plane] += (2 + plane) * std::cos(i * kPi / 4);
        at[(plane + 1) % 3] += (2 + plane) * std::sin(i * kPi / 4);
        p.line(at.x(), at.y(), at.z(), feed);
      }
      p.dwell(0.2).rapid(0, 0, 0).dwell(0.2);
    }
  return p.program;
}

TEST(ControlLaw, FindsThatAControlDoesNotWaitInPosition) {
  for (const double width_mm : {0.02, machine::kNoLimit}) {
    Machine known = tests::synthetic_control(4, CornerLaw::exact_stop);
    known.control.in_position_mm = width_mm;
    const FeedRun run = tests::traced_run(exact_stop_program(), known, {});
    Machine start;
    start.control.in_position_mm = 0.02;
    const FitFeedResult fit = fit_feed({run}, start, {});
    if (std::isinf(width_mm)) {
      EXPECT_TRUE(std::isinf(fit.machine.control.in_position_mm));
      EXPECT_LT(fit.held_out.part_time_percent, 0.5);
    } else {
      EXPECT_EQ(fit.machine.control.in_position_mm, width_mm);
    }
  }
}

/// Corners of one feed tell those of another, where the law is one of speed; a stop of constant time would not.
TEST(ControlLaw, CornersOfOneFeedPredictThoseOfAnother) {
  const Machine known = tests::synthetic_control(3, CornerLaw::speed_difference);
  const auto program_at = [](double feed) {
    tests::TestProgram p;
    for (const double turn : {0.2, 0.5, 1.0, 1.5, 2.0}) {
      for (int repeat = 0; repeat < 3; ++repeat) {
        Vec3 at = Vec3::Zero();
        for (int i = 0; i < 8; ++i) {
          at += (3.0 + repeat) * Vec3(std::cos(i * turn), std::sin(i * turn), 0);
          p.line(at.x(), at.y(), 0, feed);
        }
        p.dwell(0.2).rapid(0, 0, 0).dwell(0.2);
      }
    }
    return p.program;
  };
  const FitFeedResult fit = fit_feed({tests::traced_run(program_at(1000), known, {})}, Machine{}, {});
  EXPECT_EQ(fit.machine.control.corner.law, CornerLaw::speed_difference) << fit.law;
  const FeedRun other = tests::traced_run(program_at(3000), known, {});
  const FeedAccuracy a = feed_accuracy(other.trace, other.program, fit.machine, parts_of(other.program), {});
  printf("corners fitted at F1000 predict F3000 within %.2f %% of a part's time\n", a.part_time_error_percent);
  EXPECT_LT(a.part_time_error_percent, 1.0);
}

/// Z never moves: its acceleration stays as the file has it, and the report says which program would tell it.
TEST(ControlLaw, SaysWhichProgramWouldTellWhatTheTraceDoesNot) {
  const Machine known = tests::synthetic_control(3, CornerLaw::speed_difference);
  tests::TestProgram p;
  for (int i = 1; i < 16; ++i) p.line(i % 2 ? 10 : 0, i % 4 > 1 ? 8 : 0, 0, 300.0 * i).dwell(0.1);
  const FitFeedResult fit = fit_feed({tests::traced_run(p.program, known, {})}, Machine{}, {});
  EXPECT_TRUE(std::isinf(fit.machine.axis[2].acceleration_mm_per_s2));
  bool said = false;
  for (const FitParameter& parameter : fit.parameters)
    said = said || (parameter.name == "axis.z.acceleration_mm_per_s2" && !parameter.written &&
                    parameter.note.find("camber protocol") != std::string::npos);
  EXPECT_TRUE(said);
}

}  // namespace
}  // namespace camber::calib
