#include "adapt/feed_chooser.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

namespace camber::adapt {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;

std::vector<double> levels_of(const FeedBounds& b) {
  std::vector<double> out;
  for (double f = b.lowest_mm_per_s; f < b.highest_mm_per_s * (1 - 1e-6); f *= 1 + b.step_fraction) out.push_back(f);
  out.push_back(b.highest_mm_per_s);
  return out;
}

/// Consecutive cells of one feed.
struct Run {
  std::size_t from = 0, end = 0;
  double feed = 0, ceiling = 0, reachable = 0, length_mm = 0;
};

class Planner {
 public:
  Planner(const FeedCells& cells, const FeedCeiling& ceiling, const FeedBounds& bounds)
      : cells_(cells), ceiling_(ceiling), bounds_(bounds), levels_(levels_of(bounds)) {}

  std::vector<double> plan() const {
    std::vector<double> out(cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) out[i] = cells_[i].feed_mm_per_s;
    for (const auto& [from, end] : cells_.chains())
      for (std::size_t a = from; a < end;) {
        std::size_t b = a;
        while (b < end && is_free(b)) ++b;
        if (b > a) plan_stretch(a, b, out);
        a = std::max(b, a + 1);
      }
    return out;
  }

 private:
  bool is_free(std::size_t i) const { return cells_[i].kept == Kept::no && ceiling_.allowed_mm_per_s[i] >= 0; }

  /// Greatest level within the ceiling of a cell; the lowest where there is none.
  std::size_t top_level(std::size_t i) const {
    const auto above =
        std::ranges::upper_bound(levels_, ceiling_.allowed_mm_per_s[i] * (1 + kRounding)) - levels_.begin();
    return above > 0 ? static_cast<std::size_t>(above - 1) : 0;
  }

  void plan_stretch(std::size_t from, std::size_t end, std::vector<double>& out) const {
    std::vector<Run> runs = runs_of(from, cheapest_levels(from, end));
    lower_short_rises(runs);
    runs = merged(runs);
    for (const Run& run : runs)
      for (std::size_t i = run.from; i < run.end; ++i) out[i] = feed_of(run, i);
  }

  std::vector<std::size_t> cheapest_levels(std::size_t from, std::size_t end) const {
    const std::size_t count = levels_.size();
    std::vector<double> cost(count, 0.0), next(count);
    std::vector<std::uint16_t> came((end - from) * count);
    for (std::size_t i = from; i < end; ++i) {
      const auto cheapest = static_cast<std::size_t>(std::ranges::min_element(cost) - cost.begin());
      const double change = cost[cheapest] + bounds_.change_s;
      const std::size_t top = top_level(i);
      for (std::size_t k = 0; k < count; ++k) {
        const bool stays = i == from || cost[k] <= change;
        came[(i - from) * count + k] = static_cast<std::uint16_t>(stays ? k : cheapest);
        const double time = cells_[i].length_mm / std::min(levels_[k], ceiling_.reachable_mm_per_s[i]);
        next[k] = k > top ? kInf : (stays ? cost[k] : change) + time;
      }
      cost.swap(next);
    }
    auto k = static_cast<std::size_t>(std::ranges::min_element(cost) - cost.begin());
    std::vector<std::size_t> out(end - from);
    for (std::size_t i = end; i-- > from;) {
      out[i - from] = k;
      k = came[(i - from) * count + k];
    }
    return out;
  }

  Run run_of(std::size_t from, std::size_t end) const {
    Run run{from, end, 0, kInf, 0, 0};
    for (std::size_t i = from; i < end; ++i) {
      run.ceiling = std::min(run.ceiling, ceiling_.allowed_mm_per_s[i]);
      run.reachable = std::max(run.reachable, ceiling_.reachable_mm_per_s[i]);
      run.length_mm += cells_[i].length_mm;
    }
    run.feed = std::clamp(std::min(run.ceiling, run.reachable), bounds_.lowest_mm_per_s, bounds_.highest_mm_per_s);
    return run;
  }

  std::vector<Run> runs_of(std::size_t from, const std::vector<std::size_t>& level) const {
    std::vector<Run> out;
    for (std::size_t a = 0; a < level.size();) {
      std::size_t b = a + 1;
      while (b < level.size() && level[b] == level[a]) ++b;
      out.push_back(run_of(from + a, from + b));
      a = b;
    }
    return out;
  }

  bool splits_a_move(const Run& run) const { return cells_[run.from].from > 0 || cells_[run.end - 1].to < 1; }

  /// A short block between two slower ones is as slow as the faster of them.
  void lower_short_rises(std::vector<Run>& runs) const {
    for (std::size_t r = 1; r + 1 < runs.size(); ++r) {
      const double beside = std::max(runs[r - 1].feed, runs[r + 1].feed);
      if (runs[r].length_mm < bounds_.min_length_mm && splits_a_move(runs[r]) && runs[r].feed > beside)
        runs[r].ceiling = runs[r].feed = beside;
    }
  }

  std::vector<Run> merged(const std::vector<Run>& runs) const {
    std::vector<Run> out;
    for (const Run& next : runs) {
      out.push_back(next);
      while (out.size() > 1) {
        const Run &a = out[out.size() - 2], &b = out.back();
        const double low = std::min(a.feed, b.feed), high = std::max(a.feed, b.feed);
        if (high > low * (1 + bounds_.step_fraction)) break;
        Run both = run_of(a.from, b.end);
        both.feed = low;
        out.pop_back();
        out.back() = both;
      }
    }
    return out;
  }

  /// The programmed feed where nothing is gained by another one.
  double feed_of(const Run& run, std::size_t i) const {
    const double given = cells_[i].feed_mm_per_s;
    const bool allowed = given <= bounds_.highest_mm_per_s * (1 + kRounding) && given >= bounds_.lowest_mm_per_s;
    const bool near = std::abs(run.feed - given) <= bounds_.step_fraction * given && given <= run.ceiling;
    const bool slower_anyway =
        given > run.feed && run.reachable <= run.feed * (1 + kRounding) && run.reachable < run.ceiling;
    return allowed && (near || slower_anyway) ? given : run.feed;
  }

  const FeedCells& cells_;
  const FeedCeiling& ceiling_;
  const FeedBounds& bounds_;
  std::vector<double> levels_;
};

}  // namespace

std::vector<double> plan_feeds(const FeedCells& cells, const FeedCeiling& ceiling, const FeedBounds& bounds) {
  return Planner(cells, ceiling, bounds).plan();
}

std::vector<double> least_within(const FeedCells& cells, std::span<const double> values, double reach_mm) {
  std::vector<double> out(values.begin(), values.end());
  const auto value = [&](std::size_t i) { return values[i] < 0 ? kInf : values[i]; };
  for (const auto& [from, end] : cells.chains()) {
    std::deque<std::size_t> window;  // ascending values
    std::size_t ahead = from;
    for (std::size_t i = from; i < end; ++i) {
      const double begins = cells[i].along_mm - cells[i].length_mm;
      for (; ahead < end &&
             (ahead <= i || cells[ahead].along_mm - cells[ahead].length_mm <= cells[i].along_mm + reach_mm);
           ++ahead) {
        while (!window.empty() && value(window.back()) >= value(ahead)) window.pop_back();
        window.push_back(ahead);
      }
      while (window.front() < i && cells[window.front()].along_mm < begins - reach_mm) window.pop_front();
      if (values[i] >= 0) out[i] = value(window.front());
    }
  }
  return out;
}

}  // namespace camber::adapt
