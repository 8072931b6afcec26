#pragma once
// Few feeds along a path that stay below a ceiling.
#include <span>
#include <vector>

#include "adapt/feed_cells.h"

namespace camber::adapt {

struct FeedBounds {
  double lowest_mm_per_s = 0, highest_mm_per_s = 0;
  double step_fraction = 0.05;  ///< neighbouring feeds differ by more than this
  double change_s = 0.03;       ///< time that a change of feed must save
  double min_length_mm = 0.2;   ///< least length of a block that a split makes
};

/// By cell.
struct FeedCeiling {
  std::vector<double> allowed_mm_per_s;    ///< by the loads; infinite: no limit; below zero: not known
  std::vector<double> reachable_mm_per_s;  ///< greatest speed that the control reaches there
};

/// Feeds of all cells, one per cell: the least time,
///
///   sum length / min(F, reachable) + changes * change_s -> min,  F <= allowed, lowest <= F <= highest
///
/// over levels that differ by the step (Viterbi along each stretch of cells whose feed may change); then every run of
/// equal cells is raised to the least ceiling of its cells, but to no speed that the control does not reach, and runs
/// that differ by less than a step become one. The programmed feed stays where it differs by less than a step and
/// keeps the ceiling, or where the axes are slower anyway; kept cells have it too, and those of which nothing is known.
/// Where no level keeps the ceiling the feed is the lowest.
std::vector<double> plan_feeds(const FeedCells& cells, const FeedCeiling& ceiling, const FeedBounds& bounds);

/// By cell: the least value within `reach_mm` along its chain. Values below zero (not known) stay and count for no
/// other cell.
std::vector<double> least_within(const FeedCells& cells, std::span<const double> values, double reach_mm);

}  // namespace camber::adapt
