#pragma once
// Numbers of the tiles in a box of space.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/geometry.h"
#include "removal/stock.h"

namespace camber::removal {

inline Index3 tile_of(const Vec3& p, double tile_mm) {
  return {static_cast<int>(std::floor(p.x() / tile_mm)), static_cast<int>(std::floor(p.y() / tile_mm)),
          static_cast<int>(std::floor(p.z() / tile_mm))};
}

/// A number for each tile of a box, kNone at first.
class SlotMap {
 public:
  static constexpr std::int32_t kNone = -1;

  void reset(const Index3& lo, const Index3& hi) {
    lo_ = lo;
    for (std::size_t a = 0; a < 3; ++a) n_[a] = std::max(0, hi[a] - lo[a] + 1);
    slots_.assign(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2], kNone);
  }
  bool contains(int i, int j, int k) const {
    return i >= lo_[0] && j >= lo_[1] && k >= lo_[2] && i < lo_[0] + n_[0] && j < lo_[1] + n_[1] && k < lo_[2] + n_[2];
  }
  /// Place of a tile of the box in all().
  std::size_t place(int i, int j, int k) const {
    return (static_cast<std::size_t>(i - lo_[0]) * n_[1] + static_cast<std::size_t>(j - lo_[1])) * n_[2] +
           static_cast<std::size_t>(k - lo_[2]);
  }
  Index3 tile_at(std::size_t place) const {
    const auto ny = static_cast<std::size_t>(n_[1]), nz = static_cast<std::size_t>(n_[2]);
    return {lo_[0] + static_cast<int>(place / nz / ny), lo_[1] + static_cast<int>(place / nz % ny),
            lo_[2] + static_cast<int>(place % nz)};
  }
  std::int32_t& at(int i, int j, int k) { return slots_[place(i, j, k)]; }
  std::int32_t find(int i, int j, int k) const { return contains(i, j, k) ? slots_[place(i, j, k)] : kNone; }
  std::vector<std::int32_t>& all() { return slots_; }
  const std::vector<std::int32_t>& all() const { return slots_; }
  const Index3& first() const { return lo_; }
  const Index3& extent() const { return n_; }

 private:
  Index3 lo_{}, n_{};
  std::vector<std::int32_t> slots_;
};

}  // namespace camber::removal
