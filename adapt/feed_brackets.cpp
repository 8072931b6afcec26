#include "adapt/feed_chooser.h"

#include <algorithm>

namespace camber::adapt {
namespace {

constexpr double kNear = 0.5;  ///< share of the limit from which on forces are extrapolated in proportion

}  // namespace

void FeedBrackets::add(std::span<const double> speed_mm_per_s, std::span<const double> load_of_limit) {
  for (const auto& [from, end] : cells_.chains())
    for (std::size_t i = from; i < end; ++i) {
      double load = 0;
      for (std::size_t j = std::max(from + kNeighbours, i) - kNeighbours; j < std::min(end, i + kNeighbours + 1); ++j)
        load = std::max(load, load_of_limit[j]);
      const double speed = speed_mm_per_s[i];
      if (load <= 0 || speed <= 0) continue;
      Seen& kept = kept_[i];
      Seen& exceeded = exceeded_[i];
      if (load <= 1 && speed > kept.speed_mm_per_s) kept = {speed, load};
      if (load > 1 && (exceeded.speed_mm_per_s == 0 || speed < exceeded.speed_mm_per_s)) exceeded = {speed, load};
    }
}

double FeedBrackets::speed_mm_per_s(std::size_t cell, double modelled, double aim) const {
  const Seen& kept = kept_[cell];
  const Seen& exceeded = exceeded_[cell];
  if (exceeded.speed_mm_per_s == 0) {
    // The passings of a slow corner are slower than its feed; every load grows at most in proportion to the feed.
    const bool near = kept.load_of_limit >= kNear;
    return near ? std::max(modelled, kept.speed_mm_per_s * aim / kept.load_of_limit) : modelled;
  }
  const double bound = std::min(modelled, exceeded.speed_mm_per_s);
  if (kept.speed_mm_per_s == 0 || kept.speed_mm_per_s >= exceeded.speed_mm_per_s || kept.load_of_limit >= aim)
    return bound;
  const double share = (aim - kept.load_of_limit) / (exceeded.load_of_limit - kept.load_of_limit);
  return kept.speed_mm_per_s + share * (exceeded.speed_mm_per_s - kept.speed_mm_per_s);
}

}  // namespace camber::adapt
