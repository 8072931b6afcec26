// Chosen feeds against every combination of feeds, where there are few enough to try them all.
#include "compensate/feed_choice.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

constexpr FeedModel kModel{.exponent = 0.8, .time_scale = 1};
constexpr double kLeast = 0.5;

struct Case {
  std::vector<FeedUnit> units;
  std::vector<SpeedPoint> points;
};

/// Each unit a chain of its own, so that a change of feed between units costs the same for every combination.
Case random_case(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> length(5, 40), error(0.001, 0.02), scatter(0.7, 1.3);
  Case out;
  for (std::size_t u = 0; u < count; ++u) {
    const double mm = length(random), mean = error(random);
    out.units.push_back({.chain = u, .length_mm = mm, .time_s = mm / 15, .feed_mm_per_s = 15, .least = kLeast});
    for (int i = 0; i < 40; ++i) out.points.push_back({u, mean * scatter(random), mm / 40});
  }
  return out;
}

double p95(const Case& c, const std::vector<double>& fraction) {
  std::vector<std::pair<double, double>> errors;
  double area = 0, over = 0;
  for (const SpeedPoint& p : c.points) {
    errors.emplace_back(p.error_mm * std::pow(fraction[p.unit], kModel.exponent), p.area_mm2);
    area += p.area_mm2;
  }
  std::sort(errors.rbegin(), errors.rend());
  for (const auto& [error, of] : errors)
    if ((over += of) > 0.05 * area) return error;
  return 0;
}

double extra_s(const Case& c, const std::vector<double>& fraction) {
  double out = 0;
  for (std::size_t u = 0; u < c.units.size(); ++u)
    out += c.units[u].length_mm / (fraction[u] * c.units[u].feed_mm_per_s) - c.units[u].time_s;
  return out;
}

double best_of_all(const Case& c, double budget_s) {
  const std::vector<double> levels = feed_levels(kLeast);
  std::vector<double> fraction(c.units.size(), 1.0);
  double best = 1;
  const auto all = static_cast<std::size_t>(std::pow(levels.size(), c.units.size()));
  for (std::size_t n = 0; n < all; ++n) {
    std::size_t rest = n;
    for (double& f : fraction) {
      f = levels[rest % levels.size()];
      rest /= levels.size();
    }
    if (extra_s(c, fraction) <= budget_s) best = std::min(best, p95(c, fraction));
  }
  return best;
}

TEST(FeedPlan, IsWithinATenthOfEveryCombinationTried) {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    const Case c = random_case(5, seed);
    const std::vector<double> now(c.units.size(), 1.0);
    double time = 0;
    for (const FeedUnit& u : c.units) time += u.time_s;
    for (const double share : {0.05, 0.15, 0.5}) {
      const double budget = share * time;
      const FeedChoice chosen = choose_feeds(c.units, c.points, now, kModel, budget, 0);
      EXPECT_LE(extra_s(c, chosen.fraction), budget * 1.0001);
      EXPECT_LE(p95(c, chosen.fraction), 1.1 * best_of_all(c, budget)) << "seed " << seed << ", budget " << share;
    }
  }
}

TEST(FeedPlan, SpendsNoMoreThanTheToleranceTakes) {
  const Case c = random_case(5, 7);
  const std::vector<double> now(c.units.size(), 1.0);
  const double wanted = 0.8 * p95(c, now);
  const FeedChoice chosen = choose_feeds(c.units, c.points, now, kModel, 1e9, wanted);
  EXPECT_LE(p95(c, chosen.fraction), wanted);
  EXPECT_LT(chosen.extra_s, choose_feeds(c.units, c.points, now, kModel, 1e9, 0.9 * wanted).extra_s);
}

TEST(FeedPlan, KeepsFeedsTogetherAlongAChain) {
  // Every second of many short units has an error: a word for each would change the feed forty times.
  std::vector<FeedUnit> units;
  std::vector<SpeedPoint> points;
  for (std::size_t u = 0; u < 40; ++u) {
    units.push_back({.chain = 0, .length_mm = 0.1, .time_s = 0.1 / 15, .feed_mm_per_s = 15, .least = 0.2});
    points.push_back({u, u % 2 == 0 ? 0.01 : 0.001, 1.0});
  }
  const std::vector<double> now(units.size(), 1.0);
  const FeedChoice chosen = choose_feeds(units, points, now, kModel, 1e9, 0.006);
  int changes = 0;
  for (std::size_t u = 1; u < units.size(); ++u) changes += chosen.fraction[u] != chosen.fraction[u - 1] ? 1 : 0;
  EXPECT_LE(changes, 4);
  EXPECT_LT(chosen.fraction[20], 0.6);
}

TEST(FeedPlan, TakesNoTimeWhereTheControlIsSlowerThanTheFeed) {
  // The axes reach a fifth of the feed here: half the feed costs nothing.
  const std::vector<FeedUnit> units{{.chain = 0, .length_mm = 1, .time_s = 1 / 3.0, .feed_mm_per_s = 15, .least = 0.5}};
  const std::vector<SpeedPoint> points{{0, 0.01, 1.0}};
  const std::vector<double> now{1.0};
  EXPECT_EQ(choose_feeds(units, points, now, kModel, 0, 0).extra_s, 0);
}

TEST(FeedPlan, NoUnitIsSlowerThanItsLeast) {
  std::vector<FeedUnit> units;
  std::vector<SpeedPoint> points;
  for (std::size_t u = 0; u < 3; ++u) {
    units.push_back(
        {.chain = u, .length_mm = 1, .time_s = 1 / 15.0, .feed_mm_per_s = 15, .least = u == 1 ? 0.13 : 0.2});
    points.push_back({u, u == 1 ? 0.04 : 0.02, 1.0});
  }
  const std::vector<double> now(units.size(), 1.0);
  const FeedChoice chosen = choose_feeds(units, points, now, kModel, 1e9, 0);
  EXPECT_EQ(chosen.fraction[1], 0.13) << "the worst of them";
  EXPECT_GE(chosen.fraction[0], 0.2);
  EXPECT_LT(chosen.fraction[0], 1);
}

TEST(FeedPlan, LevelsEndAtTheLeast) {
  const std::vector<double> levels = feed_levels(0.2);
  EXPECT_EQ(levels.front(), 1);
  EXPECT_EQ(levels.back(), 0.2);
  EXPECT_TRUE(std::is_sorted(levels.rbegin(), levels.rend()));
  EXPECT_EQ(feed_levels(1), std::vector<double>{1});
}

}  // namespace
}  // namespace camber::compensate
