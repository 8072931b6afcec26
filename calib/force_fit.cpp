#include "calib/force_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "base/units.h"
#include "calib/force_residuals.h"

namespace camber::calib {
namespace {

using machine::Coefficient;
using machine::CoefficientRole;

constexpr double kMinSingular = 1e-3;  // of the Jacobian with columns of length one

class Cost final : public ceres::CostFunction {
 public:
  explicit Cost(const ForceProblem& problem) : problem_(problem) {
    set_num_residuals(static_cast<int>(problem.residual_count()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd p = Eigen::Map<const Eigen::VectorXd>(parameters[0], problem_.size());
    Eigen::Map<Eigen::VectorXd>(residuals, problem_.residual_count()) = problem_.residuals(p);
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          jacobians[0], problem_.residual_count(), problem_.size()) = problem_.jacobian(p);
    return true;
  }

 private:
  const ForceProblem& problem_;
};

struct Solution {
  Eigen::VectorXd p;
  double cost = INFINITY;
  bool converged = false;
};

Solution solve(const ForceProblem& problem, const Eigen::VectorXd& start) {
  Solution out{start};
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(new Cost(problem), nullptr, out.p.data());
  for (std::size_t i = 0; i < problem.coefficient_count(); ++i) {
    const Coefficient& c = problem.coefficient(i);
    if (c.role != CoefficientRole::shape) continue;
    if (std::isfinite(c.range.min))
      ceres_problem.SetParameterLowerBound(out.p.data(), static_cast<int>(i), c.range.min);
    if (std::isfinite(c.range.max))
      ceres_problem.SetParameterUpperBound(out.p.data(), static_cast<int>(i), c.range.max);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  out.cost = summary.final_cost;
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  return out;
}

/// Returns the feed per tooth that all cuts share; nothing where they differ by more than 2 %.
std::optional<double> only_feed_mm(const std::vector<MeasuredLog>& logs) {
  const double first = logs.front().cuts.front().cut.feed_per_tooth_mm;
  for (const auto& log : logs)
    for (const auto& cut : log.cuts)
      if (std::abs(cut.cut.feed_per_tooth_mm - first) > 0.02 * first) return std::nullopt;
  return first;
}

[[noreturn]] void refuse(const ForceProblem& problem, const std::vector<std::size_t>& undetermined, bool alone) {
  const auto& logs = problem.logs();
  std::vector<std::string> names, quoted;
  bool axial = true;
  for (const std::size_t i : undetermined) {
    names.emplace_back(problem.coefficient(i).key);
    quoted.push_back(fmt::format("\"{}\"", names.back()));
    axial = axial && problem.coefficient(i).component == machine::Component::axial;
  }
  const bool no_fz = std::ranges::none_of(logs, [](const auto& log) { return log.has[2]; });
  const auto feed = only_feed_mm(logs);
  const std::string why =
      axial && no_fz ? "the log has no fz, the force along the axis"
      : alone        ? fmt::format("none of the measured forces depends on {}", names.size() > 1 ? "them" : "it")
      : feed ? fmt::format("all cuts have one feed per tooth, {:.4g} mm; cuts at different feeds were expected", *feed)
             : "they determine only a combination; cuts at other feeds, depths or widths, or the force that is not "
               "measured, were expected";
  fail_on_file(
      logs.front().path,
      fmt::format("the cuts do not determine {}: {} (hold = [{}] in [force_log] keeps the values of [material])",
                  fmt::join(names, " and "), why, fmt::join(quoted, ", ")),
      "not-identifiable");
}

/// Refuses coefficients that the cuts cannot tell, at p. Run-out and phases take no part.
void check_told(const ForceProblem& problem, const Eigen::VectorXd& p) {
  const auto n = static_cast<Eigen::Index>(problem.coefficient_count());
  if (n == 0) fail_on_file(problem.logs().front().path, "hold leaves no coefficient to fit", "not-identifiable");
  Eigen::MatrixXd j = problem.jacobian(p).leftCols(n);
  const double largest = j.colwise().norm().maxCoeff();
  std::vector<std::size_t> empty;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double length = j.col(i).norm();
    if (length <= 1e-8 * largest)  // what rounding leaves
      empty.push_back(static_cast<std::size_t>(i));
    else
      j.col(i) /= length;
  }
  if (!empty.empty()) refuse(problem, empty, true);
  // Thin of rows: pad, so that every direction has its singular value.
  if (j.rows() < n) {
    const Eigen::Index rows = j.rows();
    j.conservativeResize(n, Eigen::NoChange);
    j.bottomRows(n - rows).setZero();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinU | Eigen::ComputeThinV);
  std::vector<std::size_t> undetermined;
  constexpr double kTakesPart = 0.1;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      if (svd.singularValues()[k] < kMinSingular && std::abs(svd.matrixV()(i, k)) > kTakesPart) {
        undetermined.push_back(static_cast<std::size_t>(i));
        break;
      }
  if (!undetermined.empty()) refuse(problem, undetermined, false);
}

void check_logs(const std::vector<MeasuredLog>& logs) {
  for (const auto& log : logs) {
    if (log.how.law != logs.front().how.law)
      fail_on_file(log.how.path, "fits another law than the first job; one law for all logs was expected", "force-log");
    if (log.how.hold != logs.front().how.hold)
      fail_on_file(log.how.path, "holds other coefficients than the first job; the same were expected", "force-log");
    if (!log.how.hold.empty() && (!log.how.material || log.how.material->law != log.how.law))
      fail_on_file(log.how.path,
                   fmt::format("holds coefficients, but has no [material] of law \"{}\" with their values",
                               machine::description(log.how.law).word),
                   "force-log");
  }
}

/// Renames the teeth so that tooth 1 is the one nearest to the direction of the offset.
void name_teeth(const ForceProblem& problem, Eigen::VectorXd& p) {
  for (std::size_t l = 0; l < problem.logs().size(); ++l) {
    const auto& place = problem.places()[l];
    if (place.run_out_size == 0) continue;
    const Vec2 offset = problem.run_out_at(l, p);
    const double pitch = 2 * kPi / problem.logs()[l].how.tool.flutes;
    const double turn = pitch * std::round(std::atan2(offset.y(), offset.x()) / pitch);
    p[place.run_out] = std::cos(turn) * offset.x() + std::sin(turn) * offset.y();
    if (place.run_out_size > 1) p[place.run_out + 1] = -std::sin(turn) * offset.x() + std::cos(turn) * offset.y();
    for (std::size_t c = 0; c < problem.logs()[l].cuts.size(); ++c)
      p[place.phase + static_cast<Eigen::Index>(c)] -= turn;
  }
}

/// Covariance of the parameters; nothing where the cuts leave no degree of freedom or a direction undetermined.
std::optional<Eigen::MatrixXd> covariance(const Eigen::MatrixXd& j, const Eigen::VectorXd& r) {
  const Eigen::Index freedom = j.rows() - j.cols();
  if (freedom <= 0) return std::nullopt;
  const Eigen::VectorXd scale = j.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = j * scale.asDiagonal();
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(scaled.transpose() * scaled);
  if (!lu.isInvertible()) return std::nullopt;
  return scale.asDiagonal() * lu.inverse() * scale.asDiagonal() * r.squaredNorm() / static_cast<double>(freedom);
}

/// Each cut of means predicted from the others, by the leverage of its rows.
std::optional<double> left_out_rms_N(const ForceProblem& problem, const Eigen::MatrixXd& j, const Eigen::VectorXd& r) {
  const Eigen::FullPivLU<Eigen::MatrixXd> normal(j.transpose() * j);
  if (!normal.isInvertible()) return std::nullopt;
  const Eigen::MatrixXd inverse = normal.inverse();
  double sum = 0;
  Eigen::Index row = 0;
  for (const auto& log : problem.logs()) {
    const Eigen::Index n = std::ranges::count(log.has, true);
    for (std::size_t c = 0; c < log.cuts.size(); ++c, row += n) {
      const Eigen::MatrixXd rows = j.middleRows(row, n);
      const Eigen::FullPivLU<Eigen::MatrixXd> rest(Eigen::MatrixXd::Identity(n, n) - rows * inverse * rows.transpose());
      if (!rest.isInvertible() || rest.rcond() < 1e-9) return std::nullopt;
      sum += rest.solve(r.segment(row, n)).squaredNorm();
    }
  }
  return std::sqrt(sum / static_cast<double>(row));
}

void report_coefficients(const ForceProblem& problem, const Solution& s, const std::optional<Eigen::MatrixXd>& cov,
                         FitForceResult& out) {
  const machine::ForceLog& how = problem.logs().front().how;
  for (const Coefficient& c : machine::description(how.law).fitted) {
    ForceParameter parameter{std::string(c.key), std::string(c.unit), out.material.*(c.field), std::nullopt, "held"};
    for (std::size_t i = 0; i < problem.coefficient_count(); ++i) {
      if (&problem.coefficient(i) != &c) continue;
      const auto at = static_cast<Eigen::Index>(i);
      parameter.value = s.p[at];
      parameter.note = cov ? "" : "as many values as parameters: no standard error";
      if (!cov) continue;
      parameter.std_error = std::sqrt(std::max(0.0, (*cov)(at, at)));
      if (*parameter.std_error > std::abs(parameter.value))
        parameter.note = "poorly determined: the error exceeds the value";
    }
    out.parameters.push_back(std::move(parameter));
  }
}

void report_run_out(const ForceProblem& problem, const Solution& s, const std::optional<Eigen::MatrixXd>& cov,
                    FitForceResult& out) {
  for (std::size_t l = 0; l < problem.logs().size(); ++l) {
    const MeasuredLog& log = problem.logs()[l];
    if (!log.how.waveform) continue;
    const auto& place = problem.places()[l];
    const Vec2 offset = problem.run_out_at(l, s.p);
    RunOutFit fit{log.path, offset.norm(), std::atan2(offset.y(), offset.x()), 0, {}};
    if (place.run_out_size == 0)
      fit.note = "not fitted: a single tooth cuts after itself";
    else if (place.run_out_size == 1)
      fit.note = "half the difference of the teeth's radii; two teeth with so little lag do not determine an angle";
    if (place.run_out_size > 0) {
      ForceParameter offset_um{"run_out_um", "um", 1000 * fit.offset_mm, std::nullopt, fit.note};
      ForceParameter angle_deg{"run_out_angle_deg", "deg", deg_from_rad(fit.angle_rad), std::nullopt, fit.note};
      if (cov && fit.offset_mm > 0) {
        const Eigen::MatrixXd block = cov->block(place.run_out, place.run_out, place.run_out_size, place.run_out_size);
        const Vec2 along = offset.normalized(), across(-along.y(), along.x());
        const auto variance = [&](const Vec2& d) {
          const Eigen::VectorXd change = d.head(place.run_out_size);
          return change.dot(block * change);
        };
        fit.offset_std_error_mm = std::sqrt(std::max(0.0, variance(along)));
        offset_um.std_error = 1000 * fit.offset_std_error_mm;
        if (place.run_out_size > 1)
          angle_deg.std_error = deg_from_rad(std::sqrt(std::max(0.0, variance(across))) / fit.offset_mm);
      }
      out.parameters.push_back(std::move(offset_um));
      if (place.run_out_size > 1) out.parameters.push_back(std::move(angle_deg));
    }
    out.run_out.push_back(std::move(fit));
  }
}

/// No cutting coefficient is negative that [material] would refuse.
bool plausible(const machine::Material& m) {
  return std::ranges::all_of(machine::description(m.law).coefficients, [&](const Coefficient& c) {
    return c.role != CoefficientRole::cutting || m.*c.field >= c.range.min;
  });
}

}  // namespace

FitForceResult fit_force(const std::vector<MeasuredLog>& logs) {
  check_logs(logs);
  const ForceProblem problem(logs);
  const Eigen::VectorXd start = start_without_run_out(problem);
  check_told(problem, start);
  Solution best = solve(problem, start);
  for (const Eigen::VectorXd& other : starts_with_run_out(problem, best.p)) {
    const Solution s = solve(problem, other);
    if (s.cost < best.cost) best = s;
  }
  name_teeth(problem, best.p);
  check_told(problem, best.p);

  FitForceResult out;
  out.material = problem.material_at(best.p);
  out.converged = best.converged;
  const Eigen::VectorXd r = problem.residuals(best.p);
  const Eigen::MatrixXd j = problem.jacobian(best.p);
  const auto cov = covariance(j, r);
  report_coefficients(problem, best, cov, out);
  report_run_out(problem, best, cov, out);
  for (std::size_t l = 0; l < logs.size(); ++l)
    for (std::size_t c = 0; c < logs[l].cuts.size(); ++c) {
      const MeasuredCut& cut = logs[l].cuts[c];
      Vec3 model = problem.model(l, c).mean_N(out.material);
      if (!cut.waveform_N.empty()) {
        model.setZero();
        const auto wave =
            problem.model(l, c).waveform_N(out.material, problem.run_out_at(l, best.p),
                                           best.p[problem.places()[l].phase + static_cast<Eigen::Index>(c)], 360);
        for (const Vec3& f : wave) model += f / static_cast<double>(wave.size());
      }
      out.cuts.push_back({cut.name, cut.mean_N, model, logs[l].has});
    }
  out.residual_rms_N = std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
  const bool waveforms = std::ranges::any_of(logs, [](const auto& log) { return log.how.waveform; });
  out.held_out_rms_N = waveforms ? std::optional(problem.held_out_rms_N(best.p)) : left_out_rms_N(problem, j, r);
  out.plausible = plausible(out.material);
  out.message = !out.plausible ? "a tangential or radial coefficient is negative, which no cutter has; check the axes "
                                 "and signs of [force_log]"
                : best.converged ? "the fit converged"
                                 : "the fit did not converge; its values are uncertain";
  return out;
}

}  // namespace camber::calib
