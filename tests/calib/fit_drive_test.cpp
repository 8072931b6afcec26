// The servo of an axis from its commands: drives integrated here in small steps, by their equation alone.
#include "calib/fit_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "calib/fit_feed_model.h"

namespace camber::calib {
namespace {

struct TrueDrive {
  double gain = 30, lag_s = 0, feed_forward = 0, acceleration_s = 0, dead_time_s = 0, backlash = 0;
  std::size_t average = 1;        ///< of so many commands, before the loop
  std::size_t command_every = 1;  ///< periods of 1 ms from command to command
};

/// Ramps, reversals and rests at several speeds.
std::vector<double> commands(double period_s) {
  std::vector<double> c{0.0};
  double at = 0, speed = 0;
  const double acceleration = 700;
  const double targets[] = {40, -25, 0, 80, 10, -70, 0, 5, 0, -60, 30, 0, 90, -90, 0};
  for (int round = 0; round < 2; ++round)
    for (const double target : targets) {
      for (double t = 0; t < 0.35; t += period_s) {
        const double step = acceleration * period_s;
        speed += std::clamp(target - speed, -step, step);
        at += speed * period_s;
        c.push_back(std::round(at * 1e4) / 1e4);
      }
    }
  return c;
}

/// Tv x'' + x' = Kp (c - x) + F c' + Ka c'' in steps of 10 us; the command runs straight between samples.
ServoTrace followed(const TrueDrive& d, double noise_mm = 0, int every = 1) {
  std::vector<double> command = commands(0.001);
  for (std::size_t k = 0; k < command.size(); ++k) {
    const std::size_t first = k - k % d.command_every, next = first + d.command_every;
    const double u = static_cast<double>(k - first) / static_cast<double>(d.command_every);
    if (u > 0 && next < command.size()) command[k] = (1 - u) * command[first] + u * command[next];
  }
  constexpr int kSteps = 100;
  constexpr double h = 0.001 / kSteps;
  const auto delay = static_cast<std::size_t>(std::lround(d.dead_time_s / h));
  std::vector<double> passed, fine;
  double sum = static_cast<double>(d.average) * command.front();
  for (std::size_t k = 0; k < command.size(); ++k) {
    sum += command[k] - (k < d.average ? command.front() : command[k - d.average]);
    passed.push_back(sum / static_cast<double>(d.average));
  }
  for (std::size_t k = 1; k < passed.size(); ++k)
    for (int i = 0; i < kSteps; ++i) fine.push_back(passed[k - 1] + (passed[k] - passed[k - 1]) * i / kSteps);
  ServoTrace t;
  t.has_command = t.has_actual = {true, true, true};
  double x = 0, v = 0, load = 0, last_speed = 0;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, noise_mm > 0 ? noise_mm : 1);
  for (std::size_t n = 0; n < fine.size(); ++n) {
    if (n % (kSteps * static_cast<std::size_t>(every)) == 0) {
      t.t_s.push_back(static_cast<double>(n) * h);
      t.command_mm.emplace_back(command[n / kSteps], 0, 0);
      const double seen = load + (noise_mm > 0 ? noise(random) : 0);
      t.actual_mm.emplace_back(std::round(seen * 1e4) / 1e4, 0, 0);
    }
    const double c = n > delay ? fine[n - delay] : 0, c_before = n > delay + 1 ? fine[n - delay - 1] : 0;
    const double speed = (c - c_before) / h, acceleration = (speed - last_speed) / h;
    last_speed = speed;
    const double wanted = d.gain * (c - x) + d.feed_forward * speed + d.acceleration_s * acceleration;
    v = d.lag_s > 0 ? v + (wanted - v) * h / d.lag_s : wanted;
    x += v * h;
    load = std::clamp(load, x - d.backlash / 2, x + d.backlash / 2);
  }
  set_stretches(t);
  return t;
}

DriveFit fit(const ServoTrace& trace) { return fit_drive({&trace}, 0, {}); }

void expect(const FittedValue& value, double truth, double fraction) {
  EXPECT_NEAR(value.value, truth, fraction * truth);
  EXPECT_LT(value.std_error, 0.1 * truth);
  EXPECT_LT(std::abs(value.value - truth), 3 * value.std_error + 1e-9);
}

TEST(FitDrive, FindsFeedForwardBesideGainAndLag) {
  const DriveFit d = fit(followed({.gain = 31, .lag_s = 0.0035, .feed_forward = 0.5}));
  expect(d.gain_per_s, 31, 0.02);
  expect(d.velocity_lag_s, 0.0035, 0.02);
  expect(d.feed_forward_percent, 50, 0.02);
  EXPECT_LT(d.held_out_rms_mm, 0.0005);
}

TEST(FitDrive, FindsFeedForwardWithoutLag) {
  const DriveFit d = fit(followed({.gain = 45, .feed_forward = 0.8}));
  expect(d.gain_per_s, 45, 0.02);
  expect(d.feed_forward_percent, 80, 0.02);
}

TEST(FitDrive, FindsDeadTime) {
  const DriveFit d = fit(followed({.gain = 40, .lag_s = 0.002, .dead_time_s = 0.004}));
  expect(d.gain_per_s, 40, 0.03);
  EXPECT_NEAR(d.dead_time_s.value + d.velocity_lag_s.value, 0.006, 0.0006);
}

TEST(FitDrive, FindsAccelerationFeedForward) {
  const DriveFit d = fit(followed({.gain = 35, .lag_s = 0.005, .feed_forward = 0.9, .acceleration_s = 0.003}));
  expect(d.gain_per_s, 35, 0.03);
  expect(d.feed_forward_percent, 90, 0.02);
  expect(d.acceleration_feed_forward_s, 0.003, 0.1);
}

TEST(FitDrive, FindsBacklashOfTheLoad) {
  const DriveFit d = fit(followed({.gain = 33, .lag_s = 0.003, .backlash = 0.012}));
  expect(d.gain_per_s, 33, 0.03);
  expect(d.backlash, 0.012, 0.1);
}

TEST(FitDrive, FindsDeadTimeBehindAMovingAverage) {
  const DriveFit d = fit(followed({.gain = 40, .lag_s = 0.002, .dead_time_s = 0.012, .average = 64}));
  printf("%s: average %.1f, dead time %.2f, lag %.2f ms, gain %.2f, %.2f um\n", d.model.c_str(),
         1000 * d.filter_s.value, 1000 * d.dead_time_s.value, 1000 * d.velocity_lag_s.value, d.gain_per_s.value,
         1000 * d.held_out_rms_mm);
  expect(d.gain_per_s, 40, 0.03);
  EXPECT_NEAR(d.filter_s.value, 0.064, 0.0011);
  EXPECT_NEAR(d.dead_time_s.value + d.velocity_lag_s.value, 0.014, 0.0006);
}

/// A dead time is not taken for the lag that it looks like.
TEST(FitDrive, FindsDeadTimeWithoutLag) {
  const DriveFit d = fit(followed({.gain = 30, .dead_time_s = 0.0053}));
  EXPECT_EQ(d.model, "position loop and dead time");
  expect(d.gain_per_s, 30, 0.003);
  expect(d.dead_time_s, 0.0053, 0.02);
  EXPECT_EQ(d.velocity_lag_s.value, 0);
}

/// A log of every fourth period cuts the ramps off between its samples. Straight lines between them gave feed forward
/// and lags that the drive does not have.
TEST(FitDrive, TakesEveryFourthPeriod) {
  const DriveFit plain = fit(followed({.gain = 72}, 0, 4));
  EXPECT_EQ(plain.model, "position loop");
  expect(plain.gain_per_s, 72, 0.01);
  const DriveFit late = fit(followed({.gain = 72, .dead_time_s = 0.0021}, 0, 4));
  EXPECT_NEAR(late.gain_per_s.value, 72, 0.02 * 72);
  EXPECT_NEAR(late.dead_time_s.value + late.velocity_lag_s.value, 0.0021, 0.0002);
  EXPECT_EQ(late.feed_forward_percent.value, 0);
}

/// A control that interpolates as seldom as the log has samples: its commands are straight between them.
TEST(FitDrive, TakesAControlOfALongPeriod) {
  const DriveFit d = fit(followed({.gain = 40, .lag_s = 0.004, .command_every = 4}, 0, 4));
  expect(d.gain_per_s, 40, 0.01);
  expect(d.velocity_lag_s, 0.004, 0.05);
  EXPECT_LT(d.held_out_rms_mm, 0.0002);
}

/// A log of every fourth sample, with the noise of an encoder.
TEST(FitDrive, TakesCoarseAndNoisyLogs) {
  const DriveFit d =
      fit(followed({.gain = 31, .lag_s = 0.0035, .feed_forward = 0.5}, /*noise_mm=*/0.0005, /*every=*/4));
  EXPECT_NEAR(d.gain_per_s.value, 31, 3);
  EXPECT_NEAR(d.feed_forward_percent.value, 50, 5);
}

/// A trace begins, or goes on behind a hole, at full speed or where the command stands and the axis still follows it.
TEST(FitDrive, TakesTracesThatBeginOnTheWay) {
  for (const std::ptrdiff_t lost : {200, 780}) {
    ServoTrace t = followed({.gain = 30, .lag_s = 0.003});
    t.t_s.erase(t.t_s.begin(), t.t_s.begin() + lost);
    t.command_mm.erase(t.command_mm.begin(), t.command_mm.begin() + lost);
    t.actual_mm.erase(t.actual_mm.begin(), t.actual_mm.begin() + lost);
    ASSERT_GT((t.command_mm.front() - t.actual_mm.front()).norm(), 0.05) << lost;
    set_stretches(t);
    const DriveFit d = fit(t);
    EXPECT_NEAR(d.gain_per_s.value, 30, 0.1) << lost;
    EXPECT_NEAR(d.velocity_lag_s.value, 0.003, 0.0003) << lost;
    EXPECT_LT(d.fitted_rms_mm, 0.001) << lost;
    machine::Axis axis;
    axis.position_gain_per_s = d.gain_per_s.value, axis.velocity_lag_s = d.velocity_lag_s.value;
    EXPECT_LT(drive_rms_mm({&t}, 0, axis), 0.001) << lost;
  }
}

/// Three stretches, each shorter than a slice, so that the third one is held out: it comes from a drive of another
/// gain. The gain is that of the first two, and the error that is held out shows the difference. No richer model is
/// tried, which might explain the third one by chance.
TEST(FitDrive, NeverFitsWhatIsHeldOut) {
  const ServoTrace own = followed({.gain = 30}), other = followed({.gain = 60});
  constexpr std::size_t kSamples = 700;  // up to the first rest
  std::vector<ServoTrace> traces;
  for (const ServoTrace* whole : {&own, &own, &other}) {
    ServoTrace t = *whole;
    t.t_s.resize(kSamples);
    t.command_mm.resize(kSamples);
    t.actual_mm.resize(kSamples);
    set_stretches(t);
    traces.push_back(t);
  }
  const DriveFit d = fit_drive({&traces[0], &traces[1], &traces[2]}, 0, {.better_by_mm = 10});
  EXPECT_NEAR(d.gain_per_s.value, 30, 0.03);
  EXPECT_LT(d.fitted_rms_mm, 0.0002);
  EXPECT_GT(d.held_out_rms_mm, 0.1);
}

TEST(FitDrive, SaysThatAnAxisAtRestTellsNothing) {
  ServoTrace trace = followed({});
  for (std::size_t k = 0; k < trace.size(); ++k) trace.command_mm[k] = trace.actual_mm[k] = Vec3::Zero();
  EXPECT_FALSE(fit(trace).moved);
}

/// At one speed for long the lag alone shows: gain / (1 - feed forward) is known, neither of both.
TEST(FitDrive, SaysWhatASteadySpeedDoesNotTell) {
  ServoTrace t;
  t.has_command = t.has_actual = {true, true, true};
  for (int k = 0; k < 4000; ++k) {
    t.t_s.push_back(0.001 * k);
    t.command_mm.emplace_back(0.02 * k, 0, 0);
    t.actual_mm.emplace_back(0.02 * k - 20 * 0.016, 0, 0);
  }
  set_stretches(t);
  const DriveFit d = fit(t);
  EXPECT_FALSE(is_determined(d.feed_forward_percent));
  machine::Machine machine;
  machine.axis[0].feed_forward_percent = 40;
  std::vector<FitParameter> parameters;
  add_drive(machine, parameters, 0, d);
  EXPECT_NEAR(machine.axis[0].position_gain_per_s, 0.6 / 0.016, 0.01) << "as far behind as the trace";
  EXPECT_EQ(machine.axis[0].feed_forward_percent, 40);
  ASSERT_EQ(parameters[1].name, "axis.x.feed_forward_percent");
  EXPECT_FALSE(parameters[1].written);
  EXPECT_EQ(parameters[1].note,
            "not determined by the traces; start value kept (run the polygon programs of camber protocol)");
}

}  // namespace
}  // namespace camber::calib
