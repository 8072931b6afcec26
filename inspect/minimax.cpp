#include "inspect/fits.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::inspect {
namespace {

constexpr double kViolated = 1e-13;  // of the largest bound: less is rounding
constexpr double kPivot = 1e-12;
constexpr int kSteps = 2000;  // a few for each unknown are usual

/// All inequalities: those given, then 2 n sides of the box.
class Program {
 public:
  Program(const std::vector<Inequality>& given, const Eigen::VectorXd& box) : given_(given), box_(box) {}

  std::size_t size() const { return given_.size() + 2 * static_cast<std::size_t>(box_.size()); }
  bool is_given(std::size_t k) const { return k < given_.size(); }
  std::size_t side(Eigen::Index j, bool upper) const {
    return given_.size() + 2 * static_cast<std::size_t>(j) + (upper ? 1 : 0);
  }
  Eigen::VectorXd row(std::size_t k) const {
    if (is_given(k)) return given_[k].row;
    const std::size_t s = k - given_.size();
    return (s % 2 == 1 ? 1.0 : -1.0) * Eigen::VectorXd::Unit(box_.size(), static_cast<Eigen::Index>(s / 2));
  }
  double bound(std::size_t k) const {
    return is_given(k) ? given_[k].bound : box_[static_cast<Eigen::Index>((k - given_.size()) / 2)];
  }
  double excess(std::size_t k, const Eigen::VectorXd& x) const {
    if (is_given(k)) return given_[k].row.dot(x) - given_[k].bound;
    const std::size_t s = k - given_.size();
    const auto j = static_cast<Eigen::Index>(s / 2);
    return (s % 2 == 1 ? x[j] : -x[j]) - box_[j];
  }

 private:
  const std::vector<Inequality>& given_;
  const Eigen::VectorXd& box_;
};

/// The corner of the box at which the cost is least: its sides push against the cost (dual feasible).
std::vector<std::size_t> first_basis(const Program& program, const Eigen::VectorXd& cost) {
  std::vector<std::size_t> basis;
  for (Eigen::Index j = 0; j < cost.size(); ++j) basis.push_back(program.side(j, cost[j] < 0));
  return basis;
}

Eigen::MatrixXd rows_of(const Program& program, const std::vector<std::size_t>& basis) {
  const auto n = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd rows(n, n);
  for (Eigen::Index i = 0; i < n; ++i) rows.row(i) = program.row(basis[static_cast<std::size_t>(i)]);
  return rows;
}

/// The most violated one; size() where none is.
std::size_t most_violated(const Program& program, const Eigen::VectorXd& x, double tolerance) {
  std::size_t worst = program.size();
  double most = tolerance;
  for (std::size_t k = 0; k < program.size(); ++k) {
    const double e = program.excess(k, x);
    if (e > most) most = e, worst = k;
  }
  return worst;
}

}  // namespace

LinearOptimum minimize(const Eigen::VectorXd& cost, const std::vector<Inequality>& inequalities,
                       const Eigen::VectorXd& box) {
  const Program program(inequalities, box);
  std::vector<std::size_t> basis = first_basis(program, cost);
  const Eigen::Index n = cost.size();
  double largest = 0;
  for (std::size_t k = 0; k < program.size(); ++k) largest = std::max(largest, std::abs(program.bound(k)));
  LinearOptimum out;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(rows_of(program, basis));
    Eigen::VectorXd bounds(n);
    for (Eigen::Index i = 0; i < n; ++i) bounds[i] = program.bound(basis[static_cast<std::size_t>(i)]);
    out.x = lu.solve(bounds);
    const std::size_t entering = most_violated(program, out.x, kViolated * largest);
    if (entering == program.size()) {
      out.optimal = true;
      break;
    }
    // cost = -sum lambda_i row_i with lambda >= 0; the entering row = sum mu_i row_i. One of the rows with mu > 0
    // leaves, that with the least lambda / mu.
    const Eigen::PartialPivLU<Eigen::MatrixXd> dual(rows_of(program, basis).transpose());
    const Eigen::VectorXd lambda = dual.solve(-cost), mu = dual.solve(program.row(entering));
    Eigen::Index leaving = -1;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (mu[i] <= kPivot) continue;
      const double ratio = std::max(lambda[i], 0.0) / mu[i];
      if (ratio < least) least = ratio, leaving = i;
    }
    if (leaving < 0) break;  // no x fulfils them all
    basis[static_cast<std::size_t>(leaving)] = entering;
  }
  for (const std::size_t k : basis)
    if (program.is_given(k)) out.active.push_back(k);
  return out;
}

}  // namespace camber::inspect
