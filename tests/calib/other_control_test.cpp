// fit-feed on controls that are not built as its model is, and on runs that something interfered with.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/fit_acceleration.h"
#include "calib/fit_feed_model.h"
#include "feedmodel/axes.h"
#include "tests/support/feed_runs.h"

namespace camber::calib {
namespace {

using tests::figures;
using tests::known_machine;
using tests::synthetic_run;

/// y'' + 2 d w y' + w^2 y = x'' + 2 d0 w x' + w^2 x, by the bilinear transform.
class Notch {
 public:
  Notch(double frequency_hz, double damping, double zero_damping, double period_s, double start) {
    const double w = 2 * std::tan(kPi * frequency_hz * period_s);
    const double a0 = 4 + 4 * damping * w + w * w;
    b_ = {(4 + 4 * zero_damping * w + w * w) / a0, (2 * w * w - 8) / a0, (4 - 4 * zero_damping * w + w * w) / a0};
    a_ = {(2 * w * w - 8) / a0, (4 - 4 * damping * w + w * w) / a0};
    x_ = y_ = {start, start};
  }
  double operator()(double x) {
    const double y = b_[0] * x + b_[1] * x_[0] + b_[2] * x_[1] - a_[0] * y_[0] - a_[1] * y_[1];
    x_ = {x, x_[0]};
    y_ = {y, y_[0]};
    return y;
  }

 private:
  std::array<double, 3> b_{};
  std::array<double, 2> a_{}, x_{}, y_{};
};

machine::Machine start_of(const machine::Machine& known) {
  machine::Machine start;
  start.control.kind = known.control.kind;
  start.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  return start;
}

constexpr double kSmoothingS = 0.024;
constexpr double kNoiseMm = 0.0005;

/// What a jerk-limited control with a notch at 150 Hz before each position loop leaves: the command is averaged over
/// 24 ms, the encoders have a noise of 0.5 um.
FeedRun jerk_limited_run(const machine::Machine& machine, double size = 1.0) {
  FeedRun run = synthetic_run(machine, size);
  ServoTrace& t = run.trace;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kNoiseMm);
  for (int axis = 0; axis < 3; ++axis) {
    feedmodel::AxisFilter average(static_cast<std::size_t>(std::lround(kSmoothingS / t.period_s)), 0);
    Notch notch(150, 0.4, 0.05, t.period_s, 0);
    feedmodel::PositionLoop loop({.gain_per_s = machine.axis[axis].position_gain_per_s,
                                  .velocity_lag_s = machine.axis[axis].velocity_lag_s,
                                  .period_s = t.period_s},
                                 0);
    for (std::size_t k = 0; k < t.size(); ++k) {
      const double command = average(t.command_mm[k][axis]);
      t.command_mm[k][axis] = std::round(command * 1e6) / 1e6;
      t.actual_mm[k][axis] = loop(notch(command)) + noise(random);
    }
  }
  return run;
}

const FitParameter& parameter(const FitFeedResult& fit, const std::string& name) {
  for (const FitParameter& p : fit.parameters)
    if (p.name == name) return p;
  static const FitParameter none;
  ADD_FAILURE() << "no parameter " << name;
  return none;
}

constexpr double kSigmas = 3;

TEST(OtherControl, JerkLimitedWithANotchAndNoise) {
  const machine::Machine known = known_machine();
  const FeedRun run = jerk_limited_run(known);
  const FitFeedResult fit = fit_feed({run}, start_of(known), {});
  const char* const axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const FitParameter& a = parameter(fit, std::string("axis.") + axes[i] + ".acceleration_mm_per_s2");
    ASSERT_TRUE(a.std_error) << axes[i];
    EXPECT_LT(std::abs(a.value - known.axis[i].acceleration_mm_per_s2), kSigmas * *a.std_error) << axes[i];
    EXPECT_LT(*a.std_error, 0.05 * a.value);
    const FitParameter& j = parameter(fit, std::string("axis.") + axes[i] + ".jerk_mm_per_s3");
    ASSERT_TRUE(j.std_error) << axes[i];
    EXPECT_LT(std::abs(j.value - known.axis[i].acceleration_mm_per_s2 / kSmoothingS), kSigmas * *j.std_error);
    // The notch lags by 2 (d - d0) / w at low frequencies: in the model, that is part of the loop's 1 / gain.
    const double gain = 1 / (1 / known.axis[i].position_gain_per_s + 2 * (0.4 - 0.05) / (2 * kPi * 150));
    const FitParameter& g = parameter(fit, std::string("axis.") + axes[i] + ".position_gain_per_s");
    ASSERT_TRUE(g.std_error) << axes[i];
    EXPECT_LT(std::abs(g.value - gain), kSigmas * *g.std_error) << axes[i] << " " << g.value << " " << gain;
    EXPECT_LT(*g.std_error, 0.2 * g.value) << axes[i];
    EXPECT_GT(fit.drives[i].held_out_rms_mm, kNoiseMm * 0.9);  // not claimed to be better than the noise
  }
  printf("jerk-limited control with a notch: held out %.2f %% time, %.2f %% path speed rms\n",
         fit.held_out.part_time_percent, fit.held_out.speed_rms_percent);
  for (const FitParameter& p : fit.parameters)
    if (p.std_error) printf("  %-32s %10.4g +- %.2g %s\n", p.name.c_str(), p.value, *p.std_error, p.unit.c_str());
  // Told honestly: on figures of another size, at other feeds, the error is as large as the held-out one says.
  const FeedRun other = jerk_limited_run(known, 1.4);
  const FeedAccuracy unseen = feed_accuracy(other.trace, other.program, fit.machine, parts_of(other.program), {});
  printf("  unseen: parts %.2f %% time, %.2f %% path speed rms\n", unseen.part_time_error_percent,
         unseen.speed_rms_percent);
  EXPECT_LT(unseen.speed_rms_percent, 1.3 * fit.held_out.speed_rms_percent);
  EXPECT_LT(unseen.part_time_error_percent, fit.held_out.part_time_percent + 0.2);
}

TEST(OtherControl, ConstantAccelerationIsNotTakenForJerk) {
  const FeedRun run = synthetic_run(known_machine());
  EXPECT_FALSE(smoothing_time_s({&run.trace}));
}

/// Commands pass at `rate` of the time, the axes follow.
void replay(FeedRun& run, const machine::Machine& machine, const std::function<double(double)>& rate) {
  const ServoTrace was = run.trace;
  ServoTrace& t = run.trace;
  t.t_s.clear(), t.command_mm.clear(), t.actual_mm.clear(), t.line.clear();
  feedmodel::Axes axes(machine, was.command_mm.front());
  double at = 0;
  for (std::size_t k = 0; at < static_cast<double>(was.size() - 1); ++k) {
    const auto i = static_cast<std::size_t>(at);
    const double u = at - static_cast<double>(i);
    t.t_s.push_back(static_cast<double>(k) * was.period_s);
    t.command_mm.push_back((1 - u) * was.command_mm[i] + u * was.command_mm[i + 1]);
    t.actual_mm.push_back(axes(t.command_mm.back()));
    t.line.push_back(was.line[i]);
    at += rate(t.t_s.back());
  }
  set_stretches(t);
}

void cut(ServoTrace& t, double from_s, double to_s) {
  const auto first = static_cast<std::ptrdiff_t>(from_s / t.period_s),
             end = static_cast<std::ptrdiff_t>(to_s / t.period_s);
  const auto erase = [&](auto& v) { v.erase(v.begin() + first, v.begin() + end); };
  erase(t.t_s), erase(t.command_mm), erase(t.actual_mm), erase(t.line);
  set_stretches(t);
}

TEST(OtherControl, AFeedHoldAnOverrideAndAHoleDoNotSpoilTheFit) {
  const machine::Machine known = known_machine();
  FeedRun run = synthetic_run(known);
  replay(run, known, [](double t) { return t > 3.0 && t < 4.7 ? 0.0 : t > 8.0 && t < 9.5 ? 0.6 : 1.0; });
  cut(run.trace, 12.0, 13.1);
  EXPECT_EQ(run.trace.stretches.size(), 2u);
  const FitFeedResult fit = fit_feed({run}, start_of(known), {});
  EXPECT_TRUE(fit.converged) << fit.message;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(fit.machine.axis[i].acceleration_mm_per_s2 / known.axis[i].acceleration_mm_per_s2, 1, 0.03) << i;
    EXPECT_NEAR(fit.machine.axis[i].position_gain_per_s / known.axis[i].position_gain_per_s, 1, 0.01) << i;
  }
  EXPECT_NEAR(fit.machine.control.arc_normal_fraction, 0.8, 0.03);
}

}  // namespace
}  // namespace camber::calib
