#pragma once
// What a stock looks like, coarse enough to be drawn beside the surface that is judged.
#include <cstddef>
#include <vector>

#include "removal/stock.h"

namespace camber::removal {

/// Where a line between two points of the grid leaves the material.
struct StockCrossing {
  Vec3 place_mm;
  Vec3 outward;  ///< along the line: an axis or its opposite
};

struct StockShape {
  double cell_mm = 0;  ///< grid whose points stand at whole multiples of it; a whole number of voxels
  std::vector<StockCrossing> crossings;
};

/// Crossings of the stock's surface with the lines of the finest grid that has no more than `most_crossings`; 1 or
/// more. Each lies where the voxels put it, but for a thousandth of a cell
/// between the two points. What is thinner than a cell between two points of the
/// grid is not seen.
StockShape stock_shape(const Stock& stock, std::size_t most_crossings);

}  // namespace camber::removal
