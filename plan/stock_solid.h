#pragma once
// A stock, as an interrupted run leaves it, as a blank.
#include <vector>

#include "plan/faces.h"
#include "removal/stock.h"

namespace camber::plan {

struct StockBlank {
  TriangleSolid solid;  ///< faces up and down of every column of voxels
  std::array<std::vector<AxisPlane>, 3> planes;
};

/// Heights are those of the stock's surface along the columns' middles. A level is a plane where more than a hundredth
/// of the stock's area lies within the tolerance of it; walls likewise, from crossings of lines along x and y.
StockBlank blank_of(const removal::Stock& stock, const FaceOptions& options);

/// Material of one column, in pairs of heights, lower and upper.
std::vector<double> material_along_z(const removal::Stock::Probe& probe, const removal::Stock& stock, double x_mm,
                                     double y_mm);

}  // namespace camber::plan
