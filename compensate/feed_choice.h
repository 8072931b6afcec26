#pragma once
// Feed plan: where along a path the feed is lowered and how far, for the least error within a machine time.
#include <cstddef>
#include <span>
#include <vector>

namespace camber::compensate {

/// A stretch of the path whose feed is one word: a piece of a line, or a whole arc.
struct FeedUnit {
  std::size_t chain = 0;  ///< units of one chain follow each other along the path
  double length_mm = 0;
  double time_s = 0;         ///< time at the programmed feed; more than length / feed where the control is slower
  double feed_mm_per_s = 0;  ///< programmed feed
  double least = 1;          ///< lowest fraction of the programmed feed
};

/// A piece of surface that a unit makes.
struct SpeedPoint {
  std::size_t unit = 0;
  double error_mm = 0;  ///< magnitude of the error that the best shift leaves at the unit's present feed
  double area_mm2 = 0;
};

/// error(u) = error(u_now) (u / u_now)^exponent for a unit at the fraction u of its programmed feed.
struct FeedModel {
  double exponent = 0.6;
  double time_scale = 1;  ///< scale of the extra time: accelerations between feeds add to it
};

struct FeedChoice {
  std::vector<double> fraction;  ///< fraction of the programmed feed, one per unit
  double extra_s = 0;            ///< extra machine time by the model
  double error_mm = 0;           ///< 95th percentile by the model
};

/// Returns the fractions to choose from: 1, 0.85, 0.85^2 ... `least`. A unit takes none below its own least one.
std::vector<double> feed_levels(double least);

/// Finds the least 95th percentile of the error for at most `budget_s` of extra time, or the least time for a 95th
/// percentile of `wanted_mm`, whichever is reached first:
///
///   sum_points area [ error(u) > tau ] + lambda ( sum_units time(u) + changes * 0.05 s ) -> min
///
/// unit by unit along each chain (Viterbi), with lambda such that 5 % of the area stay over tau, and tau the least that
/// the budget allows. `now`: the present fraction of each unit. time(u) = max(time_s, length / (u feed)).
FeedChoice choose_feeds(std::span<const FeedUnit> units, std::span<const SpeedPoint> points,
                        std::span<const double> now, const FeedModel& model, double budget_s, double wanted_mm);

}  // namespace camber::compensate
