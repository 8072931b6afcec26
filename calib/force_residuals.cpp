#include "calib/force_residuals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace camber::calib {

using machine::Coefficient;
using machine::CoefficientRole;
using machine::Material;

namespace {

/// Components of the run-out that the log can tell: a single tooth cuts after itself; two teeth with hardly any lag
/// between the ends of their edges tell the difference of their radii alone.
int run_out_size(const MeasuredLog& log) {
  const machine::Tool& tool = log.how.tool;
  if (!log.how.waveform || tool.flutes < 2) return 0;
  if (tool.flutes > 2) return 2;
  constexpr double kLag = 0.2;
  double deepest = 0;
  for (const auto& c : log.cuts) deepest = std::max(deepest, c.cut.axial_depth_mm);
  return deepest * std::tan(tool.helix_rad) / (tool.diameter_mm / 2) > kLag ? 2 : 1;
}

}  // namespace

ForceProblem::ForceProblem(const std::vector<MeasuredLog>& logs) : logs_(logs) {
  const machine::ForceLog& how = logs.front().how;
  if (how.material) base_ = *how.material;
  base_.law = how.law;
  base_.preset = {};
  const machine::ForceLawDescription& law = machine::description(how.law);
  for (const Coefficient& c : law.fitted)
    if (std::ranges::find(how.hold, c.key) == how.hold.end()) free_.push_back(&c);
  if (how.hold.empty())
    for (const Coefficient& c : law.coefficients) base_.*c.field = 0;
  size_ = static_cast<Eigen::Index>(free_.size());
  for (const MeasuredLog& log : logs) {
    LogPlace place;
    place.run_out = size_;
    place.run_out_size = run_out_size(log);
    size_ += place.run_out_size;
    place.phase = size_;
    if (log.how.waveform) size_ += static_cast<Eigen::Index>(log.cuts.size());
    places_.push_back(place);
    models_.emplace_back();
    first_residual_.emplace_back();
    const auto components = std::ranges::count(log.has, true);
    for (const MeasuredCut& cut : log.cuts) {
      models_.back().emplace_back(log.how.tool, cut.cut);
      first_residual_.back().push_back(residuals_);
      residuals_ += components * static_cast<Eigen::Index>(std::max<std::size_t>(1, cut.waveform_N.size()));
    }
  }
}

Material ForceProblem::material_at(const Eigen::VectorXd& p) const {
  Material m = base_;
  for (std::size_t i = 0; i < free_.size(); ++i) m.*(free_[i]->field) = p[static_cast<Eigen::Index>(i)];
  return m;
}

deflection::RunOut ForceProblem::run_out_at(std::size_t log, const Eigen::VectorXd& p) const {
  const LogPlace& place = places_[log];
  return {place.run_out_size > 0 ? p[place.run_out] : 0.0, place.run_out_size > 1 ? p[place.run_out + 1] : 0.0};
}

Eigen::VectorXd ForceProblem::cut_residuals(std::size_t l, std::size_t c, const Eigen::VectorXd& p) const {
  const MeasuredLog& log = logs_[l];
  const MeasuredCut& cut = log.cuts[c];
  const Material material = material_at(p);
  std::vector<double> out;
  const auto add = [&](const Vec3& difference, double weight) {
    for (int a = 0; a < 3; ++a)
      if (log.has[static_cast<std::size_t>(a)]) out.push_back(weight * difference[a]);
  };
  if (cut.waveform_N.empty()) {
    add(models_[l][c].mean_N(material) - cut.mean_N, 1);
  } else {
    const auto wave = models_[l][c].waveform_N(material, run_out_at(l, p), p[places_[l].phase + static_cast<int>(c)],
                                               static_cast<int>(cut.waveform_N.size()));
    double mean = 0;
    for (const double n : cut.samples) mean += n / static_cast<double>(cut.samples.size());
    for (std::size_t i = 0; i < wave.size(); ++i) add(wave[i] - cut.waveform_N[i], std::sqrt(cut.samples[i] / mean));
  }
  return Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

Eigen::VectorXd ForceProblem::residuals(const Eigen::VectorXd& p) const {
  Eigen::VectorXd out(residuals_);
  for (std::size_t l = 0; l < logs_.size(); ++l)
    for (std::size_t c = 0; c < logs_[l].cuts.size(); ++c) {
      const Eigen::VectorXd r = cut_residuals(l, c, p);
      out.segment(first_residual_[l][c], r.size()) = r;
    }
  return out;
}

double ForceProblem::step_of(Eigen::Index i, double value) const {
  if (i < static_cast<Eigen::Index>(free_.size()))
    return (coefficient(static_cast<std::size_t>(i)).role == CoefficientRole::shape ? 1e-5 : 1e-4) *
           std::max(1.0, std::abs(value));
  constexpr double kRunOut_mm = 2e-5, kPhase_rad = 1e-4;
  for (const LogPlace& place : places_)
    if (i >= place.run_out && i < place.run_out + place.run_out_size) return kRunOut_mm;
  return kPhase_rad;
}

Eigen::MatrixXd ForceProblem::jacobian(const Eigen::VectorXd& p) const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(residuals_, size_);
  const auto column = [&](Eigen::Index i, std::size_t l, std::size_t c) {
    const double step = step_of(i, p[i]);
    Eigen::VectorXd q = p;
    q[i] = p[i] + step;
    const Eigen::VectorXd above = cut_residuals(l, c, q);
    q[i] = p[i] - step;
    const Eigen::VectorXd below = cut_residuals(l, c, q);
    out.col(i).segment(first_residual_[l][c], above.size()) = (above - below) / (2 * step);
  };
  for (std::size_t l = 0; l < logs_.size(); ++l)
    for (std::size_t c = 0; c < logs_[l].cuts.size(); ++c) {
      for (std::size_t i = 0; i < free_.size(); ++i) column(static_cast<Eigen::Index>(i), l, c);
      for (int i = 0; i < places_[l].run_out_size; ++i) column(places_[l].run_out + i, l, c);
      if (!logs_[l].cuts[c].waveform_N.empty()) column(places_[l].phase + static_cast<Eigen::Index>(c), l, c);
    }
  return out;
}

double ForceProblem::held_out_rms_N(const Eigen::VectorXd& p) const {
  double sum = 0, n = 0;
  for (std::size_t l = 0; l < logs_.size(); ++l)
    for (std::size_t c = 0; c < logs_[l].cuts.size(); ++c) {
      const MeasuredCut& cut = logs_[l].cuts[c];
      if (cut.held_out_N.empty()) continue;
      const auto wave =
          models_[l][c].waveform_N(material_at(p), run_out_at(l, p), p[places_[l].phase + static_cast<int>(c)],
                                   static_cast<int>(cut.held_out_N.size()));
      for (std::size_t i = 0; i < wave.size(); ++i)
        for (int a = 0; a < 3; ++a)
          if (logs_[l].has[static_cast<std::size_t>(a)]) {
            sum += std::pow(wave[i][a] - cut.held_out_N[i][a], 2);
            n += 1;
          }
    }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

namespace {

using machine::Material;

constexpr std::size_t kLinear = 6;
using Linear = Eigen::Matrix<double, 6, 1>;

/// Returns the forces of a cut by one unit of each linear coefficient: rows as in the residuals, all three components.
Eigen::MatrixXd basis(const deflection::SteadyCutModel& model, std::size_t steps) {
  const auto& all = machine::description(machine::ForceLaw::linear).fitted;
  Eigen::MatrixXd out(3 * static_cast<Eigen::Index>(std::max<std::size_t>(1, steps)), kLinear);
  for (std::size_t i = 0; i < kLinear; ++i) {
    Material unit;
    unit.*(all[i].field) = 1;
    const auto column = static_cast<Eigen::Index>(i);
    if (steps == 0) {
      out.col(column) = model.mean_N(unit);
    } else {
      const auto wave = model.waveform_N(unit, deflection::RunOut::Zero(), 0, static_cast<int>(steps));
      for (std::size_t k = 0; k < steps; ++k) out.col(column).segment<3>(3 * static_cast<Eigen::Index>(k)) = wave[k];
    }
  }
  return out;
}

/// Sums of the normal equations over cuts.
struct Normal {
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  Linear b = Linear::Zero();
  double squares = 0;

  void add(const Eigen::MatrixXd& rows, const Eigen::VectorXd& measured) {
    a += rows.transpose() * rows;
    b += rows.transpose() * measured;
    squares += measured.squaredNorm();
  }
  /// Directions that the cuts do not tell come out as zero.
  Linear solve() const {
    Linear scale;
    for (int i = 0; i < 6; ++i) scale[i] = a(i, i) > 1e-18 * a.diagonal().maxCoeff() ? 1 / std::sqrt(a(i, i)) : 0;
    Eigen::Matrix<double, 6, 6> scaled = scale.asDiagonal() * a * scale.asDiagonal();
    scaled.diagonal().array() += 1e-9;
    return scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * b);
  }
  double left() const {
    const Linear x = solve();
    return squares - 2 * x.dot(b) + x.dot(a * x);
  }
};

/// Rows turned on by `shift` steps; components that were not measured are zero.
Eigen::MatrixXd turned(const Eigen::MatrixXd& rows, Eigen::Index shift, const std::array<bool, 3>& has) {
  const Eigen::Index steps = rows.rows() / 3;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows.rows(), rows.cols());
  for (Eigen::Index k = 0; k < steps; ++k)
    for (int a = 0; a < 3; ++a)
      if (has[static_cast<std::size_t>(a)]) out.row(3 * k + a) = rows.row(3 * ((k + shift) % steps) + a);
  return out;
}

Eigen::VectorXd measured_rows(const MeasuredCut& cut, const std::array<bool, 3>& has) {
  const std::size_t steps = std::max<std::size_t>(1, cut.waveform_N.size());
  Eigen::VectorXd out(3 * static_cast<Eigen::Index>(steps));
  for (std::size_t k = 0; k < steps; ++k)
    for (int a = 0; a < 3; ++a)
      out[3 * static_cast<Eigen::Index>(k) + a] = !has[static_cast<std::size_t>(a)] ? 0
                                                  : cut.waveform_N.empty()          ? cut.mean_N[a]
                                                                                    : cut.waveform_N[k][a];
  return out;
}

/// Coefficients of the problem's law from those of the linear one, in the order of `basis`.
void set_coefficients(const ForceProblem& problem, const Linear& linear, Eigen::VectorXd& p) {
  const MeasuredLog& log = problem.logs().front();
  const double h = 2 / kPi * log.cuts.front().cut.feed_per_tooth_mm;
  const machine::LinearForce force{{linear[0], linear[2], linear[4]}, {linear[1], linear[3], linear[5]}};
  const Material start = machine::description(log.how.law).start(force, h);
  for (std::size_t i = 0; i < problem.coefficient_count(); ++i)
    p[static_cast<Eigen::Index>(i)] = start.*problem.coefficient(i).field;
}

}  // namespace

Eigen::VectorXd start_without_run_out(const ForceProblem& problem) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(problem.size());
  Normal all;
  for (std::size_t l = 0; l < problem.logs().size(); ++l) {
    const MeasuredLog& log = problem.logs()[l];
    for (std::size_t c = 0; c < log.cuts.size(); ++c) {
      const std::size_t steps = log.cuts[c].waveform_N.size();
      const Eigen::MatrixXd rows = basis(problem.model(l, c), steps);
      const Eigen::VectorXd measured = measured_rows(log.cuts[c], log.has);
      Eigen::Index best = 0;
      double least = INFINITY;
      for (Eigen::Index shift = 0; shift < static_cast<Eigen::Index>(steps) / log.how.tool.flutes; ++shift) {
        Normal one;
        one.add(turned(rows, shift, log.has), measured);
        const double left = one.left();
        if (left < least) least = left, best = shift;
      }
      all.add(turned(rows, best, log.has), measured);
      if (steps > 0)
        p[problem.places()[l].phase + static_cast<Eigen::Index>(c)] =
            2 * kPi * static_cast<double>(best) / static_cast<double>(steps);
    }
  }
  set_coefficients(problem, all.solve(), p);
  return p;
}

std::vector<Eigen::VectorXd> starts_with_run_out(const ForceProblem& problem, const Eigen::VectorXd& without) {
  constexpr int kDirections = 12;
  constexpr std::size_t kKept = 3;
  std::vector<std::pair<double, Eigen::VectorXd>> found;
  for (int d = 0; d < kDirections; ++d) {
    Eigen::VectorXd p = without;
    bool any = false;
    for (std::size_t l = 0; l < problem.logs().size(); ++l) {
      const auto& place = problem.places()[l];
      const MeasuredLog& log = problem.logs()[l];
      if (place.run_out_size == 0) continue;
      any = true;
      const double offset = 0.25 * log.cuts.front().cut.feed_per_tooth_mm, angle = 2 * kPi * d / kDirections;
      p[place.run_out] = place.run_out_size == 1 ? offset : offset * std::cos(angle);
      if (place.run_out_size > 1) p[place.run_out + 1] = offset * std::sin(angle);
      for (std::size_t c = 0; c < log.cuts.size(); ++c) {
        const auto at = place.phase + static_cast<Eigen::Index>(c);
        double least = INFINITY, best = without[at];
        for (int tooth = 0; tooth < log.how.tool.flutes; ++tooth) {
          p[at] = without[at] + 2 * kPi * tooth / log.how.tool.flutes;
          const double left = problem.residuals(p).squaredNorm();
          if (left < least) least = left, best = p[at];
        }
        p[at] = best;
      }
    }
    if (!any) return {};
    found.emplace_back(problem.residuals(p).squaredNorm(), p);
  }
  std::ranges::sort(found, {}, [](const auto& f) { return f.first; });
  std::vector<Eigen::VectorXd> out;
  for (std::size_t i = 0; i < std::min(kKept, found.size()); ++i) out.push_back(found[i].second);
  return out;
}

}  // namespace camber::calib
