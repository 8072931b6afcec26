#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "feedmodel/feed_csv.h"
#include "feedmodel/timed_path.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

constexpr double kStop = 1.2;  // mm/s, two periods of acceleration

machine::Machine test_machine() {
  machine::Machine m;
  m.control.corner.law = machine::CornerLaw::blend;
  m.control.corner.tolerance_mm = 0.01;
  for (int i = 0; i < 3; ++i) {
    m.axis[i].max_velocity_mm_per_s = 100;
    m.axis[i].acceleration_mm_per_s2 = 600 - 100 * i;
    m.axis[i].position_gain_per_s = 33;
  }
  return m;
}

std::vector<TimedSample> samples_of(const nc::Interpretation& program, const machine::Machine& machine,
                                    FeedSummary* summary = nullptr) {
  std::vector<TimedSample> all;
  const FeedSummary s = predict_feed(
      program, machine, [&](std::span<const TimedSample> run) { all.insert(all.end(), run.begin(), run.end()); });
  if (summary) *summary = s;
  return all;
}

TEST(PredictFeed, NoLimitsMeansLengthOverFeed) {
  tests::TestProgram p;
  p.line(60, 0, 0, 600).line(60, 30, 0, 600).dwell(0.5);
  FeedSummary summary;
  const auto samples = samples_of(p.program, machine::Machine{}, &summary);
  EXPECT_NEAR(summary.time_s, 9.5, 1e-9);
  EXPECT_NEAR(summary.cutting_time_s, 9.0, 1e-9);
  EXPECT_EQ(summary.blocks, 2u);
  EXPECT_NEAR((samples[3000].position_mm - Vec3(30, 0, 0)).norm(), 0, 1e-9);
}

TEST(PredictFeed, ExactStopTakesTheTrapezoidsTime) {
  machine::Machine m = test_machine();
  m.control.corner.law = machine::CornerLaw::exact_stop;
  tests::TestProgram p;
  p.line(10, 0, 0, 3000).line(10, 10, 0, 3000);
  FeedSummary summary;
  samples_of(p.program, m, &summary);
  EXPECT_NEAR(summary.time_s, 10 / 50.0 + 50 / 600.0 + 10 / 50.0 + 50 / 500.0, 0.0021);  // and up to two periods
}

TEST(PredictFeed, EmptyProgramGivesNothing) {
  FeedSummary summary;
  EXPECT_TRUE(samples_of({}, test_machine(), &summary).empty());
  EXPECT_EQ(summary.time_s, 0);
}

TEST(PredictFeed, CommandKeepsTheAxesLimitsAndIsContinuous) {
  machine::Machine m = test_machine();
  m.control.arc_normal_fraction = std::sqrt(0.75);
  m.control.arc_tangential_fraction = 0.5;
  tests::TestProgram p;
  unsigned seed = 7;
  const auto random = [&] { return static_cast<double>((seed = seed * 1664525u + 1013904223u) >> 8) / (1 << 24); };
  Vec3 at = Vec3::Zero();
  for (int i = 0; i < 300; ++i) {
    at += Vec3(random() - 0.3, random() - 0.5, 0.4 * random() - 0.2) * (i % 7 == 0 ? 8 : 1);
    p.line(at.x(), at.y(), at.z(), 500 + 5000 * random());
  }
  const auto s = samples_of(p.program, m);
  for (std::size_t k = 2; k < s.size(); ++k) {
    const Vec3 v = (s[k].command_mm - s[k - 1].command_mm) / 0.001;
    const double before = (s[k - 1].command_mm - s[k - 2].command_mm).norm() / 0.001;
    if (std::min(v.norm(), before) < kStop)
      continue;  // where it all but stops, the plan waits for the control's period
    const Vec3 a = (s[k].command_mm - 2 * s[k - 1].command_mm + s[k - 2].command_mm) / 1e-6;
    for (int i = 0; i < 3; ++i) {
      ASSERT_LE(std::abs(v[i]), m.axis[i].max_velocity_mm_per_s * 1.001);
      ASSERT_LE(std::abs(a[i]), m.axis[i].acceleration_mm_per_s2 * 1.05) << "t " << s[k].t_s << " axis " << i;
    }
  }
  EXPECT_NEAR((s.back().position_mm - at).norm(), 0, 1e-4);
}

TEST(PredictFeed, SameInputGivesTheSameSamples) {
  tests::TestProgram p;
  p.line(5, 1, 0, 1200).arc_xy(5, 11, 5, 6, 3.14159265358979, 1200).rapid(0, 0, 3);
  const auto a = samples_of(p.program, test_machine()), b = samples_of(p.program, test_machine());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].position_mm, b[i].position_mm);
}

TEST(FeedCsv, HasTheColumnsAndLines) {
  tests::TestProgram p;
  p.line(0.002, 0, 0, 60);
  const tests::TempFolder folder;
  FeedCsv csv(p.program, folder / "feed.csv");
  predict_feed(p.program, machine::Machine{}, [&](std::span<const TimedSample> run) { csv.write(run); });
  csv.commit();
  const std::string text = tests::file_text(folder / "feed.csv");
  EXPECT_EQ(text.substr(0, text.find('\n', text.find('\n') + 1)),
            "t_s,block,x_mm,y_mm,z_mm,vx_mm_per_min,vy_mm_per_min,vz_mm_per_min,feed_cmd_mm_per_min,feed_mm_per_min\n"
            "0.000000,1,0.00000,0.00000,0.00000,0.000,0.000,0.000,60.000,0.000");
}

}  // namespace
}  // namespace camber::feedmodel
