#pragma once
// Splits of lines: decides where lines get more nodes, and restricts the path to them.
#include <cstddef>
#include <span>
#include <vector>

#include "compensate/fit_shift.h"
#include "compensate/shift_path.h"

namespace camber::compensate {

/// The points of a path that are ends of blocks in the emitted program. A control that rounds corners rounds shorter
/// blocks less, so that a new split moves the path nearby by micrometres. Splits are therefore chosen once, where the
/// shift requires them, and kept.
class Splits {
 public:
  /// The ends of moves, and every point of an arc (which becomes the fewest arcs when it is emitted).
  explicit Splits(const ShiftPath& path);

  /// Adds points of lines where the shifted path deviates by more than tolerance_mm from the one without them.
  std::size_t add_strays(const ShiftPath& path, double tolerance_mm);
  /// Adds points of lines at which the feed changes.
  void add_feed_changes(const ShiftPath& path) { path.keep_feed_changes(kept_); }
  const std::vector<bool>& kept() const { return kept_; }

 private:
  std::vector<bool> kept_;  ///< one per point
};

/// The path of the kept points alone; between them its shifts are linear, as the emitted blocks are.
class ThinPath {
 public:
  ThinPath(const ShiftPath& whole, const std::vector<bool>& kept);

  ShiftPath& path() { return path_; }
  const ShiftPath& path() const { return path_; }
  std::vector<Observation> places_of(std::span<const Observation> observations) const;
  /// Returns, for each kept point, the greatest value of it and the points up to the next kept one.
  std::vector<double> greatest_of(std::span<const double> values) const;
  void take_shifts(const ShiftPath& whole);
  void give_shifts(ShiftPath& whole) const;

 private:
  ShiftPath path_;
  std::vector<ShiftPath::PointInterval> of_point_;  ///< interval on this path of each point of the whole one
  std::vector<std::size_t> point_;                  ///< index in the whole path of each point of this one
};

}  // namespace camber::compensate
