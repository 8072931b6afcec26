// The limits of a machine as the predicted motion keeps them, against closed forms.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "feedmodel/feed_csv.h"
#include "feedmodel/timed_path.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

constexpr double kFeed_mm_per_s = 50, kPeriod_s = 0.001;

std::vector<TimedSample> samples_of(const nc::Interpretation& program, const machine::Machine& machine,
                                    FeedSummary* summary = nullptr) {
  std::vector<TimedSample> all;
  const FeedSummary s = predict_feed(
      program, machine, [&](std::span<const TimedSample> run) { all.insert(all.end(), run.begin(), run.end()); });
  if (summary) *summary = s;
  return all;
}

/// Ten millimetres from one speed to another, up to the feed and down again between: L / V and (V - v)^2 / (2 a V) more
/// for each change.
double time_s(double from, double to, double acceleration) {
  const auto change = [&](double v) { return std::pow(kFeed_mm_per_s - v, 2) / (2 * acceleration * kFeed_mm_per_s); };
  return 10 / kFeed_mm_per_s + change(from) + change(to);
}

TEST(MachineLimits, SpeedDifferenceIsPassedAtTheCorner) {
  for (const double permitted : {10.0, 30.0}) {
    machine::Machine m;
    m.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = permitted};
    for (auto& axis : m.axis) axis.acceleration_mm_per_s2 = 600;
    tests::TestProgram p;
    p.line(10, 0, 0, 60 * kFeed_mm_per_s).line(10, 10, 0, 60 * kFeed_mm_per_s);
    FeedSummary summary;
    const auto samples = samples_of(p.program, m, &summary);
    // Round a right angle each axis changes its speed by the path's.
    EXPECT_NEAR(summary.time_s, time_s(0, permitted, 600) + time_s(permitted, 0, 600), 2 * kPeriod_s) << permitted;
    double slowest = kFeed_mm_per_s;
    for (std::size_t k = 1; k < samples.size(); ++k) {
      const Vec3& at = samples[k].command_mm;
      const double to_corner = (at - Vec3(10, 0, 0)).norm();
      if (to_corner < 2 && to_corner > 0.2)
        slowest = std::min(slowest, (at - samples[k - 1].command_mm).norm() / kPeriod_s);
    }
    EXPECT_GE(slowest, permitted);
    EXPECT_LE(slowest, std::sqrt(permitted * permitted + 2 * 600 * 0.3));
  }
}

TEST(MachineLimits, JerkIsKeptAndUsed) {
  constexpr double kJerk = 10000, kAcceleration = 500;
  machine::Machine m;
  for (auto& axis : m.axis) axis.acceleration_mm_per_s2 = kAcceleration;
  m.axis[0].jerk_mm_per_s3 = kJerk;
  tests::TestProgram p;
  p.line(20, 0, 0, 60 * kFeed_mm_per_s).dwell(0.2);
  const auto s = samples_of(p.program, m);
  double jerk = 0, acceleration = 0;
  for (std::size_t k = 3; k < s.size(); ++k) {
    const auto x = [&](std::size_t back) { return s[k - back].position_mm.x(); };
    jerk = std::max(jerk, std::abs(x(0) - 3 * x(1) + 3 * x(2) - x(3)) / std::pow(kPeriod_s, 3));
    acceleration = std::max(acceleration, std::abs(x(0) - 2 * x(1) + x(2)) / std::pow(kPeriod_s, 2));
  }
  EXPECT_NEAR(jerk, kJerk, 0.01 * kJerk);
  EXPECT_NEAR(acceleration, kAcceleration, 0.01 * kAcceleration);
}

TEST(FeedCsvSize, IsSaidBeforeAHugeFileIsWritten) {
  const auto said = [](double time_s, double free_bytes) {
    Diagnostics found;
    check_feed_csv_size(time_s, kPeriod_s, free_bytes, "feed.csv", found);
    return found.all().empty() ? std::string() : to_string(found.all().front());
  };
  EXPECT_EQ(said(3600, 1e12), "");
  EXPECT_EQ(said(100 * 3600, 1e12), "feed.csv: warning: 100.0 h of motion are 3.6e+08 rows, about 31 GB [output-size]");
  EXPECT_EQ(said(100 * 3600, 1e10),
            "feed.csv: error: 100.0 h of motion are 3.6e+08 rows, about 31 GB, but 10 GB are free on the disk; a "
            "shorter program was expected [output-size]");
}

}  // namespace
}  // namespace camber::feedmodel
