// The rule by which feed and depths follow the load: alone, and on cuts whose force it does not know beforehand.
#include "copymill/load_follower.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "copymill/runner.h"
#include "simulate/load_probe.h"
#include "tests/support/cutting.h"

namespace camber::copymill {

using removal::Stamp;

namespace {

LoadBand band_of(double limit, int teeth = 1) {
  LoadBand band;
  band.limit = limit, band.teeth = teeth;
  return band;
}

constexpr LoadConditions kNominal{20, 4, 3};

/// A passing of this load where the feed is the nominal one; loads are proportional to the feed.
void feel(LoadRule& rule, double load_at_nominal, double hardness = 1) {
  const double feed = rule.conditions().feed_mm_per_s, load = load_at_nominal * feed / kNominal.feed_mm_per_s;
  rule.feel({0, Vec3::Zero(), load * hardness, load, feed});
}

}  // namespace

TEST(LoadRule, BelowTheBandTheFeedRisesByStepsOfTheNominalOneATurn) {
  LoadRule rule(band_of(100, 4), kNominal);
  std::vector<double> feeds;
  for (int k = 0; k < 40; ++k) {
    feel(rule, 30);
    if (k % 4 == 3) feeds.push_back(rule.conditions().feed_mm_per_s);
  }
  const std::vector<double> expected{22, 24, 26, 28, 30, 30, 30, 30, 30, 30};  // to 150 %
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(feeds[i], expected[i], 1e-12) << i;
  ASSERT_EQ(rule.log().size(), 5u);
  EXPECT_EQ(rule.log()[0].cause, Cause::below_band);
  EXPECT_EQ(rule.log()[0].from, 20);
  EXPECT_NEAR(rule.log()[0].share, 0.3, 1e-12);
}

TEST(LoadRule, AFeedBoundWinsAndNoStepLeadsOverTheAim) {
  LoadBand band = band_of(100);
  band.max_feed_mm_per_s = 23;
  LoadRule bound(band, kNominal), free(band_of(100), kNominal);
  for (int k = 0; k < 10; ++k) feel(bound, 30), feel(free, 79);
  EXPECT_EQ(bound.conditions().feed_mm_per_s, 23);
  EXPECT_NEAR(free.conditions().feed_mm_per_s, 22, 1e-9);  // 79 % to 86.9 %, in the band
}

TEST(LoadRule, OverTheLimitTheFeedFallsAtOnceInProportion) {
  LoadRule rule(band_of(100), kNominal);
  feel(rule, 150);
  EXPECT_NEAR(rule.conditions().feed_mm_per_s, 20 * 0.9 / 1.5, 1e-12);
  feel(rule, 300);
  EXPECT_NEAR(rule.conditions().feed_mm_per_s, 10, 1e-12);  // 50 %
  EXPECT_EQ(rule.log().back().cause, Cause::over_limit);
}

TEST(LoadRule, PassingsCutFasterThanCommandedAreNotCountedTwice) {
  LoadRule rule(band_of(100), kNominal);
  rule.feel({0, Vec3::Zero(), 120, 120, 20});
  const double feed = rule.conditions().feed_mm_per_s;
  rule.feel({0, Vec3::Zero(), 115, 115, 19});  // still braking
  EXPECT_NEAR(rule.conditions().feed_mm_per_s, feed, 1e-9);
}

TEST(LoadRule, OfATurnTheGreatestToothCounts) {
  LoadRule rule(band_of(100, 2), kNominal);
  for (int k = 0; k < 40; ++k) feel(rule, k % 2 ? 95 : 40);  // run-out
  EXPECT_EQ(rule.conditions().feed_mm_per_s, 20);
}

TEST(LoadRule, InAirTheFeedDoesNotRise) {
  LoadRule rule(band_of(100, 2), kNominal);
  for (int k = 0; k < 100; ++k) rule.feel({0, Vec3::Zero(), 0, 0, 20});
  EXPECT_EQ(rule.conditions().feed_mm_per_s, 20);
  for (int k = 0; k < 20; ++k) feel(rule, 30);
  EXPECT_GT(rule.conditions().feed_mm_per_s, 25);
  for (int k = 0; k < 3; ++k) rule.feel({0, Vec3::Zero(), 0, 0, 20});
  EXPECT_EQ(rule.conditions().feed_mm_per_s, 20);
  EXPECT_EQ(rule.log().back().cause, Cause::in_air);
}

TEST(LoadRule, AtTheLowestFeedRadialDepthFallsFirstThenAxialDepth) {
  LoadBand band = band_of(100, 2);
  band.lowest_depth = 0.6;
  LoadRule rule(band, kNominal);
  double load = 250;  // 125 % at the lowest feed
  std::vector<Quantity> fell;
  for (int k = 0; k < 60; ++k) {
    feel(rule, load);
    if (!rule.replan()) continue;
    const Change& change = rule.log().back();
    EXPECT_EQ(change.cause, Cause::over_at_lowest_feed);
    fell.push_back(change.what);
    rule.replanned();
  }
  ASSERT_GE(fell.size(), 3u);
  // To 80 % or, in proportion, to 0.9 / 1.25 = 72 %, then to the lowest of 60 %; then the axial depth.
  EXPECT_EQ(fell[0], Quantity::radial_depth);
  EXPECT_EQ(fell[1], Quantity::radial_depth);
  EXPECT_EQ(fell[2], Quantity::axial_depth);
  EXPECT_NEAR(rule.conditions().radial_mm, 0.6 * 4, 1e-12);
  EXPECT_LT(rule.conditions().axial_mm, 3);
}

TEST(LoadRule, DepthsRiseAgainInReverseWhereTheLoadAllows) {
  LoadBand band = band_of(100, 1);
  band.lowest_depth = 0.8;
  LoadRule rule(band, kNominal);
  for (int k = 0; k < 20; ++k) {
    feel(rule, 300);
    if (rule.replan()) rule.replanned();
  }
  ASSERT_NEAR(rule.conditions().radial_mm, 3.2, 1e-9);
  ASSERT_NEAR(rule.conditions().axial_mm, 2.4, 1e-9);
  std::vector<Quantity> rose;
  for (int k = 0; k < 100; ++k) {
    const LoadConditions before = rule.conditions();
    feel(rule, 70);
    if (rule.conditions().axial_mm > before.axial_mm) rose.push_back(Quantity::axial_depth);
    if (rule.conditions().radial_mm > before.radial_mm) rose.push_back(Quantity::radial_depth);
    EXPECT_FALSE(rule.replan());
  }
  EXPECT_EQ(rose, (std::vector<Quantity>{Quantity::axial_depth, Quantity::radial_depth}));
  EXPECT_NEAR(rule.conditions().radial_mm, 4, 1e-9);
}

TEST(LoadRule, ALookAheadCountsWithTheHardnessThatIsFelt) {
  LoadRule rule(band_of(100), kNominal);
  // 30 N of edges and 3.5 N per mm/s: 100 N at 20 mm/s.
  EXPECT_NEAR(rule.feed_ahead(100, 65, 20), 20, 1e-9);
  EXPECT_NEAR(rule.feed_ahead(65, 47.5, 10), 20, 1e-9);
  EXPECT_NEAR(rule.feed_ahead(200, 130, 20), 10, 1e-9);
  EXPECT_EQ(rule.feed_ahead(0, 0, 20), 30);
  // Remembered of the place: 1.59 / 1.06 = 1.5 is kept.
  EXPECT_NEAR(rule.feed_ahead(100, 65, 20, 1.59), (100 / 1.5 - 30) / 3.5, 1e-9);
  EXPECT_NEAR(rule.feed_ahead(100, 65, 20, 0.7), 20, 1e-9);
  for (int k = 0; k < 3; ++k) feel(rule, 60, 1.25);
  EXPECT_NEAR(rule.hardness(), 1.25, 1e-9);
  EXPECT_NEAR(rule.feed_ahead(100, 65, 20, 1.2), (80 - 30) / 3.5, 1e-9);
  EXPECT_NEAR(rule.feed_ahead(100, 65, 20), (80 - 30) / 3.5, 1e-9);
  for (int k = 0; k < 200; ++k) feel(rule, 60);
  EXPECT_NEAR(rule.hardness(), 1, 1e-3);
}

namespace {

/// A straight cut along x whose tip is 2 mm under a block that is higher from x = 25 on.
struct ScriptedCut {
  double height_after_mm = 0;  ///< of the block after the step, over the one before
  std::vector<simulate::ForceRegion> regions{};
  double limit_N = 0;
};

struct Cutting {
  std::vector<double> x, share, feed;  ///< of the passings in material: load over limit
  std::vector<Change> log;
  double time_s = 0;
};

constexpr double kEnd_mm = 55, kTick_s = 0.004, kAcceleration = 1000, kRpm = 6000;
constexpr int kTeeth = 4;
constexpr LoadConditions kFeeds{24, 3, 2};

/// The loop of a control that makes its path while it cuts: looks, motion of a tick, passings, rule.
Cutting run(const ScriptedCut& how, bool follows) {
  const Vec3 lo(0, -6, -6);
  const auto distance = [&](const Vec3& p) {
    return std::min(removal::box_distance_mm(p, lo, {60, 6, 0}),
                    removal::box_distance_mm(p, {25, -6, -6}, {60, 6, how.height_after_mm}));
  };
  removal::Stock stock(distance, lo, {60, 6, how.height_after_mm}, 0.25, 4);
  const machine::Tool tool = testing::make_tool(machine::ToolType::flat, 8, kTeeth, 35);
  const Vec3 start(-5, -6 - 4 + 3, -2);
  const simulate::ForceRegions regions(how.regions);
  simulate::LoadProbe probe(stock, tool, {1800, 600, 300, 20, 25, 2}, {start, start + Vec3(65, 0, 0)},
                            {.envelope_step_mm = 0.2, .rotation_step_rad = kPi / 90, .regions = &regions});
  LoadRule rule(band_of(how.limit_N, kTeeth), kFeeds);
  constexpr double kPassing_s = 60 / (kRpm * kTeeth);
  const auto stamp_at = [&](double s, double feed_per_tooth) {
    Stamp stamp;
    stamp.pose.tip_mm = start + Vec3(s, 0, 0);
    stamp.feed_per_tooth_mm = {feed_per_tooth, 0, 0};
    return stamp;
  };
  const auto look = [&](double s, double feed) { return probe.look(stamp_at(s, feed * kPassing_s)).lateral_max_N; };
  Cutting out;
  double at = 0, speed = 0, t = 0, next_passing = 0, at_last = 0;
  while (start.x() + at < kEnd_mm) {
    std::vector<SpeedLimit> ahead;
    const double braking = stopping_distance_mm(1.5 * kFeeds.feed_mm_per_s, kAcceleration), feed = std::max(speed, 1.0);
    for (const double s : {0.3 * braking, braking, 2 * braking})
      if (follows) ahead.push_back({s, rule.feed_ahead(look(at + s, feed), look(at + s, feed / 2), feed)});
    const double wanted = follows ? rule.conditions().feed_mm_per_s : kFeeds.feed_mm_per_s;
    const TickMotion motion = next_tick(speed, wanted, ahead, kAcceleration, kTick_s);
    for (; next_passing < t + kTick_s; next_passing += kPassing_s) {
      const double u = next_passing - t, s = at + speed * u + 0.5 * (motion.speed_mm_per_s - speed) / kTick_s * u * u;
      if (s - at_last < 1e-9) continue;
      const Stamp stamp = stamp_at(s, s - at_last);
      const simulate::ProbedLoad load = probe.append({&stamp, 1})[0];
      const double force = load.felt.lateral_max_N, actual = (s - at_last) / kPassing_s;
      rule.feel({next_passing, stamp.pose.tip_mm, force, load.expected.lateral_max_N, actual});
      if (force > 0)
        out.x.push_back(stamp.pose.tip_mm.x()), out.share.push_back(force / how.limit_N), out.feed.push_back(actual);
      at_last = s;
    }
    at += motion.distance_mm, speed = motion.speed_mm_per_s, t += kTick_s;
  }
  out.time_s = t;
  out.log = rule.log();
  return out;
}

double peak(const Cutting& c) { return *std::ranges::max_element(c.share); }

/// Of the passings between two places that no bound of the feed binds, the share between 80 and 105 % of the limit.
double in_band(const Cutting& c, double from, double to) {
  double in = 0, all = 0;
  for (std::size_t k = 0; k < c.x.size(); ++k) {
    if (c.x[k] < from || c.x[k] > to) continue;
    if (c.feed[k] > 0.99 * 1.5 * kFeeds.feed_mm_per_s || c.feed[k] < 1.01 * 0.5 * kFeeds.feed_mm_per_s) continue;
    ++all;
    in += c.share[k] >= 0.8 && c.share[k] <= 1.05;
  }
  EXPECT_GT(all, 50);
  return in / all;
}

}  // namespace

TEST(LoadRuleOnCuts, AStepOfTheStockIsMetWithinTheLimit) {
  ScriptedCut how{2.0, {}, 1};
  const Cutting known = run(how, false);  // in newtons, at the nominal feed
  how.limit_N = 0.85 * peak(known);
  const Cutting constant = run(how, false), follows = run(how, true);
  EXPECT_NEAR(peak(constant), 1 / 0.85, 1e-6);
  EXPECT_LT(peak(follows), 1.1);
  EXPECT_GT(in_band(follows, 5, 20), 0.95);
  EXPECT_GT(in_band(follows, 32, 54), 0.95);
  std::printf("step: constant %.3f s with a peak of %.3f, following %.3f s, peak %.3f, in band %.3f %.3f\n",
              constant.time_s, peak(constant), follows.time_s, peak(follows), in_band(follows, 5, 20),
              in_band(follows, 32, 54));
}

TEST(LoadRuleOnCuts, APartThatIsHarderThanAnyoneKnowsKeepsTheLimitByWhatIsFelt) {
  ScriptedCut how{0.0, {}, 1};
  const Cutting known = run(how, false);
  how.limit_N = 1.1 * peak(known);
  how.regions = {{{20, -100, -100}, {38, 100, 100}, 1.4}};
  const Cutting constant = run(how, false), follows = run(how, true);
  EXPECT_GT(peak(constant), 1.25);
  EXPECT_LT(peak(follows), 1.2);
  EXPECT_GT(in_band(follows, 5, 16), 0.95);
  EXPECT_GT(in_band(follows, 21, 34), 0.95);
  EXPECT_GT(in_band(follows, 44, 54), 0.95);
  EXPECT_TRUE(std::ranges::any_of(follows.log, [](const Change& c) {
    return c.cause == Cause::over_limit && c.place_mm.x() > 15 && c.place_mm.x() < 22;
  }));
  std::printf("hard: constant %.3f s with a peak of %.3f, following %.3f s, peak %.3f, in band %.3f %.3f %.3f\n",
              constant.time_s, peak(constant), follows.time_s, peak(follows), in_band(follows, 5, 16),
              in_band(follows, 21, 34), in_band(follows, 44, 54));
}

}  // namespace camber::copymill
