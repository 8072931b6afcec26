#pragma once
// Small linear programs: few unknowns, many inequalities.
#include <Eigen/Core>
#include <vector>

namespace camber::inspect {

/// row . x <= bound.
struct Inequality {
  Eigen::VectorXd row;
  double bound = 0;
};

struct LinearOptimum {
  Eigen::VectorXd x;
  std::vector<std::size_t> active;  ///< inequalities that determine x, of those given
  bool optimal = false;             ///< false: no x fulfils all of them, or too many steps
};

/// Minimizes cost . x subject to the inequalities and |x_j| <= box_j, by the dual simplex method: starts at a corner of
/// the box, exchanges the most violated inequality for an active one, and ends where none is violated. box_j > 0.
/// Source: Chvatal, Linear Programming (1983), ch. 10. Exact to rounding (1e-12 of the numbers); for tens of unknowns.
LinearOptimum minimize(const Eigen::VectorXd& cost, const std::vector<Inequality>& inequalities,
                       const Eigen::VectorXd& box);

}  // namespace camber::inspect
