#include "base/convex_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/LU>

namespace camber {
namespace {

constexpr double kExact_mm = 1e-4, kExact = 1e-3;
constexpr double kTouching_mm = 1e-7;
constexpr int kMaxRounds = 200;

/// Up to four points of the difference of the solids; the last one is the newest.
struct Simplex {
  std::array<Vec3, 4> point;
  std::size_t count = 0;
};

/// The point nearest to the origin in the affine hull of some of the points, if it is inside them.
template <int Edges>
std::optional<Vec3> nearest_in_hull(const Simplex& simplex, const std::array<std::size_t, 4>& of) {
  const Vec3& base = simplex.point[of[0]];
  if constexpr (Edges == 0) {
    return base;
  } else {
    Eigen::Matrix<double, 3, Edges> edges;
    for (int i = 0; i < Edges; ++i) edges.col(i) = simplex.point[of[static_cast<std::size_t>(i) + 1]] - base;
    const Eigen::Matrix<double, Edges, Edges> gram = edges.transpose() * edges;
    const double scale = gram.diagonal().prod();
    if (!(std::abs(gram.determinant()) > 1e-14 * scale)) return std::nullopt;
    const Eigen::Matrix<double, Edges, 1> weight = -gram.inverse() * (edges.transpose() * base);
    constexpr double kRounding = 1e-12;
    if (weight.minCoeff() < -kRounding || weight.sum() > 1 + kRounding) return std::nullopt;
    return Vec3(base + edges * weight);
  }
}

std::optional<Vec3> nearest_of(const Simplex& simplex, const std::array<std::size_t, 4>& of, std::size_t count) {
  switch (count) {
    case 1:
      return nearest_in_hull<0>(simplex, of);
    case 2:
      return nearest_in_hull<1>(simplex, of);
    case 3:
      return nearest_in_hull<2>(simplex, of);
    default:
      return nearest_in_hull<3>(simplex, of);
  }
}

/// The point of the simplex nearest to the origin; the simplex becomes the points whose hull holds it. All sets of
/// points with the newest one are tried: without it there is nothing nearer than before.
Vec3 reduce(Simplex& simplex) {
  const std::size_t newest = simplex.count - 1;
  Vec3 best = simplex.point[newest];
  std::array<std::size_t, 4> best_of{newest, 0, 0, 0};
  std::size_t best_count = 1;
  for (unsigned set = 1; set < 1U << newest; ++set) {
    std::array<std::size_t, 4> of{newest, 0, 0, 0};
    std::size_t count = 1;
    for (std::size_t i = 0; i < newest; ++i)
      if ((set >> i & 1U) != 0) of[count++] = i;
    const auto nearest = nearest_of(simplex, of, count);
    if (!nearest || nearest->squaredNorm() >= best.squaredNorm()) continue;
    best = *nearest;
    best_of = of;
    best_count = count;
  }
  Simplex kept;
  for (std::size_t i = 0; i < best_count; ++i) kept.point[kept.count++] = simplex.point[best_of[i]];
  simplex = kept;
  return best;
}

/// The iteration from a first point of the difference of a and b on. `done`: with a lower and an upper bound, whether
/// that is enough. Returns the lower bound; 0: they overlap.
template <typename Done>
double iterate(const ConvexSolid& a, const ConvexSolid& b, Vec3 nearest, const Done& done) {
  Simplex simplex;
  simplex.point[simplex.count++] = nearest;
  double least = 0;  // no smaller distance is possible
  for (int round = 0; round < kMaxRounds; ++round) {
    const double distance = nearest.norm();
    if (distance < kTouching_mm) return 0;
    const Vec3 next = a.support(-nearest) - b.support(nearest);
    least = std::max(least, nearest.dot(next) / distance);
    if (distance - least < std::max(kExact_mm, kExact * distance) || done(least, distance)) return least;
    simplex.point[simplex.count++] = next;
    const Vec3 nearer = reduce(simplex);
    if (simplex.count == 4) return 0;
    if (nearer.squaredNorm() >= nearest.squaredNorm()) return least;
    nearest = nearer;
  }
  return least;
}

}  // namespace

double convex_distance(const ConvexSolid& a, const ConvexSolid& b) {
  return iterate(a, b, a.support(Vec3::UnitX()) - b.support(-Vec3::UnitX()), [](double, double) { return false; });
}

bool convex_nearer(const ConvexSolid& a, const ConvexSolid& b, double limit_mm, const Vec3& from_b_to_a) {
  const Vec3 first = a.support(-from_b_to_a) - b.support(from_b_to_a);
  if (first.dot(from_b_to_a) >= limit_mm * from_b_to_a.norm()) return false;
  return iterate(a, b, first, [&](double least, double most) { return least >= limit_mm || most < limit_mm; }) <
         limit_mm;
}

}  // namespace camber
