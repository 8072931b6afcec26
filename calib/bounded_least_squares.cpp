#include "calib/bounded_least_squares.h"

#include <cmath>

#include <ceres/ceres.h>

namespace camber::calib {

bool least_squares_within_bounds(std::unique_ptr<ceres::CostFunction> cost,
                                 const std::vector<LimitParameter>& parameters, const BoundedSearch& search,
                                 std::vector<double>& logs) {
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, logs.data());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    problem.SetParameterLowerBound(logs.data(), static_cast<int>(i), std::log(parameters[i].least));
    problem.SetParameterUpperBound(logs.data(), static_cast<int>(i), std::log(parameters[i].most));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = search.max_iterations;
  options.function_tolerance = search.function_tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace camber::calib
