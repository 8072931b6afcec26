#include "compensate/fit_shift.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace camber::compensate {
namespace {

using Eigen::Matrix3d;

/// Directions with less than this fraction of the best told one's observations are held at rest.
constexpr double kDeterminedFraction = 0.05;

constexpr double kHold = 8;  // weight of a bound that would be exceeded beside the observation's own: see Bounds

/// What the least squares take for an observation's error and area.
struct Asked {
  double error_mm = 0, area_mm2 = 0;
};
Asked asked_of(const Observation& o, double pull_mm) {
  if (pull_mm == 0) return {o.error_mm, o.area_mm2};
  const double bound_mm = pull_mm > 0 ? o.bound_mm : -o.bound_mm;
  return {(o.error_mm + kHold * (o.error_mm + o.form_mm - bound_mm + pull_mm)) / (1 + kHold), o.area_mm2 * (1 + kHold)};
}

/// Area of the observations of a point of the path, and the same times their weights.
struct AreaSums {
  double weighted = 0, area = 0;
};

/// Normal equations of one path: diagonal[i] s_i + upper[i] s_(i+1) + upper[i-1]^T s_(i-1) = right[i].
struct System {
  explicit System(std::size_t points)
      : diagonal(points, Matrix3d::Zero()), upper(points, Matrix3d::Zero()), right(points, Vec3::Zero()), own(points) {}
  std::vector<Matrix3d> diagonal, upper;
  std::vector<Vec3> right;
  std::vector<AreaSums> own;  ///< one per point
};

void add_observation(System& s, const ShiftPath& path, const Observation& o, const Asked& asked) {
  const std::size_t i = o.place.lower;
  const double v = o.place.upper_fraction, u = 1 - v;
  const double a = o.weight * asked.area_mm2;
  const Matrix3d nn = a * o.normal * o.normal.transpose();
  const auto& points = path.points();
  const Vec3 old = u * points[i].shift_mm + v * points[i + 1].shift_mm;
  const Vec3 pull = a * (o.normal.dot(old) - asked.error_mm / o.gain) * o.normal;
  s.diagonal[i] += u * u * nn;
  s.diagonal[i + 1] += v * v * nn;
  s.upper[i] += u * v * nn;
  s.right[i] += u * pull;
  s.right[i + 1] += v * pull;
  s.own[i] = {s.own[i].weighted + u * a, s.own[i].area + u * asked.area_mm2};
  s.own[i + 1] = {s.own[i + 1].weighted + v * a, s.own[i + 1].area + v * asked.area_mm2};
}

/// Mean weight of the observations about each point of a path, at least one: smoothing keeps its length where a few
/// of them weigh a thousand times as much as the others, else those few would make a path of their scatter.
std::vector<double> weight_about(const ShiftPath& path, const std::vector<AreaSums>& own) {
  constexpr double kAbout_mm = 0.5;
  const auto& points = path.points();
  std::vector<AreaSums> about = own;
  for (const ShiftChain& c : path.chains()) {
    const std::size_t end = c.from + c.count;
    const auto fade = [&](std::size_t i) {
      return std::exp(-(points[i].along_mm - points[i - 1].along_mm) / kAbout_mm);
    };
    const auto carry = [&](AreaSums& carried, std::size_t from, std::size_t to, double keep) {
      carried = {keep * (carried.weighted + own[from].weighted), keep * (carried.area + own[from].area)};
      about[to] = {about[to].weighted + carried.weighted, about[to].area + carried.area};
    };
    AreaSums carried;
    for (std::size_t i = c.from + 1; i < end; ++i) carry(carried, i - 1, i, fade(i));
    carried = {};
    for (std::size_t i = end - 1; i > c.from; --i) carry(carried, i, i - 1, fade(i));
  }
  std::vector<double> out;
  out.reserve(about.size());
  for (const AreaSums& a : about) out.push_back(a.area > 0 ? std::max(1.0, a.weighted / a.area) : 1.0);
  return out;
}

void add_stiffness(System& s, const ShiftPath& path, const ShiftChain& chain, double soft_mu, double kappa,
                   std::span<const double> weight, std::span<const double> stiffness) {
  const auto& points = path.points();
  for (std::size_t i = chain.from; i + 1 < chain.from + chain.count; ++i) {
    const double length = std::max(points[i + 1].along_mm - points[i].along_mm, 1e-6);
    const double mu = soft_mu * (weight[i] + weight[i + 1]) / 2 * (stiffness.empty() ? 1.0 : stiffness[i]);
    s.diagonal[i] += (mu / length + kappa * length / 2) * Matrix3d::Identity();
    s.diagonal[i + 1] += (mu / length + kappa * length / 2) * Matrix3d::Identity();
    s.upper[i] -= mu / length * Matrix3d::Identity();
  }
}

/// Both ends of a plunge are shifted across Z by the same.
void add_plunges(System& s, const ShiftPath& path, const ShiftChain& chain) {
  constexpr double kRigid = 1e4;  // of what else holds the path
  double held = 0;
  for (std::size_t i = chain.from; i < chain.from + chain.count; ++i)
    held = std::max(held, kRigid * s.diagonal[i].trace());
  const Matrix3d across = held * Vec3(1, 1, 0).asDiagonal();
  for (std::size_t i = chain.from; i + 1 < chain.from + chain.count; ++i) {
    if (!path.points()[i + 1].plunge) continue;
    s.diagonal[i] += across;
    s.diagonal[i + 1] += across;
    s.upper[i] -= across;
  }
}

/// Holds at rest what hardly any surface faces: along a row of a ball the normals differ by a few degrees, and a shift
/// of several times the error along the surface would explain what little the error varies across the row.
void add_rest(System& s, const ShiftChain& chain) {
  std::vector<Matrix3d> rest(chain.count);
  for (std::size_t k = 0; k < chain.count; ++k) {
    Matrix3d about = s.diagonal[chain.from + k];
    if (k > 0) about += s.diagonal[chain.from + k - 1];
    if (k + 1 < chain.count) about += s.diagonal[chain.from + k + 1];
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(about);
    const double determined = kDeterminedFraction * eigen.eigenvalues()[2];
    rest[k].setZero();
    for (int i = 0; i < 3; ++i) {
      const Vec3 v = eigen.eigenvectors().col(i);
      rest[k] += std::max(0.0, determined - eigen.eigenvalues()[i]) * v * v.transpose();
    }
  }
  for (std::size_t k = 0; k < chain.count; ++k) s.diagonal[chain.from + k] += rest[k];
}

/// Adds the links' stiffness: of two rows the one with the smaller weight tells it, so that what the guard holds does
/// not hold the rows beside it. Returns each link's own, for the terms between its ends.
std::vector<double> add_links(System& s, double soft_mu, std::span<const double> weight,
                              const FitShiftOptions& options) {
  std::vector<double> out;
  out.reserve(options.links.size());
  for (std::size_t i = 0; i < options.links.size(); ++i) {
    const RowLink& l = options.links[i];
    const double mu = soft_mu * std::min(weight[l.a], weight[l.b]) *
                      (options.link_stiffness.empty() ? 1.0 : options.link_stiffness[i]);
    out.push_back(mu * l.along_mm / (l.distance_mm * l.distance_mm));
    s.diagonal[l.a] += out.back() * Matrix3d::Identity();
    s.diagonal[l.b] += out.back() * Matrix3d::Identity();
  }
  return out;
}

/// Block Thomas elimination over the chains, factored once; fixed points are held at zero.
class Chains {
 public:
  Chains(const System& s, const ShiftPath& path) : s_(s), path_(path) {
    const auto& points = path.points();
    gain_.assign(points.size(), Matrix3d::Zero());
    inverse_.assign(points.size(), Matrix3d::Zero());
    for (const ShiftChain& c : path.chains())
      for (std::size_t i = c.from; i < c.from + c.count; ++i) {
        if (points[i].fixed) continue;
        Matrix3d d = s.diagonal[i];
        if (i > c.from) d -= s.upper[i - 1].transpose() * gain_[i - 1];
        inverse_[i] = d.inverse();
        gain_[i] = inverse_[i] * s.upper[i];
      }
  }

  std::vector<Vec3> solve(const std::vector<Vec3>& right) const {
    std::vector<Vec3> x(right.size(), Vec3::Zero());
    for (const ShiftChain& c : path_.chains()) {
      for (std::size_t i = c.from; i < c.from + c.count; ++i)
        x[i] = inverse_[i] * (i > c.from ? Vec3(right[i] - s_.upper[i - 1].transpose() * x[i - 1]) : right[i]);
      for (std::size_t i = c.from + c.count - 1; i-- > c.from;) x[i] -= gain_[i] * x[i + 1];
    }
    return x;
  }

 private:
  const System& s_;
  const ShiftPath& path_;
  std::vector<Matrix3d> gain_, inverse_;
};

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

/// The system's left side, fixed points left out.
std::vector<Vec3> applied(const System& s, const ShiftPath& path, std::span<const RowLink> links,
                          const std::vector<double>& stiffness, const std::vector<Vec3>& x) {
  std::vector<Vec3> out(x.size());
  for (const ShiftChain& c : path.chains())
    for (std::size_t i = c.from; i < c.from + c.count; ++i) {
      out[i] = s.diagonal[i] * x[i];
      if (i > c.from) out[i] += s.upper[i - 1].transpose() * x[i - 1];
      if (i + 1 < c.from + c.count) out[i] += s.upper[i] * x[i + 1];
    }
  for (std::size_t i = 0; i < links.size(); ++i) {
    out[links[i].a] -= stiffness[i] * x[links[i].b];
    out[links[i].b] -= stiffness[i] * x[links[i].a];
  }
  for (std::size_t i = 0; i < x.size(); ++i)
    if (path.points()[i].fixed) out[i].setZero();
  return out;
}

/// Preconditioned conjugate gradients from `x` on; without links the first step is the solution.
std::vector<Vec3> solve(const System& s, const ShiftPath& path, std::span<const RowLink> links,
                        const std::vector<double>& stiffness, std::vector<Vec3> x) {
  constexpr int kSteps = 300;
  constexpr double kClose = 1e-6;
  const Chains chains(s, path);
  std::vector<Vec3> apart = chains.solve(s.right);
  if (links.empty()) return apart;
  if (x.empty()) x = apart;
  const double whole = dot(s.right, apart);
  std::vector<Vec3> r = applied(s, path, links, stiffness, x);
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] = path.points()[i].fixed ? Vec3(Vec3::Zero()) : Vec3(s.right[i] - r[i]);
  std::vector<Vec3> z = chains.solve(r), p = z;
  double rz = dot(r, z);
  for (int step = 0; step < kSteps && rz > kClose * kClose * whole; ++step) {
    const std::vector<Vec3> ap = applied(s, path, links, stiffness, p);
    const double alpha = rz / dot(p, ap);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += alpha * p[i];
      r[i] -= alpha * ap[i];
    }
    z = chains.solve(r);
    const double next = dot(r, z);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + next / rz * p[i];
    rz = next;
  }
  return x;
}

/// Shifts that minimize the sum; they start at `x`, or where it is empty at none. `pull_mm`: of Bounds, or empty.
std::vector<Vec3> fitted(const ShiftPath& path, std::span<const Observation> observations,
                         std::span<const double> pull_mm, const FitShiftOptions& options, std::vector<Vec3> x) {
  System s(path.points().size());
  double area = 0, length = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Asked asked = asked_of(observations[i], pull_mm.empty() ? 0.0 : pull_mm[i]);
    add_observation(s, path, observations[i], asked);
    area += asked.area_mm2;
  }
  for (const ShiftChain& c : path.chains()) length += path.points()[c.from + c.count - 1].along_mm;
  const double rho = std::max(area, 1e-9) / std::max(length, 1e-9);
  const double mu = rho * options.smoothing_mm * options.smoothing_mm;
  const double kappa = mu / (options.decay_mm * options.decay_mm);
  const std::vector<double> weight = weight_about(path, s.own);
  for (const ShiftChain& c : path.chains()) {
    add_rest(s, c);
    add_stiffness(s, path, c, mu, kappa, weight, options.stiffness);
  }
  const std::vector<double> between = add_links(s, mu, weight, options);
  for (const ShiftChain& c : path.chains()) add_plunges(s, path, c);
  return solve(s, path, options.links, between, std::move(x));
}

/// The bounds of observations, and what holds a fit within them: of an observation that would exceed its bound b,
///
///   a (e + x)^2 + kHold a (e + form + x -+ b + p)^2,    x = g n . (s - s_old)
///
/// takes the place of the first term, with p the sum of what it exceeded the bound by in the fits since it was held.
class Bounds {
 public:
  explicit Bounds(std::span<const Observation> observations)
      : asked_(observations), pull_mm_(observations.size(), 0.0) {}

  /// Learns from a fit. Returns whether another one is needed.
  bool learn(const ShiftPath& path, const std::vector<Vec3>& shifts) {
    std::vector<Vec3> changes;
    changes.reserve(shifts.size());
    for (std::size_t i = 0; i < shifts.size(); ++i) changes.push_back(shifts[i] - path.points()[i].shift_mm);
    std::atomic<bool> over = false;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, asked_.size()), [&](const auto& range) {
      bool any = false;
      for (std::size_t i = range.begin(); i < range.end(); ++i) any = learn(i, changes) || any;
      if (any) over = true;
    });
    return over;
  }

  /// One per observation, zero where none is held: for asked_of.
  const std::vector<double>& pull_mm() const { return pull_mm_; }

 private:
  bool learn(std::size_t i, const std::vector<Vec3>& changes) {
    const Observation& o = asked_[i];
    if (std::isinf(o.bound_mm)) return false;
    const double v = o.place.upper_fraction, u = 1 - v;
    const Vec3 change = u * changes[o.place.lower] + v * changes[o.place.lower + 1];
    const double left_mm = o.error_mm + o.form_mm + o.gain * o.normal.dot(change);
    // The side that holds it already, or else the one that it is on.
    const double side = pull_mm_[i] != 0 ? (pull_mm_[i] > 0 ? 1.0 : -1.0) : (left_mm > 0 ? 1.0 : -1.0);
    const double beyond_mm = side * left_mm - o.bound_mm;
    const bool held = pull_mm_[i] != 0;
    pull_mm_[i] = side * (held ? std::max(0.0, std::abs(pull_mm_[i]) + beyond_mm) : beyond_mm > 0 ? kNone_mm : 0.0);
    return beyond_mm > kClose_mm;
  }

  static constexpr double kClose_mm = 0.0001;
  static constexpr double kNone_mm = 1e-12;  // pull of a bound that is held for the first time
  std::span<const Observation> asked_;
  std::vector<double> pull_mm_;
};

}  // namespace

std::size_t fit_shift(ShiftPath& path, std::span<const Observation> observations, const FitShiftOptions& options) {
  constexpr int kFits = 12;  // within bounds
  std::vector<Vec3> shifts = fitted(path, observations, {}, options, {});
  if (options.bounded) {
    Bounds bounds(observations);
    for (int i = 0; i < kFits && bounds.learn(path, shifts); ++i)
      shifts = fitted(path, observations, bounds.pull_mm(), options, std::move(shifts));
  }
  path.set_shifts(shifts);
  return path.cut_to(options.max_shift_mm);
}

}  // namespace camber::compensate
