#include "calib/force_start.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace camber::calib {
namespace {

using machine::Material;

constexpr std::size_t kLinear = 6;
using Linear = Eigen::Matrix<double, 6, 1>;

/// What one unit of each linear coefficient makes of a cut: rows as in the residuals, all three components.
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
