#include "compensate/row_form.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace camber::compensate {
namespace {

constexpr int kTerms = 4;                 // of a cubic
constexpr double kMany = 40;              // points across and along, whose mean needs no help
constexpr double kOneFace = 0.97;         // mean normal of a ball's row of 40 degrees
constexpr double kRegularization = 1e-3;  // fraction of the moments below which a term is not determined
constexpr double kMin_mm = 0.005;         // rows narrower than this have no form

using Terms = Eigen::Matrix<double, kTerms, 1>;
using Square = Eigen::Matrix<double, kTerms, kTerms>;

/// Sum of the normals about a point of the path, each by its area.
struct Facing {
  Vec3 normal = Vec3::Zero();
  double area = 0;
  Facing operator*(double f) const { return {normal * f, area * f}; }
  Facing operator+(const Facing& o) const { return {normal + o.normal, area + o.area}; }
  /// Returns whether the observations lie on one face, not on a wall and the floor beside it.
  bool one() const { return normal.norm() > kOneFace * area; }
};

struct Moments {
  Square square = Square::Zero();
  Terms right = Terms::Zero();
  double points = 0;
  Moments operator*(double f) const { return {square * f, right * f, points * f}; }
  Moments operator+(const Moments& o) const { return {square + o.square, right + o.right, points + o.points}; }
};

void distribute(const ShiftPath::PointInterval& place, auto add) {
  add(place.lower, 1 - place.upper_fraction);
  add(place.lower + 1, place.upper_fraction);
}

std::vector<Facing> facing(const ShiftPath& path, std::span<const Observation> observations) {
  std::vector<Facing> out(path.points().size());
  for (const Observation& o : observations)
    distribute(o.place, [&](std::size_t i, double fraction) {
      out[i] = out[i] + Facing{o.normal, 1} * (fraction * o.area_mm2);
    });
  spread_along(out, path, kFormAlong_mm);
  return out;
}

/// Returns the place of each observation across its row, mm.
std::vector<double> places_across(const ShiftPath& path, std::span<const Observation> observations,
                                  const std::vector<Facing>& faces) {
  std::vector<double> out;
  out.reserve(observations.size());
  for (const Observation& o : observations) {
    const auto &a = path.points()[o.place.lower], &b = path.points()[o.place.lower + 1];
    const double v = o.place.upper_fraction;
    const Vec3 across =
        (b.place_mm - a.place_mm).cross((1 - v) * faces[o.place.lower].normal + v * faces[o.place.lower + 1].normal);
    out.push_back(across.norm() > 0 ? o.from_centre_mm.dot(across.normalized()) : 0);
  }
  return out;
}

Terms terms_of(double t) { return {1, t, t * t, t * t * t}; }

}  // namespace

std::vector<double> row_form_mm(const ShiftPath& path, std::span<const Observation> observations,
                                const std::vector<double>& left_mm, double smoothing_mm) {
  const std::vector<Facing> faces = facing(path, observations);
  std::vector<double> across = places_across(path, observations, faces);
  double squares = 0, area = 0;
  for (std::size_t i = 0; i < across.size(); ++i) {
    squares += observations[i].area_mm2 * across[i] * across[i];
    area += observations[i].area_mm2;
  }
  const double scale = area > 0 ? std::sqrt(squares / area) : 0;
  std::vector<double> out(across.size(), 0.0);
  if (scale < kMin_mm) return out;
  std::vector<Moments> moments(path.points().size());
  for (std::size_t i = 0; i < across.size(); ++i) {
    across[i] /= scale;
    const Terms t = terms_of(across[i]);
    distribute(observations[i].place, [&](std::size_t at, double fraction) {
      const double a = fraction * observations[i].area_mm2;
      moments[at].square += a * t * t.transpose();
      moments[at].points += fraction;
      moments[at].right += a * left_mm[i] * t;
    });
  }
  spread_along(moments, path, kFormAlong_mm);
  std::vector<Terms> form(moments.size(), Terms::Zero());
  for (std::size_t i = 0; i < form.size(); ++i) {
    Square& m = moments[i].square;
    if (m(0, 0) <= 0 || !faces[i].one()) continue;
    m.diagonal() *= 1 + kRegularization;
    const double points = moments[i].points * smoothing_mm / kFormAlong_mm / kMany;  // the weights' sum is 2 kFormAlong
    form[i] = m.ldlt().solve(moments[i].right) / (1 + points * points);
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    distribute(observations[i].place,
               [&](std::size_t at, double fraction) { out[i] += fraction * form[at].dot(terms_of(across[i])); });
  return out;
}

}  // namespace camber::compensate
