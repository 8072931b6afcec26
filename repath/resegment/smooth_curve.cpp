#include "repath/resegment/resegmentation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::repath {

SmoothCurve::SmoothCurve(std::span<const Vec3> points, double tolerance_mm) {
  assert(points.size() >= 2 && std::ranges::adjacent_find(points) == points.end());
  knots_.assign(points.size(), 0.0);
  for (std::size_t k = 1; k < points.size(); ++k) knots_[k] = knots_[k - 1] + (points[k] - points[k - 1]).norm();
  solve(points, 0);
  if (points.size() < 3 || !(tolerance_mm > 0)) return;
  // The move of the points grows with the weight. A curve of wavelength l is flattened by weight (2 pi / l)^4 times
  // the points a length: the search begins where nothing is, and ends where whole pieces are.
  const double spacing = knots_.back() / static_cast<double>(points.size() - 1);
  double low = std::log(1e-6 * std::pow(spacing, 3)), high = std::log(1e3 * std::pow(knots_.back(), 4) / spacing);
  constexpr int kSteps = 24;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = 0.5 * (low + high);
    solve(points, std::exp(middle));
    (largest_move_ <= tolerance_mm ? low : high) = middle;
  }
  solve(points, std::exp(low));
  if (largest_move_ > tolerance_mm) solve(points, 0);
}

/// (R + w Q' S Q) second = Q' y and values = y - w S Q second, with the tridiagonal R and Q of the natural spline and
/// S = 1 but 0 at the ends.
void SmoothCurve::solve(std::span<const Vec3> y, double weight) {
  const std::size_t n = y.size();
  values_.assign(y.begin(), y.end());
  second_.assign(n, Vec3::Zero());
  largest_move_ = 0;
  if (n < 3) return;
  const std::size_t m = n - 2;  // inner knots; row i belongs to knot i + 1
  const auto h = [&](std::size_t i) { return knots_[i + 1] - knots_[i]; };
  const auto held = [&](std::size_t k) { return k == 0 || k == n - 1 ? 0.0 : 1.0; };
  // Column i of Q: at knots i, i + 1, i + 2.
  const auto q = [&](std::size_t i, std::size_t k) {
    return k == i ? 1 / h(i) : k == i + 1 ? -1 / h(i) - 1 / h(i + 1) : 1 / h(i + 1);
  };
  std::vector<double> diagonal(m), first(m, 0.0), next(m, 0.0);  // the bands of a symmetric matrix
  std::vector<Vec3> right(m);
  for (std::size_t i = 0; i < m; ++i) {
    diagonal[i] = (h(i) + h(i + 1)) / 3;
    for (std::size_t k = i; k <= i + 2; ++k) diagonal[i] += weight * held(k) * q(i, k) * q(i, k);
    if (i + 1 < m) {
      first[i] = h(i + 1) / 6;
      for (std::size_t k = i + 1; k <= i + 2; ++k) first[i] += weight * held(k) * q(i, k) * q(i + 1, k);
    }
    if (i + 2 < m) next[i] = weight * held(i + 2) * q(i, i + 2) * q(i + 2, i + 2);
    right[i] = (y[i + 2] - y[i + 1]) / h(i + 1) - (y[i + 1] - y[i]) / h(i);
  }
  // L D L' of a matrix with two bands beside the diagonal.
  for (std::size_t i = 0; i < m; ++i) {
    const double a = first[i], b = next[i], d = diagonal[i];
    if (i + 1 < m) diagonal[i + 1] -= a * a / d;
    if (i + 2 < m) {
      first[i + 1] -= a * b / d;
      diagonal[i + 2] -= b * b / d;
    }
    first[i] = a / d;
    next[i] = b / d;
  }
  for (std::size_t i = 0; i < m; ++i) {
    if (i + 1 < m) right[i + 1] -= first[i] * right[i];
    if (i + 2 < m) right[i + 2] -= next[i] * right[i];
  }
  for (std::size_t i = m; i-- > 0;) {
    Vec3 v = right[i] / diagonal[i];
    if (i + 1 < m) v -= first[i] * second_[i + 2];
    if (i + 2 < m) v -= next[i] * second_[i + 3];
    second_[i + 1] = v;
  }
  for (std::size_t k = 1; k + 1 < n; ++k) {
    Vec3 move = Vec3::Zero();
    for (std::size_t i = k >= 2 ? k - 2 : 0; i <= std::min(k, m - 1); ++i) move += q(i, k) * second_[i + 1];
    values_[k] -= weight * move;
    largest_move_ = std::max(largest_move_, weight * move.norm());
  }
}

Vec3 SmoothCurve::at(double s) const {
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, s);
  const auto i = static_cast<std::size_t>(above - knots_.begin()) - 1;
  const double h = knots_[i + 1] - knots_[i], b = std::clamp((s - knots_[i]) / h, 0.0, 1.0), a = 1 - b;
  return a * values_[i] + b * values_[i + 1] +
         h * h / 6 * ((a * a * a - a) * second_[i] + (b * b * b - b) * second_[i + 1]);
}

}  // namespace camber::repath
