#pragma once
// Least squares over logarithms of limits, each within its bounds.
#include <memory>
#include <vector>

#include "calib/fit_limits.h"

namespace ceres {
class CostFunction;
}

namespace camber::calib {

struct BoundedSearch {
  double function_tolerance = 1e-4;  ///< relative change of the cost at which it has converged
  int max_iterations = 50;
};

/// Moves `logs`, the logarithms of `parameters`, to the least cost within their bounds. Returns whether it has
/// converged.
bool least_squares_within_bounds(std::unique_ptr<ceres::CostFunction> cost,
                                 const std::vector<LimitParameter>& parameters, const BoundedSearch& search,
                                 std::vector<double>& logs);

}  // namespace camber::calib
