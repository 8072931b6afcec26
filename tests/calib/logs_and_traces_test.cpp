// Servo traces and logged times in one fit: each tells what the other does not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/fit_feed_model.h"
#include "calib/fit_stretches.h"
#include "feedmodel/motion_plan.h"
#include "tests/support/synthetic_control.h"

namespace camber::calib {
namespace {

using machine::CornerLaw;
using machine::Machine;

constexpr double kLogSigma_s = 0.03;
constexpr double kSigmas = 3;

/// What was traced: corners in the XY plane, no arc, no Z.
nc::Interpretation traced_program() {
  tests::TestProgram p;
  for (const double feed : {600.0, 1500.0, 4000.0})
    for (const double turn_deg : {15.0, 30.0, 60.0, 90.0, 120.0})
      for (const double side : {1.0, 4.0}) {
        Vec3 at = Vec3::Zero();
        for (int i = 0; i < std::lround(360 / turn_deg); ++i) {
          const double heading = i * turn_deg * kPi / 180;
          at += side * Vec3(std::cos(heading), std::sin(heading), 0);
          p.line(at.x(), at.y(), 0, feed);
        }
        p.dwell(0.2).rapid(0, 0, 0).dwell(0.2);
      }
  return p.program;
}

/// What was logged: ramps in Z, circles, some corners; of three tools.
nc::Interpretation logged_program() {
  tests::TestProgram p;
  int tool = 0;
  for (const double feed : {1500.0, 3000.0, 6000.0}) {
    p.new_state().tool = ++tool;
    for (const double rise : {1.0, 2.0, 5.0, 9.0}) {
      p.rapid(0, 0, 20).rapid(0, 0, 0);
      for (int i = 1; i <= 60; ++i) p.line(0, 0, i % 2 ? rise : 0, feed);
    }
    for (const double r : {0.5, 1.5, 4.0, 9.0}) {
      p.rapid(0, 0, 20).rapid(r, 0, 0);
      for (int i = 0; i < 12; ++i) p.arc_xy(r, 0, 0, 0, 2 * kPi, feed);
    }
    p.rapid(0, 0, 20);
  }
  return p.program;
}

/// From the start of the first block to that of the rapid behind the last one, as an adapter sees it.
StretchRun logged_run(const nc::Interpretation& program, const Machine& machine, unsigned seed) {
  StretchRun run{"logged", program, {}};
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, kLogSigma_s);
  const auto segments = feedmodel::plan_motion(program, machine).times;
  for (const FeedStretch& s : feed_stretches(program)) {
    const auto at = [&](std::size_t move) {
      return std::ranges::find_if(segments, [&](const auto& t) { return t.move >= move && !t.rest; })->start_s;
    };
    run.timed.push_back({s, at(s.move_end) - at(s.move_first) + error(random), kLogSigma_s});
  }
  return run;
}

Machine known_control() {
  Machine m = tests::synthetic_control(3, CornerLaw::speed_difference);
  m.control.arc_normal_fraction = 0.7;
  m.control.in_position_mm = 0.02;
  m.control.rapid_change_s = 0.1;
  return m;
}

const FitParameter& named(const FitFeedResult& fit, const std::string& name) {
  const auto at = std::ranges::find(fit.parameters, name, &FitParameter::name);
  if (at == fit.parameters.end()) throw std::runtime_error(name + " is not in the list");
  return *at;
}

TEST(LogsAndTraces, EachTellsWhatTheOtherDoesNot) {
  const Machine known = known_control();
  const FeedRun traced = tests::traced_run(traced_program(), known, {.position_mm = 0.0005, .seed = 1});
  const StretchRun logged = logged_run(logged_program(), known, 2);
  Machine start;
  start.control.in_position_mm = 0.02;
  const FitFeedResult alone = fit_feed({traced}, start, {});
  const FitFeedResult both = fit_feed({traced}, {logged}, start, {});
  EXPECT_TRUE(both.converged) << both.message;
  EXPECT_EQ(both.machine.control.corner.law, CornerLaw::speed_difference) << both.law;
  EXPECT_FALSE(named(alone, "axis.z.acceleration_mm_per_s2").written);
  EXPECT_FALSE(named(alone, "control.arc_normal_share").written);
  const auto expect = [&](const std::string& name, double truth, const char* source) {
    const FitParameter& p = named(both, name);
    ASSERT_TRUE(p.std_error) << name << ": " << p.note;
    printf("%-44s %10.4g, fitted %10.4g +- %.2g, %s\n", name.c_str(), truth, p.value, *p.std_error, p.note.c_str());
    EXPECT_LT(std::abs(p.value - truth), kSigmas * *p.std_error) << name;
    EXPECT_LT(*p.std_error, 0.25 * p.value) << name;
    EXPECT_TRUE(p.note.starts_with(source)) << name << ": " << p.note;
  };
  expect("axis.x.acceleration_mm_per_s2", known.axis[0].acceleration_mm_per_s2, "from the traces");
  expect("axis.y.acceleration_mm_per_s2", known.axis[1].acceleration_mm_per_s2, "15 % from the logged times");
  expect("axis.z.acceleration_mm_per_s2", known.axis[2].acceleration_mm_per_s2, "from the logged times");
  expect("control.arc_normal_share", 0.7, "from the logged times");
  expect("control.corner.speed_difference_mm_per_min", 60 * known.control.corner.speed_difference_mm_per_s,
         "from the traces");
  expect("control.rapid_change_ms", 100, "from the logged times");
  for (const char* axis : {"x", "y"}) {
    const std::string name = fmt::format("axis.{}.acceleration_mm_per_s2", axis);
    EXPECT_LT(*named(both, name).std_error, 1.2 * *named(alone, name).std_error) << "the logs do no harm";
    EXPECT_TRUE(named(both, fmt::format("axis.{}.position_gain_per_s", axis)).std_error) << "drives as well";
  }
  EXPECT_EQ(both.logged.size(), feed_stretches(logged.program).size());
  EXPECT_LT(both.logged_held_out.mean, 1.0);
}

/// LinuxCNC brakes with half its acceleration before a dwell, but not before the rapid behind a logged stretch.
TEST(LogsAndTraces, StretchesEndInTheRapidBehindThem) {
  Machine known = tests::synthetic_control(5, CornerLaw::blend);
  const FeedRun traced = tests::traced_run(traced_program(), known, {.position_mm = 0.0005, .seed = 1});
  const StretchRun logged = logged_run(logged_program(), known, 3);
  Machine start;
  start.control.kind = known.control.kind;
  start.cycle.rapid_path = known.cycle.rapid_path;
  start.control.corner = {.law = CornerLaw::blend, .tolerance_mm = machine::kNoLimit};
  const FitFeedResult fit = fit_feed({traced}, {logged}, start, {});
  EXPECT_EQ(fit.machine.control.corner.law, CornerLaw::blend) << fit.law;
  EXPECT_LT(fit.logged_held_out.mean, 1.0);
  const FitParameter& z = named(fit, "axis.z.acceleration_mm_per_s2");
  ASSERT_TRUE(z.std_error) << z.note;
  EXPECT_LT(std::abs(z.value - known.axis[2].acceleration_mm_per_s2), kSigmas * *z.std_error);
}

}  // namespace
}  // namespace camber::calib
