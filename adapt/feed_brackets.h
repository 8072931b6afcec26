#pragma once
// What several predictions show of the greatest feed within the limits.
#include <cstddef>
#include <span>
#include <vector>

#include "adapt/feed_cells.h"

namespace camber::adapt {

/// By cell: the fastest speed seen that kept the limits, and the slowest one that did not. The model of the loads
/// (LoadCurve) extrapolates from one observation; between two observations the feed is interpolated.
class FeedBrackets {
 public:
  explicit FeedBrackets(const FeedCells& cells) : cells_(cells), kept_(cells.size()), exceeded_(cells.size()) {}

  /// A prediction: the actual speed of each cell, and its greatest load / limit. 0: no load was observed there; the
  /// passings of its neighbours count for a cell, since at another feed they fall elsewhere.
  void add(std::span<const double> speed_mm_per_s, std::span<const double> load_of_limit);

  /// The speed of a cell at which load / limit is about `aim`, never above the slowest one that exceeded the limits.
  /// `modelled`: what the loads last observed allow; the least where the limits were never exceeded.
  double speed_mm_per_s(std::size_t cell, double modelled, double aim) const;

 private:
  static constexpr std::size_t kNeighbours = 2;
  struct Seen {
    double speed_mm_per_s = 0, load_of_limit = 0;  ///< speed 0: never
  };

  const FeedCells& cells_;
  std::vector<Seen> kept_, exceeded_;
};

}  // namespace camber::adapt
