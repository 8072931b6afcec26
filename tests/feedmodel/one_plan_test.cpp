// One plan behind every command: times agree to the microsecond, axes keep their limits, the path has no jumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "feedmodel/cycle_time.h"
#include "feedmodel/motion_plan.h"
#include "feedmodel/rapid.h"
#include "feedmodel/timed_path.h"
#include "tests/support/nc_program.h"
#include "tests/support/random_motion.h"

namespace camber::feedmodel {
namespace {

constexpr double kMicrosecond = 1e-6;
constexpr unsigned kPrograms = 200, kMachines = 20;
constexpr double kBend_mm = 0.05;   // a chord of half a millimetre leaves a bent way by less
constexpr double kRounding = 1e-6;  // fraction of a speed: differences of places that a period apart

/// Largest commanded speed of an axis as a fraction of what it may do, over all samples.
class SpeedCheck {
 public:
  explicit SpeedCheck(const machine::Machine& m) : period_s_(m.control.period_s) {
    const double rapid = m.cycle.rapid_override_percent / 100;
    // Two overlapping rapids in a row may add up.
    const double both = m.cycle.rapid_overlap_percent > 0 ? 2.0 : 1.0;
    for (int i = 0; i < 3; ++i) limit_[i] = std::max(1.0, rapid * both) * m.axis[i].max_velocity_mm_per_s;
  }

  void operator()(std::span<const TimedSample> samples) {
    for (const TimedSample& s : samples) {
      if (last_) {
        const Vec3 v = (s.command_mm - *last_) / period_s_;
        worst_ = std::max(worst_, v.cwiseAbs().cwiseQuotient(limit_).maxCoeff());
      }
      last_ = s.command_mm;
    }
  }
  double worst() const { return worst_; }

 private:
  double period_s_;
  Vec3 limit_;
  std::optional<Vec3> last_;
  double worst_ = 0;
};

TEST(OnePlan, TimeAndFeedAgreeToTheMicrosecondForAnyProgramOnAnyMachine) {
  std::vector<nc::Interpretation> programs;
  for (unsigned p = 0; p < kPrograms; ++p) programs.push_back(tests::random_motion(p + 1));
  for (unsigned k = 0; k < kMachines; ++k) {
    const machine::Machine m = tests::random_machine(1000 + k);
    for (unsigned p = 0; p < kPrograms; ++p) {
      SpeedCheck speed(m);
      Vec3 end = Vec3::Zero();
      const FeedSummary feed = predict_feed(programs[p], m, [&](std::span<const TimedSample> samples) {
        speed(samples);
        end = samples.back().command_mm;
      });
      const CycleSplit time = cycle_time(programs[p], m).all.time;
      ASSERT_NEAR(time.cutting_s + time.positioning_s + time.dwell_s, feed.time_s, kMicrosecond) << p << " on " << k;
      ASSERT_NEAR(time.cutting_s, feed.cutting_time_s, kMicrosecond) << p << " on " << k;
      ASSERT_NEAR(plan_motion(programs[p], m).time_s(), feed.time_s, kMicrosecond) << p << " on " << k;
      ASSERT_LT(speed.worst(), 1 + kRounding) << p << " on " << k;
      ASSERT_LT((end - programs[p].moves.back().end_mm).norm(), 1e-6) << p << " on " << k;
    }
  }
}

machine::Machine lagging_machine() {
  machine::Machine m;
  m.control.in_position_mm = machine::kInPositionMm;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 20000 / 60.0;
    axis.acceleration_mm_per_s2 = 2000;
    axis.position_gain_per_s = 33;
  }
  return m;
}

std::vector<TimedSample> samples_of(const nc::Interpretation& program, const machine::Machine& m) {
  std::vector<TimedSample> all;
  predict_feed(program, m, [&](std::span<const TimedSample> run) { all.insert(all.end(), run.begin(), run.end()); });
  return all;
}

/// Distance between command and axes when the move is commanded first.
double behind_at_start_mm(const std::vector<TimedSample>& samples, std::uint32_t move) {
  for (const TimedSample& s : samples)
    if (s.move == move && s.feed_command_mm_per_s > 0) return (s.command_mm - s.position_mm).cwiseAbs().maxCoeff();
  ADD_FAILURE() << "move " << move << " is never commanded";
  return 0;
}

TEST(OnePlan, TheControlWaitsInPositionBetweenRapidAndFeed) {
  tests::TestProgram p;
  p.rapid(0, 0, -40).line(20, 0, -40, 2000).rapid(20, 0, 0);
  machine::Machine m = lagging_machine();
  for (const auto path : {machine::RapidPath::dogleg, machine::RapidPath::linear}) {
    m.cycle.rapid_path = path;
    m.control.in_position_mm = 0.02;
    EXPECT_LE(behind_at_start_mm(samples_of(p.program, m), 1), 0.02 + 1e-3);  // one period later
    EXPECT_LE(behind_at_start_mm(samples_of(p.program, m), 2), 0.02 + 1e-1);
    const double waits_s = plan_motion(p.program, m).time_s();
    m.control.in_position_mm = machine::kNoLimit;
    const auto no_wait = samples_of(p.program, m);
    if (path == machine::RapidPath::dogleg) {
      EXPECT_GT(behind_at_start_mm(no_wait, 1), 1.0);
    }
    EXPECT_GT(waits_s, plan_motion(p.program, m).time_s() + 0.1);
  }
}

TEST(OnePlan, ABlockAfterAStopBeginsAtOnceOrWithAPeriod) {
  // From rest to rest a block takes L / v + v / a.
  tests::TestProgram p;
  p.line(1.2345, 0, 0, 600).line(1.2345, 2, 0, 600).dwell(0.0123).line(0, 2, 0, 600);
  machine::Machine m;
  for (machine::Axis& axis : m.axis) axis.acceleration_mm_per_s2 = 1000;
  m.control.corner.law = machine::CornerLaw::exact_stop;
  const double first_s = 1.2345 / 10 + 10 / 1000.0, second_s = 2 / 10.0 + 10 / 1000.0;
  const double period_s = m.control.period_s;
  const auto whole = [&](double t_s) { return std::ceil(t_s / period_s - 1e-9) * period_s; };
  for (const bool starts : {false, true}) {
    m.control.starts_on_period = starts;
    const auto times = plan_motion(p.program, m).times;
    ASSERT_GE(times.size(), 4u);
    const double begin_s = starts ? whole(first_s) : first_s, end_s = begin_s + second_s;
    EXPECT_NEAR(times[1].start_s, begin_s, kMicrosecond);
    EXPECT_NEAR(times[1].end_s(), end_s, kMicrosecond);
    // After a rest it waits in either case.
    EXPECT_NEAR(times[3].start_s, whole(end_s + 0.0123), kMicrosecond);
  }
}

TEST(OnePlan, TheWaitIsWhatTheLoopNeeds) {
  // From a constant acceleration a that ends in rest a first-order loop is a/Kp^2 behind: it comes within w after
  // ln(a / (Kp^2 w)) / Kp.
  tests::TestProgram p;
  p.rapid(0, 0, -40).line(20, 0, -40, 2000);
  machine::Machine m = lagging_machine();
  const double kp = 33, wait_s = std::log(2000 / (kp * kp * 0.02)) / kp;
  EXPECT_NEAR(plan_motion(p.program, m).times.front().wait_s, wait_s, 0.004);
}

TEST(OnePlan, TheAxesStartWhereTheyStand) {
  // Z is not placed until line 3, and goes to an unknown reference point between the cuts.
  const nc::Interpretation program = tests::interpreted(
      "G21 G90\nG0 X300 Y200\nG0 Z5\nG1 Z-1 F1000\nG1 X310 F3000\nG91 G28 Z0\nG90 G0 X0 Y0\nG0 Z5\nG1 Z-1 F1000\n"
      "X20 F3000\nM30\n");
  machine::Machine m = lagging_machine();
  for (const double z : {machine::kNoLimit, 150.0}) {
    m.tool_change.z_mm = z;
    const auto samples = samples_of(program, m);
    for (std::size_t k = 1; k < samples.size(); ++k) {
      ASSERT_LT(samples[k].velocity_mm_per_s.cwiseAbs().maxCoeff(), 20000 / 60.0 * (1 + kRounding)) << samples[k].t_s;
      ASSERT_LT((samples[k].command_mm - samples[k].position_mm).cwiseAbs().maxCoeff(), 20000 / 60.0 / 33);
    }
    const CycleSplit time = cycle_time(program, m).all.time;
    EXPECT_NEAR(plan_motion(program, m).time_s(), time.cutting_s + time.positioning_s, kMicrosecond);
  }
}

TEST(OnePlan, EachAxisOfADogLegKeepsItsOwnSpeed) {
  tests::TestProgram p;
  p.rapid(10, 100, 0).line(20, 100, 0, 1000);
  machine::Machine m = lagging_machine();
  const auto samples = samples_of(p.program, m);
  // X arrives first: the path is bent.
  const auto there = std::ranges::find_if(samples, [](const TimedSample& s) { return s.command_mm.x() >= 10 - 1e-9; });
  ASSERT_NE(there, samples.end());
  EXPECT_LT(there->command_mm.y(), 25);
  m.cycle.rapid_path = machine::RapidPath::linear;
  for (const TimedSample& s : samples_of(p.program, m))
    if (s.move == 0) {
      ASSERT_NEAR(s.command_mm.y(), 10 * s.command_mm.x(), 1e-9);
    }
}

double distance_to_polyline(const Vec3& p, const std::vector<Vec3>& line) {
  double least = INFINITY;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec3 way = line[i] - line[i - 1];
    const double u = std::clamp((p - line[i - 1]).dot(way) / std::max(1e-30, way.squaredNorm()), 0.0, 1.0);
    least = std::min(least, (p - line[i - 1] - u * way).norm());
  }
  return least;
}

TEST(OnePlan, PlacesOfAPositioningAreThoseOfItsMotion) {
  tests::Dice dice(20);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const machine::Machine m = tests::random_machine(seed);
    const Vec3 to(dice.between(-50, 50), dice.between(-50, 50), dice.between(-50, 50));
    tests::TestProgram p;
    p.rapid(to.x(), to.y(), to.z());
    const auto places = positioning_places(m, Vec3::Zero(), to, 0.5);
    EXPECT_EQ(places.front(), Vec3::Zero());
    EXPECT_EQ(places.back(), to);
    for (std::size_t i = 1; i < places.size(); ++i) ASSERT_LE((places[i] - places[i - 1]).norm(), 0.5 + 1e-12);
    for (const TimedSample& s : samples_of(p.program, m)) {
      ASSERT_LT(distance_to_polyline(s.command_mm, places), kBend_mm) << "machine " << seed;
    }
  }
}

TEST(OnePlan, AxesWithoutALimitArriveAtOnce) {
  machine::Machine m;
  EXPECT_EQ(positioning_places(m, {0, 0, 0}, {3, 4, 0}, 1).size(), 6u);
  m.axis[0].max_velocity_mm_per_s = 100;  // Y is there before X begins
  const auto places = positioning_places(m, {0, 0, 0}, {3, 4, 0}, 1);
  EXPECT_LT(distance_to_polyline({0, 4, 0}, places), 1e-6);
  EXPECT_GT(distance_to_polyline({1.5, 2, 0}, places), 1);
}

TEST(OnePlan, ExponentialBlocksMoveAsTheyAreTimed) {
  tests::TestProgram p;
  p.line(100, 0, 0, 4500);
  machine::Machine m;
  m.cycle.acceleration_law = machine::AccelerationLaw::exponential;
  m.cycle.time_constant_1_s = 0.032;
  m.cycle.time_constant_2_s = 0.033;
  EXPECT_NEAR(plan_motion(p.program, m).time_s(), 1.4633, 5e-5);  // Yan & Shirase 1997, eqs. 4-5
  const auto samples = samples_of(p.program, m);
  double fastest = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const double speed = (samples[k].command_mm - samples[k - 1].command_mm).norm() / 0.001;
    fastest = std::max(fastest, speed);
    if (k > 700 && samples[k].t_s < 1.3) {
      ASSERT_NEAR(speed, 75, 0.01);
    }
  }
  EXPECT_LT(fastest, 75.01);
  // At the start as eq. 2 has it; it ends at rest.
  const ExponentialRamp ramp{0, 75, 0.032, 0.033};
  for (const std::size_t k : {20u, 50u, 100u, 1000u})
    ASSERT_NEAR(samples[k].command_mm.x(), ramp.distance_at(samples[k].t_s), 1e-9);
  EXPECT_NEAR(samples[1463].command_mm.x(), 100, 1e-4);
  EXPECT_LT(samples[1463].command_mm.x() - samples[1462].command_mm.x(), 1e-3);
}

/// Each change of speed takes plain + 25 ms, plain = 50, 25 and 25 ms, at the mean of its speeds: 3.75, 3.75 and 1.25
/// mm.
TEST(OnePlan, ABellMakesEachChangeOfSpeedLongerInTimeAndWay) {
  tests::TestProgram p;
  p.line(100, 0, 0, 6000).line(200, 0, 0, 3000);
  machine::Machine m = lagging_machine();
  m.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 1};
  m.cycle.acceleration_law = machine::AccelerationLaw::bell;
  m.cycle.bell_time_s = 0.05;
  EXPECT_NEAR(plan_motion(p.program, m).time_s(), 0.075 + 0.925 + 0.050 + 1.975 + 0.050, 1e-9);
  double last = 0;
  for (const TimedSample& s : samples_of(p.program, m)) {
    ASSERT_LE(last, s.command_mm.x() + 1e-12);
    last = s.command_mm.x();
  }
}

/// A line so short that the acceleration never is a: four parabolas of the speed with the jerk j = a / 25 ms,
/// 4 (L / (2 j))^(1/3). The plan, which adds to the times of constant acceleration, is up to 5.5 % short of it.
TEST(OnePlan, ABellThatIsNotBuiltUpFollowsItsJerk) {
  machine::Machine m = lagging_machine();
  m.cycle.acceleration_law = machine::AccelerationLaw::bell;
  m.cycle.bell_time_s = 0.05;
  constexpr double kJerk = 2000 / 0.025, kShare = 0.06;
  for (const double length_mm : {0.1, 0.2, 0.5, 1.0}) {
    tests::TestProgram p;
    p.line(length_mm, 0, 0, 12000);
    const double time_s = 4 * std::cbrt(length_mm / (2 * kJerk));
    EXPECT_NEAR(plan_motion(p.program, m).time_s(), time_s, kShare * time_s) << length_mm;
  }
}

}  // namespace
}  // namespace camber::feedmodel
