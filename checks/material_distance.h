#pragma once
// A lower bound of the distance to the material of a stock, far beyond its narrow band.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "removal/stock.h"

namespace camber::checks {

/// Distance transform of the stock's tiles: n tiles away (the largest of three differences) is at least n - 1 tile
/// widths away. Material is only ever removed, so the bound holds while the stock is cut; it becomes loose.
class MaterialDistance {
 public:
  /// `stock` must outlive this.
  explicit MaterialDistance(const removal::Stock& stock);

  double at_least_mm(const Vec3& point) const;
  /// Points of the stock were read because the bound did not exclude them. Where that has cost more than another
  /// transform would, the bound becomes tight again.
  void count_readings(std::size_t points);

 private:
  void transform();

  const removal::Stock& stock_;
  double tile_mm_;
  removal::Index3 first_{}, extent_{};
  Vec3 lo_mm_, hi_mm_;  ///< of all tiles
  std::vector<std::uint16_t> tiles_away_;
  std::size_t readings_ = 0;
};

}  // namespace camber::checks
