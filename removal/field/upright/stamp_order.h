#pragma once
// In which order stamps are cut. The stock that they leave does not depend on it, the work does.
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Consecutive stamps in batches. The chips of a batch are read from the stock as it stood before the batch, and from
/// the places of the batch's earlier stamps; then the whole batch is cut, in any order.
///
/// On a smooth path the stamp right before leaves less at every point that cuts than those before it: of spheres of
/// radius R with their lowest points at a (right before), b (earlier) and c (this stamp), the surface of c where it
/// moves into material is nearer to a than to b if (c - a).(b - a) - |b - a|^2 / 2 + R |e| <= 0, e the part of b - a
/// across the motion c - a. Only in corners narrower than the cutter earlier stamps count.
class StampOrder {
 public:
  StampOrder() = default;
  /// Batches of a path that no bending moves; for undeflected stamps of one cutter.
  static StampOrder of_path(std::span<const Stamp> stamps, const CutterShape& shape);

  std::int32_t batch(std::int32_t k) const { return batch_[static_cast<std::size_t>(k)]; }
  /// Stamps of the batch, other than the one right before, that may have cut what stamp k meets.
  std::span<const std::int32_t> earlier(std::int32_t k) const {
    if (first_.empty()) return {};
    const auto at = static_cast<std::size_t>(k);
    return {earlier_.data() + first_[at], first_[at + 1] - first_[at]};
  }

 private:
  std::vector<std::int32_t> batch_;
  std::vector<std::size_t> first_;  ///< into earlier_; empty: none has any
  std::vector<std::int32_t> earlier_;
};

/// Calls f(i, left, right) for i = 0 ... count - 1, first far apart, then between: left and right are the nearest
/// neighbours that were called before, -1 where there is none.
template <class Function>
void for_each_coarse_to_fine(std::int32_t count, Function f) {
  if (count <= 0) return;
  f(0, -1, -1);
  std::int32_t step = 1;
  while (step < count) step *= 2;
  for (; step >= 1; step /= 2)
    for (std::int32_t i = step; i < count; i += 2 * step) f(i, i - step, i + step < count ? i + step : -1);
}

}  // namespace camber::removal::upright
