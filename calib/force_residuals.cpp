#include "calib/force_residuals.h"

#include <algorithm>
#include <cmath>

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

}  // namespace camber::calib
