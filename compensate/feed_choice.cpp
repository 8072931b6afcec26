#include "compensate/feed_choice.h"

#include <algorithm>
#include <cmath>

namespace camber::compensate {
namespace {

constexpr double kOver = 0.05;      // of the area may exceed a 95th percentile
constexpr double kChange_s = 0.05;  // what a change of feed is worth
constexpr double kLevelRatio = 0.85;
constexpr int kHalvings = 24;

double extra_s(const FeedUnit& u, double fraction) {
  return std::max(0.0, u.length_mm / (fraction * u.feed_mm_per_s) - u.time_s);
}

/// A point's error at full feed and its area.
struct Sample {
  double error_mm, area_mm2;
};

class Chooser {
 public:
  Chooser(std::span<const FeedUnit> units, std::span<const SpeedPoint> points, std::span<const double> now,
          const FeedModel& model)
      : units_(units), model_(model), levels_(feed_levels(lowest(units))), of_unit_(units.size()) {
    for (const SpeedPoint& p : points) {
      of_unit_[p.unit].push_back({p.error_mm / std::pow(now[p.unit], model.exponent), p.area_mm2});
      area_ += p.area_mm2;
    }
    for (auto& samples : of_unit_)
      std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.error_mm > b.error_mm; });
    for (std::size_t u = 0; u < units.size(); ++u)
      for (std::size_t k = 0; k < levels_.size(); ++k) shrink_.push_back(std::pow(fraction(u, k), model.exponent));
  }

  struct Solution {
    std::vector<std::size_t> level;
    double over = 0, extra_s = 0;
  };

  /// The cheapest feeds that leave no more than 5 % of the area over tau; `reached` says whether there are such.
  Solution cheapest(double tau_mm, bool& reached) const {
    const std::vector<double> over = over_areas(tau_mm);
    Solution best = solve(over, 0);
    reached = best.over <= kOver * area_;
    if (!reached) return best;
    double low = 0, high = 1;  // of lambda, mm^2/s
    for (int i = 0; i < kHalvings; ++i) {
      Solution s = solve(over, high);
      if (s.over > kOver * area_) break;
      best = std::move(s);
      low = high;
      high *= 4;
    }
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      Solution s = solve(over, middle);
      if (s.over > kOver * area_) {
        high = middle;
      } else {
        low = middle;
        best = std::move(s);
      }
    }
    return best;
  }

  double largest_mm() const {
    double largest = 0;
    for (const auto& samples : of_unit_)
      if (!samples.empty()) largest = std::max(largest, samples.front().error_mm);
    return largest;
  }
  double fraction(std::size_t unit, std::size_t level) const { return std::max(levels_[level], units_[unit].least); }

 private:
  static double lowest(std::span<const FeedUnit> units) {
    double out = 1;
    for (const FeedUnit& u : units) out = std::min(out, u.least);
    return out;
  }

  /// Area over tau, by unit and level.
  std::vector<double> over_areas(double tau_mm) const {
    std::vector<double> out(units_.size() * levels_.size(), 0.0);
    for (std::size_t u = 0; u < units_.size(); ++u)
      for (std::size_t k = 0; k < levels_.size(); ++k) {
        const std::size_t at = u * levels_.size() + k;
        for (const Sample& s : of_unit_[u]) {
          if (s.error_mm * shrink_[at] <= tau_mm) break;
          out[at] += s.area_mm2;
        }
      }
    return out;
  }

  Solution solve(const std::vector<double>& over, double lambda) const {
    Solution out;
    out.level.assign(units_.size(), 0);
    for (std::size_t from = 0; from < units_.size();) {
      std::size_t end = from + 1;
      while (end < units_.size() && units_[end].chain == units_[from].chain) ++end;
      solve_chain(over, lambda, from, end, out);
      from = end;
    }
    return out;
  }

  void solve_chain(const std::vector<double>& over, double lambda, std::size_t from, std::size_t end,
                   Solution& out) const {
    const std::size_t count = levels_.size();
    const double change = std::max(lambda, 1e-9) * kChange_s;
    std::vector<double> cost(count, 0.0);
    std::vector<std::size_t> came((end - from) * count);
    for (std::size_t u = from; u < end; ++u) {
      const auto cheapest = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
      std::vector<double> next(count);
      for (std::size_t k = 0; k < count; ++k) {
        const bool stays = u == from || cost[k] <= cost[cheapest] + change;
        came[(u - from) * count + k] = stays ? k : cheapest;
        next[k] = (stays ? cost[k] : cost[cheapest] + change) + over[u * count + k] +
                  std::max(lambda, 1e-9) * model_.time_scale * extra_s(units_[u], fraction(u, k));
      }
      cost = std::move(next);
    }
    auto k = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (std::size_t u = end; u-- > from;) {
      out.level[u] = k;
      out.over += over[u * count + k];
      out.extra_s += model_.time_scale * extra_s(units_[u], fraction(u, k));
      k = came[(u - from) * count + k];
    }
  }

  std::span<const FeedUnit> units_;
  FeedModel model_;
  std::vector<double> levels_;
  std::vector<double> shrink_;                ///< factor on the error, by unit and level
  std::vector<std::vector<Sample>> of_unit_;  ///< the largest error first
  double area_ = 0;
};

}  // namespace

std::vector<double> feed_levels(double least) {
  std::vector<double> out;
  for (double level = 1; level > least * 1.02; level *= kLevelRatio) out.push_back(level);
  out.push_back(least);
  return out;
}

FeedChoice choose_feeds(std::span<const FeedUnit> units, std::span<const SpeedPoint> points,
                        std::span<const double> now, const FeedModel& model, double budget_s, double wanted_mm) {
  const Chooser chooser(units, points, now, model);
  double high = chooser.largest_mm(), low = wanted_mm;  // of tau
  bool reached = false;
  Chooser::Solution best = chooser.cheapest(high, reached);
  double error = high;
  if (low < high) {
    Chooser::Solution s = chooser.cheapest(low, reached);
    if (reached && s.extra_s <= budget_s) {
      best = std::move(s);
      error = low;
      high = low;
    }
  }
  for (int i = 0; i < kHalvings && high - low > 1e-3 * high; ++i) {
    const double middle = 0.5 * (low + high);
    Chooser::Solution s = chooser.cheapest(middle, reached);
    if (reached && s.extra_s <= budget_s) {
      high = error = middle;
      best = std::move(s);
    } else {
      low = middle;
    }
  }
  FeedChoice out{{}, best.extra_s, error};
  for (std::size_t u = 0; u < units.size(); ++u) out.fraction.push_back(chooser.fraction(u, best.level[u]));
  return out;
}

}  // namespace camber::compensate
