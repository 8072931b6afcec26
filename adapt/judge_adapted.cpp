#include "adapt/adapter.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace camber::adapt {
namespace {

constexpr double kLowest = 1.02;  // of the lowest feed: as good as the lowest

class Judge {
 public:
  Judge(const FeedCandidate& candidate, const ObservedLoads& loads, const FeedCells& cells,
        const simulate::SimulatedProgram& given, const FeedBounds& bounds)
      : candidate_(candidate), loads_(loads), cells_(cells), given_(given), bounds_(bounds) {}

  OverReason reason_of(std::size_t k) const {
    const std::size_t c = loads_.points[k].cell;
    if (c == FeedCells::kNone || cells_[c].kept == Kept::plunge || cells_[c].kept == Kept::unknown_load)
      return OverReason::plunge;
    if (cells_[c].kept == Kept::not_editable) return OverReason::not_editable;
    const double lowest = kLowest * bounds_.lowest_mm_per_s;
    const bool slow = candidate_.feed_mm_per_s[c] <= lowest || loads_.points[k].load.feed_mm_per_s <= lowest;
    return slow ? OverReason::lowest_feed : OverReason::control;
  }

  OverLimit over(std::size_t k, const LoadLimit& limit, double value, OverReason reason) const {
    const auto& stamp = candidate_.program.path.stamps[k];
    const auto place = candidate_.map.given(stamp.move, stamp.fraction);
    return {given_.moves_in_part().moves[place.move].block + 1,
            candidate_.program.moves_in_part().moves[stamp.move].block + std::size_t{1},
            limit,
            value,
            loads_.points[k].load.feed_mm_per_s,
            reason};
  }

  /// The worst place of each block over the limit; what lies in those blocks does not count for max_elsewhere.
  void add_upper(const LoadLimit& limit, Verdict& out) const {
    std::map<std::size_t, OverLimit> blocks;  // by line of the emitted program
    LoadFigure figure{limit};
    for (std::size_t k = 0; k < loads_.points.size(); ++k) {
      const LoadPoint& p = loads_.points[k].load;
      const double value = p.at(limit.load, p.feed_mm_per_s), share = value / limit.value;
      figure.max_after = std::max(figure.max_after, value);
      if (const std::size_t c = loads_.points[k].cell; c != FeedCells::kNone)
        out.of_cell[c] = std::max(out.of_cell[c], share);
      if (share <= kOverLimit) continue;
      const OverReason reason = reason_of(k);
      if (reason == OverReason::control) out.excess = std::max(out.excess, share);
      const OverLimit o = over(k, limit, value, reason);
      auto [at, added] = blocks.emplace(o.new_line, o);
      if (!added && o.value > at->second.value) at->second = o;
    }
    for (std::size_t k = 0; k < loads_.points.size(); ++k) {
      const LoadPoint& p = loads_.points[k].load;
      const std::size_t line =
          candidate_.program.moves_in_part().moves[candidate_.program.path.stamps[k].move].block + 1;
      const double value = p.at(limit.load, p.feed_mm_per_s);
      if (!blocks.contains(line)) figure.max_elsewhere = std::max(figure.max_elsewhere, value);
    }
    out.peak = std::max(out.peak, figure.max_elsewhere / limit.value);
    out.figures.push_back(figure);
    for (const auto& [line, o] : blocks) out.over.push_back(o);
  }

  /// Blocks whose thickest chip is too thin although it is in the cut.
  void add_lower(const LoadLimit& limit, Verdict& out) const {
    std::map<std::size_t, OverLimit> blocks;
    LoadFigure figure{limit};
    for (std::size_t k = 0; k < loads_.points.size(); ++k) {
      const LoadPoint& p = loads_.points[k].load;
      const double value = p.at(limit.load, p.feed_mm_per_s);
      figure.max_after = std::max(figure.max_after, value);
      const std::size_t c = loads_.points[k].cell;
      if (value <= 0 || c == FeedCells::kNone || cells_[c].kept != Kept::no) continue;
      const OverLimit o = over(k, limit, value, OverReason::highest_feed);
      auto [at, added] = blocks.emplace(o.new_line, o);
      if (!added && o.value > at->second.value) at->second = o;
    }
    figure.max_elsewhere = figure.max_after;
    out.figures.push_back(figure);
    for (const auto& [line, o] : blocks)
      if (o.value * kOverLimit < limit.value) out.over.push_back(o);
  }

 private:
  const FeedCandidate& candidate_;
  const ObservedLoads& loads_;
  const FeedCells& cells_;
  const simulate::SimulatedProgram& given_;
  const FeedBounds& bounds_;
};

}  // namespace

Verdict judge(const FeedCandidate& candidate, const ObservedLoads& loads, const FeedCells& cells,
              const simulate::SimulatedProgram& given, std::span<const LoadLimit> limits, const FeedBounds& bounds) {
  Verdict out;
  out.of_cell.assign(cells.size(), 0.0);
  const Judge judge(candidate, loads, cells, given, bounds);
  for (const LoadLimit& limit : limits)
    limit.load == Load::chip_min ? judge.add_lower(limit, out) : judge.add_upper(limit, out);
  std::ranges::stable_sort(out.over, {}, &OverLimit::new_line);
  return out;
}

std::vector<double> peaks_of(const ObservedLoads& loads, std::span<const LoadLimit> limits) {
  std::vector<double> out;
  for (const LoadLimit& limit : limits) {
    double peak = 0;
    for (const PlacedLoad& p : loads.points) peak = std::max(peak, p.load.at(limit.load, p.load.feed_mm_per_s));
    out.push_back(peak);
  }
  return out;
}

}  // namespace camber::adapt
