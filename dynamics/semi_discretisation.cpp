#include "dynamics/semi_discretisation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "base/cancel.h"

namespace camber::dynamics {
namespace {

using Multiplier = std::complex<double>;

/// A fixed start that has a part along every vector.
Eigen::VectorXd start_vector(Eigen::Index n) {
  Eigen::VectorXd v(n);
  std::uint32_t state = 12345;
  for (Eigen::Index i = 0; i < n; ++i) {
    state = state * 1664525u + 1013904223u;
    v(i) = static_cast<double>(state) / 4294967296.0 - 0.5;
  }
  return v.normalized();
}

/// The eigenvalue of largest modulus of a map by Arnoldi's iteration.
class LargestEigenvalue {
 public:
  Multiplier of(PeriodMap& map) {
    const Eigen::Index n = map.size(), most = std::min<Eigen::Index>(n, kMostVectors);
    basis_.resize(n, most + 1);
    hessenberg_.setZero(most + 1, most);
    basis_.col(0) = start_vector(n);
    Eigen::Index next_check = 8;
    for (Eigen::Index k = 0; k < most; ++k) {
      const double left = extend(map, k);
      const bool closed = left < 1e-12 * hessenberg_.col(k).norm();
      if (k + 1 < next_check && k + 1 < most && !closed) continue;
      if (check(k + 1, left) || closed) break;
      next_check = k + 1 + std::max<Eigen::Index>(3, (k + 1) / 4);
    }
    return value_;
  }

 private:
  static constexpr Eigen::Index kMostVectors = 120;
  static constexpr double kExact = 1e-6;

  /// Adds a vector; returns how long it was.
  double extend(PeriodMap& map, Eigen::Index k) {
    from_ = basis_.col(k);
    map.apply(from_, to_);
    for (int twice = 0; twice < 2; ++twice) {
      const Eigen::VectorXd along = basis_.leftCols(k + 1).transpose() * to_;
      to_.noalias() -= basis_.leftCols(k + 1) * along;
      hessenberg_.col(k).head(k + 1) += along;
    }
    const double left = to_.norm();
    hessenberg_(k + 1, k) = left;
    basis_.col(k + 1) = left > 0 ? Eigen::VectorXd(to_ / left) : to_;
    return left;
  }

  /// Whether the largest eigenvalue has been found.
  bool check(Eigen::Index k, double left) {
    solver_.compute(hessenberg_.topLeftCorner(k, k));
    Eigen::Index largest = 0;
    solver_.eigenvalues().cwiseAbs().maxCoeff(&largest);
    value_ = solver_.eigenvalues()(largest);
    const Eigen::VectorXcd vector = solver_.eigenvectors().col(largest);
    return left * std::abs(vector(k - 1)) < kExact * vector.norm() * std::abs(value_);
  }

  Eigen::MatrixXd basis_, hessenberg_;
  Eigen::VectorXd from_, to_;
  Eigen::EigenSolver<Eigen::MatrixXd> solver_;
  Multiplier value_;
};

/// Multipliers of a cut at a speed, depth after depth.
class DepthScan {
 public:
  DepthScan(std::span<const Mode> modes, const Cut& cut, double speed_rpm, const SemiOptions& o)
      : map_(modes, cut, speed_rpm, o.points_per_period, o.min_intervals) {}

  Multiplier at(double depth) {
    cancellation_point();
    map_.set_depth(depth);
    return largest_.of(map_);
  }
  double period_s() const { return map_.period_s(); }

 private:
  PeriodMap map_;
  LargestEigenvalue largest_;
};

struct ScannedDepth {
  double depth_mm = 0;
  Multiplier multiplier;
  double modulus() const { return std::abs(multiplier); }
};

/// The border between a stable and an unstable depth.
ScannedDepth border_between(DepthScan& scan, ScannedDepth stable, ScannedDepth unstable) {
  constexpr double kExact = 2e-4;
  while (unstable.depth_mm - stable.depth_mm > kExact * unstable.depth_mm) {
    // The secant of log |mu|, kept away from the ends.
    const double low = stable.modulus() > 1e-6 ? std::log(stable.modulus()) : -14.0,
                 high = std::log(unstable.modulus());
    const double t = std::clamp(-low / (high - low), 0.1, 0.9);
    const double depth = stable.depth_mm + t * (unstable.depth_mm - stable.depth_mm);
    const ScannedDepth middle{depth, scan.at(depth)};
    (middle.modulus() > 1 ? unstable : stable) = middle;
  }
  return unstable;
}

/// A depth between two stable ones whose multiplier passes 1, where one between them comes close to it.
std::optional<ScannedDepth> peak_between(DepthScan& scan, const ScannedDepth& from, const ScannedDepth& to) {
  constexpr double kGolden = 0.381966;
  double low = from.depth_mm, high = to.depth_mm;
  for (int i = 0; i < 8; ++i) {
    const double a = low + kGolden * (high - low), b = high - kGolden * (high - low);
    const ScannedDepth pa{a, scan.at(a)}, pb{b, scan.at(b)};
    if (pa.modulus() > 1) return pa;
    if (pb.modulus() > 1) return pb;
    (pa.modulus() > pb.modulus() ? high : low) = pa.modulus() > pb.modulus() ? b : a;
  }
  return std::nullopt;
}

/// The first unstable depth, with the stable one before it.
std::optional<std::array<ScannedDepth, 2>> first_unstable(DepthScan& scan, double step, double deepest) {
  constexpr double kNear = 0.96;
  std::vector<ScannedDepth> seen{{0, scan.at(1e-3 * step)}};
  for (double depth = step; seen.back().depth_mm < deepest; depth += step) {
    depth = std::min(depth, deepest);
    seen.push_back({depth, scan.at(depth)});
    const auto n = seen.size();
    if (seen.back().modulus() > 1) return std::array{seen[n - 2], seen[n - 1]};
    if (n < 3 || seen[n - 2].modulus() < kNear) continue;
    if (seen[n - 2].modulus() > seen[n - 1].modulus() && seen[n - 2].modulus() > seen[n - 3].modulus())
      if (const auto peak = peak_between(scan, seen[n - 3], seen[n - 1])) return std::array{seen[n - 3], *peak};
  }
  return std::nullopt;
}

StabilityBorder border_of(Multiplier mu) {
  if (std::abs(mu.imag()) > 1e-3 * std::abs(mu)) return StabilityBorder::hopf;
  return mu.real() < 0 ? StabilityBorder::flip : StabilityBorder::fold;
}

/// Returns the frequency that the modes answer most, of those that a multiplier stands for: +-arg / (2 pi T) + k / T.
double heard_hz(std::span<const Mode> modes, Multiplier mu, double period_s) {
  double highest = 0, best = 0, answer = -1;
  for (const Mode& m : modes) highest = std::max(highest, m.frequency_hz);
  for (int k = 0; k <= 2 * highest * period_s + 1; ++k)
    for (const double sign : {-1.0, 1.0}) {
      const double hz = (k + sign * std::arg(mu) / (2 * kPi)) / period_s;
      if (hz <= 0) continue;
      if (const double a = receptance(modes, hz).norm(); a > answer) answer = a, best = hz;
    }
  return best;
}

}  // namespace

Multiplier dominant_multiplier(std::span<const Mode> modes, const Cut& cut, double speed_rpm, double depth,
                               const SemiOptions& o) {
  return DepthScan(modes, cut, speed_rpm, o).at(depth);
}

SemiBorder semi_border(std::span<const Mode> modes, const Cut& cut, double speed_rpm, const SemiOptions& o) {
  Cut undamped = cut;
  undamped.process_damping_N_per_mm = 0;
  const double lowest = ZeroOrderLobes({modes.begin(), modes.end()}, undamped).lowest_depth_mm();
  if (!std::isfinite(lowest)) return {};
  DepthScan scan(modes, cut, speed_rpm, o);
  const auto found = first_unstable(scan, o.scan_step * lowest, o.deepest * lowest);
  if (!found) return {};
  const ScannedDepth at = border_between(scan, (*found)[0], (*found)[1]);
  return {{at.depth_mm, heard_hz(modes, at.multiplier, scan.period_s())}, border_of(at.multiplier), at.multiplier};
}

std::string_view name_of(StabilityBorder border) {
  constexpr std::array<std::string_view, 4> kNames{"none", "hopf", "flip", "fold"};
  return kNames[static_cast<std::size_t>(border)];
}

}  // namespace camber::dynamics
