#pragma once
// Feed as a second lever: lower F words where no shift of the path removes the error.
#include <span>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/feed_choice.h"
#include "compensate/shift_path.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::compensate {

/// Errors: [lever-unusable] where none of the moves' feeds can be changed in the text. `selected`: one per move.
void check_feeds(const simulate::SimulatedProgram& program, const std::vector<bool>& selected,
                 Diagnostics& diagnostics);

/// Chooses the feed along a path from what the last prediction left, and learns from the next one how the error
/// follows. Feeds stand in the points of a ShiftPath (feed_fraction). `path` gives the units and is not kept.
class FeedLever {
 public:
  /// `given`: the program whose path this is, as the machine runs it. `splittable`: lines may be split where the feed
  /// changes. `least`: lowest fraction of the programmed feed, for the piece that ends at each point.
  FeedLever(const ShiftPath& path, const simulate::SimulatedProgram& given, bool splittable,
            std::span<const double> least);

  /// Sets the feeds of `path` for the observations of its last prediction. `left_mm`: error that the best shift would
  /// leave at each. `budget_s`: extra machine time.
  FeedChoice choose(ShiftPath& path, std::span<const Observation> observations, std::span<const double> left_mm,
                    double budget_s, double wanted_mm);
  /// Changes the observations to those expected with the new feeds, for the shift that goes with them. `before`: the
  /// fractions that they were made with.
  void apply_to(std::vector<Observation>& observations, const ShiftPath& path, std::span<const double> before) const;
  /// Learns from two predictions of the same surface, with their fractions and shifts, and from the extra time of the
  /// second.
  void learn(const ShiftPath& path, std::span<const double> fractions_before, std::span<const Vec3> shifts_before,
             const Observed& before, const Observed& now, double predicted_s, double found_s);

  static std::vector<double> fractions(const ShiftPath& path);
  static void set_fractions(ShiftPath& path, std::span<const double> fractions);

 private:
  std::vector<FeedUnit> units_;
  std::vector<std::size_t> unit_of_;  ///< unit of the piece that ends at each point
  FeedModel model_;
};

/// Returns the lowest fraction of the programmed feed for the piece of `path` that ends at each point: `least`; within
/// 2 mm of path of a corner that the control passes more slowly, the fraction at which it passes, but at least half of
/// `least`. The chip there is no thinner than in the given program. Stops do not count. `path` is one of `program`'s.
std::vector<double> least_feeds(const ShiftPath& path, const nc::Interpretation& program,
                                const machine::Machine& machine, double least);

}  // namespace camber::compensate
