#include "dynamics/modal_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "base/geometry.h"

namespace camber::dynamics {
namespace {

using Complex = std::complex<double>;

/// The points that are fitted.
struct TapPoints {
  std::vector<double> hz;
  std::vector<Complex> value, factor;  ///< factor: s^0, s or s^2
  std::vector<double> weight;          ///< 1 / noise
};

/// Standard deviation of each of the two parts of a value: of_value |H| and of_peak max |H| together.
struct TapNoise {
  double of_value = 0, of_peak = 0, peak = 0;
  double at(double magnitude) const { return std::hypot(of_value * magnitude, of_peak * peak); }
};

TapPoints points_in_band(const FrequencyResponse& response, const FitModesOptions& o) {
  TapPoints p;
  for (std::size_t i = 0; i < response.hz.size(); ++i) {
    const double hz = response.hz[i];
    if (hz <= 0 || hz < o.from_hz || (o.to_hz > 0 && hz > o.to_hz)) continue;
    p.hz.push_back(hz);
    p.value.push_back(response.value[i]);
    p.factor.push_back(response_factor(response.kind, hz));
  }
  return p;
}

/// Fourth differences of neighbours show noise and hardly any resonance.
std::vector<double> local_noise(const TapPoints& p) {
  std::vector<double> noise(p.hz.size(), 0.0);
  for (std::size_t i = 2; i + 2 < p.hz.size(); ++i) {
    const Complex d = p.value[i - 2] - 4.0 * p.value[i - 1] + 6.0 * p.value[i] - 4.0 * p.value[i + 1] + p.value[i + 2];
    noise[i] = std::abs(d) / std::sqrt(2 * 70.0);
  }
  return noise;
}

TapNoise noise_of(const TapPoints& p) {
  constexpr double kLow = 0.05, kHigh = 0.3, kLeast = 1e-6;
  const auto local = local_noise(p);
  TapNoise n;
  for (const Complex v : p.value) n.peak = std::max(n.peak, std::abs(v));
  double low = 0, high = 0, lows = 0, highs = 0, smallest = std::numeric_limits<double>::infinity();
  for (const Complex v : p.value) smallest = std::min(smallest, std::abs(v));
  for (std::size_t i = 2; i + 2 < p.hz.size(); ++i) {
    const double size = std::abs(p.value[i]);
    if (size < std::max(kLow * n.peak, 2 * smallest)) low += local[i] * local[i], ++lows;
    if (size > kHigh * n.peak) high += local[i] * local[i] / (size * size), ++highs;
  }
  n.of_peak = std::max(kLeast, lows > 0 ? std::sqrt(low / lows) / n.peak : 0.0);
  n.of_value = std::max(kLeast, highs > 0 ? std::sqrt(high / highs) : 0.0);
  return n;
}

/// Parameters: (f, zeta, 1/k) of each mode, then a and b where they take part.
struct ModalModel {
  int modes = 0;
  bool residuals = false;

  Eigen::Index parameters() const { return 3 * modes + (residuals ? 2 : 0); }

  /// Receptance at a frequency and, in a row, its slopes.
  Complex at(const Eigen::VectorXd& x, double hz, Eigen::RowVectorXcd* slope) const {
    Complex sum = 0;
    for (int m = 0; m < modes; ++m) {
      const double f = x(3 * m), zeta = x(3 * m + 1), flexibility = x(3 * m + 2), r = hz / f;
      const Complex d(1 - r * r, 2 * zeta * r), by_d2 = -flexibility / (d * d);
      sum += flexibility / d;
      if (!slope) continue;
      (*slope)(3 * m) = by_d2 * Complex(-2 * r, 2 * zeta) * (-r / f);
      (*slope)(3 * m + 1) = by_d2 * Complex(0, 2 * r);
      (*slope)(3 * m + 2) = 1.0 / d;
    }
    if (!residuals) return sum;
    const double s2 = -std::pow(2 * kPi * hz, 2);
    if (slope) (*slope)(3 * modes) = 1, (*slope)(3 * modes + 1) = 1 / s2;
    return sum + x(3 * modes) + x(3 * modes + 1) / s2;
  }
};

/// Weighted normal equations at a point of the parameters.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double chi2 = 0;
};

NormalEquations normal_equations(const ModalModel& model, const TapPoints& p, const Eigen::VectorXd& x) {
  const Eigen::Index n = model.parameters();
  NormalEquations e{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0};
  Eigen::RowVectorXcd slope(n);
  for (std::size_t i = 0; i < p.hz.size(); ++i) {
    const Complex left = p.weight[i] * (p.value[i] - p.factor[i] * model.at(x, p.hz[i], &slope));
    slope *= p.weight[i] * p.factor[i];
    e.chi2 += std::norm(left);
    e.matrix.noalias() += slope.real().transpose() * slope.real() + slope.imag().transpose() * slope.imag();
    e.gradient += slope.real().transpose() * left.real() + slope.imag().transpose() * left.imag();
  }
  return e;
}

double chi2_of(const ModalModel& model, const TapPoints& p, const Eigen::VectorXd& x) {
  double sum = 0;
  for (std::size_t i = 0; i < p.hz.size(); ++i)
    sum += std::norm(p.weight[i] * (p.value[i] - p.factor[i] * model.at(x, p.hz[i], nullptr)));
  return sum;
}

bool inside(const ModalModel& model, const Eigen::VectorXd& x) {
  for (int m = 0; m < model.modes; ++m)
    if (!(x(3 * m) > 0) || !(x(3 * m + 1) > 0) || x(3 * m + 1) > 1) return false;
  return x.allFinite();
}

/// Levenberg-Marquardt with the diagonal of the normal matrix as the scale.
NormalEquations refine(const ModalModel& model, const TapPoints& p, Eigen::VectorXd& x) {
  constexpr int kSteps = 60;
  constexpr double kExact = 1e-9;
  double lambda = 1e-3;
  NormalEquations now = normal_equations(model, p, x);
  for (int step = 0; step < kSteps; ++step) {
    Eigen::MatrixXd a = now.matrix;
    a.diagonal() *= 1 + lambda;
    const Eigen::VectorXd trial = x + a.ldlt().solve(now.gradient);
    const double chi2 = inside(model, trial) ? chi2_of(model, p, trial) : std::numeric_limits<double>::infinity();
    if (chi2 > now.chi2) {
      lambda *= 5;
      if (lambda > 1e10) break;
      continue;
    }
    const bool done = now.chi2 - chi2 < kExact * now.chi2;
    x = trial, lambda = std::max(lambda / 5, 1e-12);
    now = normal_equations(model, p, x);
    if (done) break;
  }
  return now;
}

/// Flexibilities and residuals for given poles: they are linear.
void start_flexibilities(const ModalModel& model, const TapPoints& p, Eigen::VectorXd& x) {
  for (int m = 0; m < model.modes; ++m) x(3 * m + 2) = 0;
  if (model.residuals) x.tail(2).setZero();
  NormalEquations e = normal_equations(model, p, x);
  for (int m = 0; m < model.modes; ++m)
    for (int c = 0; c < 2; ++c) {
      const Eigen::Index i = 3 * m + c;
      e.matrix.row(i).setZero(), e.matrix.col(i).setZero();
      e.matrix(i, i) = 1, e.gradient(i) = 0;
    }
  x += e.matrix.ldlt().solve(e.gradient);
}

struct Candidate {
  ModalModel model;
  Eigen::VectorXd x;
  NormalEquations equations;
  double criterion = std::numeric_limits<double>::infinity();
};

/// (f, zeta, 0) of the poles of the fraction that may be modes of the band.
std::vector<double> start_of(const TapPoints& p, int pairs) {
  constexpr double kMostDamping = 0.7;
  std::vector<Complex> receptance;
  std::vector<double> weight;
  for (std::size_t i = 0; i < p.hz.size(); ++i) {
    receptance.push_back(p.value[i] / p.factor[i]);
    weight.push_back(p.weight[i] * std::abs(p.factor[i]));
  }
  std::vector<double> start;
  for (const Complex pole : fitted_poles(p.hz, receptance, weight, pairs)) {
    const double hz = std::abs(pole) / (2 * kPi), zeta = -pole.real() / std::abs(pole);
    if (hz < p.hz.front() || hz > p.hz.back() || zeta > kMostDamping || zeta < 1e-6) continue;
    start.insert(start.end(), {hz, zeta, 0.0});
  }
  return start;
}

double variance_of(const Candidate& c, const TapPoints& p) {
  return c.equations.chi2 / (2 * static_cast<double>(p.hz.size()) - static_cast<double>(c.model.parameters()));
}

/// Whether every mode is one: a tap moves what it hits, so flexibilities are positive, and they stand out of the noise.
bool plausible(const Candidate& c, const TapPoints& p) {
  constexpr double kErrors = 4;
  if (c.model.modes == 0 || !c.x.allFinite()) return false;
  const Eigen::MatrixXd covariance =
      variance_of(c, p) * c.equations.matrix.ldlt().solve(Eigen::MatrixXd::Identity(c.x.size(), c.x.size()));
  for (int m = 0; m < c.model.modes; ++m) {
    const Eigen::Index i = 3 * m + 2;
    if (c.x(i) < kErrors * std::sqrt(std::max(0.0, covariance(i, i)))) return false;
    if (c.x(3 * m) < p.hz.front() || c.x(3 * m) > p.hz.back()) return false;
  }
  return true;
}

Candidate candidate(const TapPoints& p, const std::vector<double>& start, bool residuals) {
  Candidate c{.model = {static_cast<int>(start.size() / 3), residuals}, .x = {}, .equations = {}};
  if (c.model.modes == 0) return c;
  c.x = Eigen::VectorXd::Zero(c.model.parameters());
  for (std::size_t i = 0; i < start.size(); ++i) c.x(static_cast<Eigen::Index>(i)) = start[i];
  start_flexibilities(c.model, p, c.x);
  c.equations = refine(c.model, p, c.x);
  const double n = 2 * static_cast<double>(p.hz.size());
  if (plausible(c, p))
    c.criterion = n * std::log(c.equations.chi2 / n) + static_cast<double>(c.model.parameters()) * std::log(n);
  return c;
}

Candidate best_candidate(const TapPoints& p, const FitModesOptions& o) {
  constexpr int kPatience = 3;
  Candidate best;
  // Poles of the fraction beyond those of the modes take up noise and what lies beyond the band.
  int better_at = 0;
  for (int pairs = o.modes.value_or(1); pairs <= kMostModes + 2; ++pairs) {
    const std::vector<double> start = start_of(p, pairs);
    if (o.modes && static_cast<int>(start.size()) != 3 * *o.modes) continue;
    for (const bool residuals : {false, true}) {
      Candidate c = candidate(p, start, residuals);
      if (c.model.modes > kMostModes || c.criterion >= best.criterion) continue;
      best = std::move(c), better_at = pairs;
    }
    if (best.model.modes > 0 && pairs - better_at >= kPatience) break;
  }
  return best;
}

void set_weights(TapPoints& p, const TapNoise& noise, const std::vector<Complex>& value) {
  p.weight.clear();
  for (const Complex v : value) p.weight.push_back(1 / noise.at(std::abs(v)));
}

std::vector<Complex> values_of(const Candidate& c, const TapPoints& p) {
  std::vector<Complex> v;
  for (std::size_t i = 0; i < p.hz.size(); ++i) v.push_back(p.factor[i] * c.model.at(c.x, p.hz[i], nullptr));
  return v;
}

void put_modes(const Candidate& c, const TapPoints& p, ModeFit& fit) {
  const Eigen::MatrixXd covariance =
      variance_of(c, p) * c.equations.matrix.ldlt().solve(Eigen::MatrixXd::Identity(c.x.size(), c.x.size()));
  const auto error = [&](Eigen::Index i) { return std::sqrt(covariance(i, i)); };
  for (Eigen::Index i = 0; i < 3 * c.model.modes; i += 3) {
    const double k = 1 / c.x(i + 2);
    fit.modes.push_back({{c.x(i), error(i)}, {c.x(i + 1), error(i + 1)}, {k, error(i + 2) * k * k}});
  }
  std::ranges::sort(fit.modes, {}, [](const FittedMode& m) { return m.frequency_hz.value; });
  if (c.model.residuals)
    fit.residual_mm_per_N = c.x(3 * c.model.modes), fit.inertia_mm_per_N_s2 = c.x(3 * c.model.modes + 1);
  fit.misfit = std::sqrt(variance_of(c, p));
}

}  // namespace

ModeFit fit_modes(const FrequencyResponse& response, const FitModesOptions& options) {
  ModeFit fit;
  TapPoints p = points_in_band(response, options);
  constexpr std::size_t kFewest = 16;
  if (p.hz.size() < kFewest) return fit;
  const TapNoise noise = noise_of(p);
  fit.noise_of_value = noise.of_value, fit.noise_of_peak = noise.of_peak;
  set_weights(p, noise, p.value);
  Candidate best = best_candidate(p, options);
  if (best.model.modes == 0) return fit;
  // Values with noise give weights with noise: once more with the fitted ones.
  set_weights(p, noise, values_of(best, p));
  best.equations = refine(best.model, p, best.x);
  put_modes(best, p, fit);
  for (const double hz : response.hz)
    fit.fitted.push_back(hz > 0 ? response_factor(response.kind, hz) * best.model.at(best.x, hz, nullptr) : 0.0);
  return fit;
}

}  // namespace camber::dynamics
