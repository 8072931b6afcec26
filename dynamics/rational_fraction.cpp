#include "dynamics/modal_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "base/geometry.h"

namespace camber::dynamics {
namespace {

using Pole = std::complex<double>;

/// The two real-coefficient fractions of a pole pair.
std::array<Pole, 2> pair_fractions(Pole s, Pole p) {
  const Pole a = 1.0 / (s - p), b = 1.0 / (s - std::conj(p));
  return {a + b, Pole(0, 1) * (a - b)};
}

/// Zeros of 1 + sum of c / (s - p): the poles to be.
std::vector<Pole> moved(const std::vector<Pole>& poles, const Eigen::VectorXd& c) {
  const auto n = static_cast<Eigen::Index>(poles.size());
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Pole p = poles[static_cast<std::size_t>(i)];
    h.block<2, 2>(2 * i, 2 * i) << p.real(), p.imag(), -p.imag(), p.real();
    h.row(2 * i) -= 2 * c.transpose();
  }
  const Eigen::VectorXcd zeros = Eigen::EigenSolver<Eigen::MatrixXd>(h, false).eigenvalues();
  std::vector<Pole> next;
  std::vector<double> real;
  for (const Pole z : zeros) {
    if (z.imag() > 0) next.emplace_back(-std::abs(z.real()), z.imag());
    if (z.imag() == 0) real.push_back(std::abs(z.real()));
  }
  // Two real ones become a pair that is all but critically damped.
  std::ranges::sort(real);
  for (std::size_t i = 0; i + 1 < real.size(); i += 2) {
    const double w = std::sqrt(real[i] * real[i + 1]);
    next.emplace_back(-0.9 * w, 0.44 * w);
  }
  return next;
}

}  // namespace

std::vector<Pole> fitted_poles(std::span<const double> hz, std::span<const Pole> value, std::span<const double> weight,
                               int pairs) {
  constexpr int kRounds = 25;
  const auto rows = static_cast<Eigen::Index>(hz.size());
  const double scale = 2 * kPi * hz.back();  // s in units of the highest frequency
  std::vector<Pole> poles;
  for (int i = 0; i < pairs; ++i) {
    const double w = (hz.front() + (hz.back() - hz.front()) * (i + 0.5) / pairs) / hz.back();
    poles.emplace_back(-0.02 * w, w);
  }
  const Eigen::Index columns = 4 * pairs + 2;
  Eigen::MatrixXd left(2 * rows, columns);
  Eigen::VectorXd right(2 * rows);
  for (int round = 0; round < kRounds; ++round) {
    for (Eigen::Index k = 0; k < rows; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const Pole s(0, 2 * kPi * hz[i] / scale);
      const auto put = [&](Eigen::Index column, Pole x) {
        left(2 * k, column) = weight[i] * x.real(), left(2 * k + 1, column) = weight[i] * x.imag();
      };
      for (int p = 0; p < pairs; ++p) {
        const auto f = pair_fractions(s, poles[static_cast<std::size_t>(p)]);
        put(2 * p, f[0]), put(2 * p + 1, f[1]);
        put(2 * pairs + 2 + 2 * p, -value[i] * f[0]), put(2 * pairs + 3 + 2 * p, -value[i] * f[1]);
      }
      put(2 * pairs, 1), put(2 * pairs + 1, 1.0 / (s * s));
      right(2 * k) = weight[i] * value[i].real(), right(2 * k + 1) = weight[i] * value[i].imag();
    }
    const Eigen::VectorXd size = left.colwise().norm().cwiseMax(1e-300);
    const Eigen::MatrixXd scaled = left * size.cwiseInverse().asDiagonal();
    const Eigen::VectorXd x = scaled.colPivHouseholderQr().solve(right).cwiseQuotient(size);
    poles = moved(poles, x.tail(2 * pairs));
    if (static_cast<int>(poles.size()) != pairs) break;
  }
  for (Pole& p : poles) p *= scale;
  return poles;
}

}  // namespace camber::dynamics
