#include "calib/parts_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "calib/parts_unknowns.h"
#include "inspect/evaluate.h"
#include "kinematics/machine_program.h"
#include "machine/force_law.h"
#include "machine/set_number.h"
#include "nc/interpreter.h"
#include "simulate/setup.h"

namespace camber::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using machine::Job;

constexpr double kStep = 0.2;        // of a scale, for slopes: large against the noise of a grid
constexpr double kLeastStep = 0.05;  // of a scale, that corrects slopes: less is the noise of a grid
constexpr double kNear = 0.2;        // of a force or a compliance, from where slopes were found
constexpr int kSlopeRounds = 1;
constexpr double kRise = 3, kFall = 0.8;  // of a scale, a round
constexpr double kDetermined = 0.5;       // greatest standard error of a scale, of its start or of its value
constexpr double kDetermined_mm = 0.02;   // of an offset, mm; of a drift, mm a day
constexpr double kNoise_mm = 0.002;       // of a measured size, before anything is known of it
constexpr double kWorth = 1;              // values that this is worth beside those of the residuals
constexpr double kLeastNoise_mm = 0.0002;
constexpr double kHuber = 2.5;                // standard deviations: normal noise stays least squares
constexpr double kBoundedVariance = 0.97756;  // of a standard normal variable bounded to +- kHuber
constexpr double kRank = 1e-6;                // columns of unit length are a combination of others within this
constexpr double kAtRest = 0.05;              // of a standard error
constexpr double kAlike = 0.9;                // cosine between two columns that cannot be told apart

/// Robust linear least squares by Ceres: residual (row . x - b) / sigma.
class LinearRow final : public ceres::CostFunction {
 public:
  LinearRow(VectorXd row, double value) : row_(std::move(row)), value_(value) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(row_.size()));
  }
  bool Evaluate(const double* const* x, double* residual, double** slope) const override {
    residual[0] = row_.dot(Eigen::Map<const VectorXd>(x[0], row_.size())) - value_;
    if (slope && slope[0]) Eigen::Map<VectorXd>(slope[0], row_.size()) = row_;
    return true;
  }

 private:
  VectorXd row_;
  double value_;
};

struct Solution {
  VectorXd x;
  bool converged = false;
  double noise_mm = kNoise_mm;
};

Solution solve_linear(const MatrixXd& a, const VectorXd& b, double sigma, const VectorXd& lowest,
                      const VectorXd& highest) {
  Solution out{VectorXd::Zero(a.cols())};
  ceres::Problem problem;
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    problem.AddResidualBlock(new LinearRow(a.row(i).transpose() / sigma, b[i] / sigma), new ceres::HuberLoss(kHuber),
                             out.x.data());
  for (int k = 0; k < a.cols(); ++k) {
    problem.SetParameterLowerBound(out.x.data(), k, lowest[k]);
    problem.SetParameterUpperBound(out.x.data(), k, highest[k]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  out.converged = summary.IsSolutionUsable();
  return out;
}

using Sizes = std::vector<std::optional<PredictedSize>>;

constexpr double kNoBending_mm = 0.0001;

bool of_motion(UnknownKind kind) { return kind == UnknownKind::gain || kind == UnknownKind::gain_ratio; }

class Fit {
 public:
  Fit(const std::vector<Job>& jobs, const FitPartsOptions& options)
      : jobs_(jobs),
        options_(options),
        rows_(rows_of(jobs, options.hold_out)),
        unknowns_(unknowns_of(jobs, rows_)),
        x_(VectorXd::Zero(size())),
        active_(unknowns_.size(), true) {}

  FitPartsResult run() {
    if (rows_.empty())
      fail_on_file(jobs_.empty() ? std::string("fit-parts") : jobs_.front().path,
                   "no feature has a measured value; [[feature]] with measured_mm or measured was expected",
                   "parts-unmeasured");
    sizes_ = predict_all();
    leave_out_unpredicted();
    if (fitted_.empty()) {
      out_.message = "no measured feature has a prediction";
      return finish();
    }
    find_slopes();
    choose();
    do {
      iterate();
      for (int k = 0; k < kSlopeRounds && far_from_slopes(); ++k) {  // they were those of another place
        find_slopes();
        iterate();
      }
    } while (drop_undetermined() || take_refused());
    return finish();
  }

 private:
  Eigen::Index size() const { return static_cast<Eigen::Index>(unknowns_.size()); }

  Job job_at(std::size_t j, const VectorXd& x) const {
    Job job = jobs_[j];
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      if (!unknowns_[k].adds() && unknowns_[k].of_job[j] && x[static_cast<Eigen::Index>(k)] != 0)
        unknowns_[k].apply(job, x[static_cast<Eigen::Index>(k)]);
    return job;
  }

  Sizes predict(std::size_t j, const VectorXd& x) {
    ++out_.predictions;
    return options_.predict(job_at(j, x));
  }
  Sizes predict_coarsely(std::size_t j, const VectorXd& x, bool rigid) {
    ++out_.predictions;
    Job job = coarser(job_at(j, x));
    if (rigid) job.simulation.coupling = machine::Coupling::rigid;
    return options_.predict(job);
  }

  bool bends(const Sizes& sizes) const {
    return std::ranges::any_of(sizes, [](const auto& s) { return s && std::abs(s->deflection_mm) > kNoBending_mm; });
  }

  void show(const std::string& what, std::size_t done, std::size_t all) const {
    if (options_.progress) options_.progress(what, static_cast<double>(done) / static_cast<double>(all));
  }

  std::vector<Sizes> predict_all() {
    std::vector<Sizes> out;
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      show("predicting all parts", j, jobs_.size());
      out.push_back(predict(j, x_));
    }
    return out;
  }

  void leave_out_unpredicted() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (sizes_[rows_[i].job][rows_[i].feature]) {
        if (!rows_[i].held_out) fitted_.push_back(i);
        continue;
      }
      const std::string text =
          fmt::format("{}: {}", job_name(jobs_[rows_[i].job]), jobs_[rows_[i].job].features[rows_[i].feature].name);
      if (std::ranges::find(out_.left_out, text) == out_.left_out.end()) out_.left_out.push_back(text);
    }
  }

  /// What a step of an unknown is compared with.
  double magnitude(std::size_t k, const VectorXd& x) const {
    return unknowns_[k].kind == UnknownKind::gain_ratio ? 1 : 1 + x[static_cast<Eigen::Index>(k)];
  }

  bool is_fitted_job(std::size_t j) const {
    return std::ranges::any_of(fitted_, [&](std::size_t i) { return rows_[i].job == j; });
  }

  /// Whether forces or compliances, which multiply each other, have moved since slopes were found. Sizes are linear in
  /// the lag.
  bool far_from_slopes() const {
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      if (!unknowns_[k].adds() && !of_motion(unknowns_[k].kind) &&
          std::abs(x_[static_cast<Eigen::Index>(k)] - slopes_at_[static_cast<Eigen::Index>(k)]) >
              kNear * magnitude(k, slopes_at_))
        return true;
    return false;
  }

  /// Slopes of all sizes by the unknowns of the model; those of the motion the first time.
  void find_slopes() {
    slopes_at_ = x_;
    const bool first = slope_.empty();
    slope_.resize(jobs_.size());
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      show("slopes", j, jobs_.size());
      if (first) slope_[j] = MatrixXd::Zero(static_cast<Eigen::Index>(jobs_[j].features.size()), size());
      if (!is_fitted_job(j)) continue;
      if (first) find_slopes_of(j, true);
      if (bends(sizes_[j])) find_slopes_of(j, false);
    }
  }

  /// Finds the slopes of a job's sizes by the unknowns of the motion, or by those of forces and stiffness.
  void find_slopes_of(std::size_t j, bool motion) {
    std::optional<Sizes> here;
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      if (unknowns_[k].adds() || !unknowns_[k].of_job[j] || of_motion(unknowns_[k].kind) != motion) continue;
      if (!here) here = predict_coarsely(j, x_, motion);
      const auto column = static_cast<Eigen::Index>(k);
      // The ratio of two gains may be at either of its bounds: its slope is taken centrally.
      const bool central = unknowns_[k].kind == UnknownKind::gain_ratio;
      VectorXd above = x_, below = x_;
      above[column] = std::min(x_[column] + kStep * magnitude(k, x_), unknowns_[k].highest());
      if (central) below[column] = std::max(x_[column] - kStep, unknowns_[k].lowest());
      const Sizes there = predict_coarsely(j, above, motion);
      const Sizes back = central ? predict_coarsely(j, below, motion) : *here;
      for (std::size_t f = 0; f < there.size(); ++f)
        if (there[f] && back[f])
          slope_[j](static_cast<Eigen::Index>(f), column) =
              (there[f]->size_mm - back[f]->size_mm) / (above[column] - below[column]);
    }
  }

  double slope_of(const PartsRow& row, std::size_t k) const {
    const PartsUnknown& u = unknowns_[k];
    if (u.kind == UnknownKind::offset)
      return row.clamping == u.clamping && row.tool == u.tool ? row.size_per_diameter : 0;
    if (u.kind == UnknownKind::drift) return row.day.value_or(0);
    return slope_[row.job](static_cast<Eigen::Index>(row.feature), static_cast<Eigen::Index>(k));
  }

  std::vector<std::size_t> active() const {
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < active_.size(); ++k)
      if (active_[k]) out.push_back(k);
    return out;
  }

  MatrixXd columns(const std::vector<std::size_t>& ks) const {
    MatrixXd a(static_cast<Eigen::Index>(fitted_.size()), static_cast<Eigen::Index>(ks.size()));
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      for (Eigen::Index k = 0; k < a.cols(); ++k)
        a(i, k) = slope_of(rows_[fitted_[static_cast<std::size_t>(i)]], ks[static_cast<std::size_t>(k)]);
    return a;
  }

  double predicted(const PartsRow& row) const {
    double size = sizes_[row.job][row.feature]->size_mm;
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      if (unknowns_[k].adds()) size += slope_of(row, k) * x_[static_cast<Eigen::Index>(k)];
    return size;
  }

  VectorXd residuals() const {
    VectorXd out(static_cast<Eigen::Index>(fitted_.size()));
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      const PartsRow& row = rows_[fitted_[static_cast<std::size_t>(i)]];
      out[i] = row.measured_mm - predicted(row);
    }
    return out;
  }

  /// Greatest standard error of an unknown that is determined as x.
  double limit(std::size_t k, double x) const {
    if (unknowns_[k].adds()) return kDetermined_mm;
    return unknowns_[k].kind == UnknownKind::gain_ratio ? kDetermined : kDetermined * std::max(1.0, 1 + x);
  }

  /// Covariance of `ks` where each value has a variance of 1; nothing where they are not determined at all.
  std::optional<MatrixXd> unit_covariance(const std::vector<std::size_t>& ks) const {
    const MatrixXd a = columns(ks);
    const VectorXd scale = a.colwise().norm();
    if ((scale.array() <= 0).any() || a.rows() < a.cols()) return std::nullopt;
    const MatrixXd unit = a * scale.cwiseInverse().asDiagonal();
    Eigen::ColPivHouseholderQR<MatrixXd> qr;
    if (qr.setThreshold(kRank).compute(unit).rank() < a.cols()) return std::nullopt;
    const MatrixXd c = (unit.transpose() * unit).ldlt().solve(MatrixXd::Identity(a.cols(), a.cols()));
    return scale.cwiseInverse().asDiagonal() * c * scale.cwiseInverse().asDiagonal();
  }

  /// Standard errors of `ks` where each value has this noise; infinite where they are not determined at all.
  VectorXd std_errors(const std::vector<std::size_t>& ks, double sigma_mm) const {
    const auto c = unit_covariance(ks);
    if (!c) return VectorXd::Constant(static_cast<Eigen::Index>(ks.size()), INFINITY);
    return sigma_mm * c->diagonal().cwiseMax(0).cwiseSqrt();
  }

  /// Of the linear model, within what may change in a round. Twice: the first solution shows the noise.
  Solution solve(const std::vector<std::size_t>& ks) const {
    const MatrixXd a = columns(ks);
    VectorXd lowest(a.cols()), highest(a.cols());
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
      const std::size_t k = ks[static_cast<std::size_t>(i)];
      const double at = x_[static_cast<Eigen::Index>(k)], size = magnitude(k, x_);
      lowest[i] = std::max(unknowns_[k].lowest() - at, -kFall * size);
      highest[i] = std::min(unknowns_[k].highest() - at, kRise * size);
    }
    Solution out;
    for (double sigma : {10 * kNoise_mm, 0.0}) {
      out = solve_linear(a, residuals(), sigma > 0 ? sigma : out.noise_mm, lowest, highest);
      out.noise_mm = noise_mm(residuals() - a * out.x, a.cols());
    }
    return out;
  }

  /// By their errors at the solution of the linear model, with a noise that few values do not make small.
  bool all_determined(const std::vector<std::size_t>& ks) const {
    if (!std_errors(ks, 1).allFinite()) return false;
    const Solution s = solve(ks);
    const double dof = std::max<double>(1, static_cast<double>(fitted_.size()) - static_cast<double>(ks.size()));
    const double noise = std::sqrt((dof * s.noise_mm * s.noise_mm + kWorth * kNoise_mm * kNoise_mm) / (dof + kWorth));
    const VectorXd errors = std_errors(ks, noise);
    for (Eigen::Index i = 0; i < errors.size(); ++i) {
      const std::size_t k = ks[static_cast<std::size_t>(i)];
      if (!(errors[i] < limit(k, x_[static_cast<Eigen::Index>(k)] + s.x[i]))) return false;
    }
    return true;
  }

  /// The unknown taken before whose column is most like this one's.
  const PartsUnknown* alike(std::size_t k, const std::vector<std::size_t>& taken) const {
    const MatrixXd all = columns(taken);
    const VectorXd own = columns({k});
    const PartsUnknown* out = nullptr;
    double most = kAlike;
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
      const double cosine = std::abs(all.col(i).dot(own)) / std::max(all.col(i).norm() * own.norm(), 1e-300);
      if (cosine > most) most = cosine, out = &unknowns_[taken[static_cast<std::size_t>(i)]];
    }
    return out;
  }

  void refuse(std::size_t k, const std::vector<std::size_t>& taken) {
    active_[k] = false;
    const PartsUnknown* other = alike(k, taken);
    const bool moves = columns({k}).norm() > 0;
    refused_[k] = {!moves  ? "no measured size depends on it"
                   : other ? fmt::format("cannot be told apart from {}", other->name)
                           : "not determined by these sizes",
                   suggestion_for(unknowns_[k], other)};
  }

  /// Whether an unknown may be taken: what else bends the tool stands for an unknown force where forces are not taken.
  bool forces_come_first(std::size_t k) const {
    const UnknownKind kind = unknowns_[k].kind;
    if (unknowns_[k].adds() || of_motion(kind) || kind == UnknownKind::force) return true;
    const std::size_t force = of_kind(UnknownKind::force);
    return force == unknowns_.size() || active_[force];
  }

  /// Takes the unknowns in their order, each if it is determined together with those before.
  void choose() {
    std::vector<std::size_t> taken;
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      taken.push_back(k);
      if (forces_come_first(k) && all_determined(taken)) continue;
      taken.pop_back();
      refuse(k, taken);
    }
  }

  /// Takes an unknown that is determined where the others are now: edges, where forces have grown. Once each. Returns
  /// whether there was one.
  bool take_refused() {
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      if (active_[k] || !taken_again_.insert(k).second) continue;
      active_[k] = true;
      if (forces_come_first(k) && all_determined(active())) return refused_.erase(k), true;
      active_[k] = false;
    }
    return false;
  }

  /// Standard deviation of the residuals, outliers counted as far as the loss does: a first one by their median bounds
  /// them.
  double noise_mm(const VectorXd& r, Eigen::Index unknowns) const {
    std::vector<double> sizes(r.data(), r.data() + r.size());
    for (double& v : sizes) v = std::abs(v);
    std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
    const double dof = std::max<double>(1, static_cast<double>(r.size() - unknowns));
    const double bound = std::max(
        kLeastNoise_mm, kHuber * 1.4826 * sizes[sizes.size() / 2] * std::sqrt(static_cast<double>(r.size()) / dof));
    return std::max(kLeastNoise_mm, std::sqrt(r.cwiseAbs().cwiseMin(bound).squaredNorm() / (kBoundedVariance * dof)));
  }

  void iterate() {
    out_.converged = false;
    for (int round = 0; round < options_.max_rounds && !out_.converged; ++round) {
      const std::vector<std::size_t> ks = active();
      if (ks.empty()) {
        out_.converged = true;
        break;
      }
      const Solution step = solve(ks);
      sigma_mm_ = step.noise_mm;
      const VectorXd errors = std_errors(ks, sigma_mm_);
      out_.converged = step.converged && (step.x.cwiseAbs().array() <= kAtRest * errors.array()).all();
      take_step(ks, step.x);
      ++out_.rounds;
    }
  }

  /// Moves to x + dx; real predictions there correct the slopes.
  void take_step(const std::vector<std::size_t>& ks, const VectorXd& step) {
    VectorXd dx = VectorXd::Zero(size());
    for (std::size_t i = 0; i < ks.size(); ++i)
      dx[static_cast<Eigen::Index>(ks[i])] = step[static_cast<Eigen::Index>(i)];
    x_ += dx;
    VectorXd of_model = dx;
    for (std::size_t k = 0; k < unknowns_.size(); ++k)
      if (unknowns_[k].adds()) of_model[static_cast<Eigen::Index>(k)] = 0;
    if (of_model.squaredNorm() < 1e-24) return;
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      if (!is_fitted_job(j)) continue;
      show(fmt::format("round {}", out_.rounds + 1), j, jobs_.size());
      const Sizes there = predict(j, x_);
      VectorXd own = of_model, unit = VectorXd::Ones(size());
      for (std::size_t k = 0; k < unknowns_.size(); ++k) {
        if (unknowns_[k].adds()) continue;
        unit[static_cast<Eigen::Index>(k)] = magnitude(k, x_ - dx);
        if (!unknowns_[k].of_job[j]) own[static_cast<Eigen::Index>(k)] = 0;
      }
      const VectorXd relative = own.cwiseQuotient(unit);
      for (std::size_t f = 0; f < there.size(); ++f) {
        if (!there[f] || !sizes_[j][f]) continue;  // keeps its last prediction
        auto row = slope_[j].row(static_cast<Eigen::Index>(f));
        if (relative.norm() > kLeastStep)
          row += (there[f]->size_mm - sizes_[j][f]->size_mm - row.dot(own)) / relative.squaredNorm() *
                 relative.cwiseQuotient(unit).transpose();
        sizes_[j][f] = there[f];
      }
    }
  }

  /// An unknown whose error has turned out too large goes back to its start. Returns whether one did.
  bool drop_undetermined() {
    const std::vector<std::size_t> ks = active();
    const VectorXd errors = std_errors(ks, sigma_mm_);
    for (std::size_t i = ks.size(); i-- > 0;) {
      const auto at = static_cast<Eigen::Index>(ks[i]);
      if (errors[static_cast<Eigen::Index>(i)] < limit(ks[i], x_[at])) continue;
      std::vector<std::size_t> others = ks;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      refuse(ks[i], others);
      taken_again_.insert(ks[i]);
      if (x_[at] != 0 && !unknowns_[ks[i]].adds()) {
        VectorXd back = VectorXd::Constant(1, -x_[at]);
        take_step({ks[i]}, back);
      }
      x_[at] = 0;
      return true;
    }
    return false;
  }

  // --- what is told

  void predict_held_out() {
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      if (is_fitted_job(j)) continue;
      const Sizes there = predict(j, x_);
      for (std::size_t f = 0; f < there.size(); ++f)
        if (there[f]) sizes_[j][f] = there[f];
    }
  }

  std::pair<double, double> feed_and_speed(const Job& job, int tool) const {
    Diagnostics ignored;
    std::pair<double, double> out{0, 0};
    try {
      const auto program =
          kinematics::open_program(SourceText::read(job.program), job.machine,
                                   {.given = {.inch = job.inch}, .rotary = kinematics::RotaryWords::never}, ignored);
      const nc::Interpretation& moves = program.commanded();
      for (const nc::Move& m : moves.moves) {
        const nc::ModalState& state = moves.state_of(m);
        if (state.tool == tool && m.feed_mm_per_s > 0 && removal::in_operations(moves, m, job.operations))
          out = {60 * m.feed_mm_per_s, state.spindle_speed_rpm};
      }
    } catch (const InputError&) {  // a predictor without programs
    }
    return out;
  }

  void add_residuals() {
    std::map<std::pair<std::size_t, int>, std::pair<double, double>> conditions;
    for (const PartsRow& row : rows_) {
      if (!sizes_[row.job][row.feature]) continue;
      const Job& job = jobs_[row.job];
      const auto [at, fresh] = conditions.try_emplace({row.job, row.tool});
      if (fresh && row.tool != 0) at->second = feed_and_speed(job, row.tool);
      const auto tool = job.tools.find(row.tool);
      out_.residuals.push_back({.job = job_name(job),
                                .feature = job.features[row.feature].name,
                                .part = row.part,
                                .tool = row.tool,
                                .measured_mm = row.measured_mm,
                                .predicted_mm = predicted(row),
                                .feed_mm_per_min = at->second.first,
                                .overhang_mm = tool == job.tools.end() ? 0 : tool->second.overhang_mm,
                                .spindle_rpm = at->second.second,
                                .held_out = row.held_out});
    }
  }

  void add_groups() {
    struct Sum {
      double square = 0;
      int count = 0;
      std::optional<double> rms() const { return count > 0 ? std::optional(std::sqrt(square / count)) : std::nullopt; }
    };
    std::map<std::pair<std::string, int>, std::array<Sum, 2>> sums;
    Sum all;
    for (const PartsResidual& r : out_.residuals) {
      Sum& sum = sums[{r.feature, r.tool}][r.held_out ? 1 : 0];
      sum.square += r.residual_um() * r.residual_um();
      ++sum.count;
      if (!r.held_out) all.square += r.residual_um() * r.residual_um(), ++all.count;
    }
    for (const auto& [key, s] : sums) out_.groups.push_back({key.first, key.second, s[0].rms(), s[1].rms()});
    out_.rms_um = all.rms().value_or(0);
  }

  struct Told {
    double value = 0, start = 0;
    std::optional<double> std_error;
  };

  double x(std::size_t k) const { return x_[static_cast<Eigen::Index>(k)]; }

  std::string note(std::size_t k) const { return refused_.contains(k) ? refused_.at(k).note : std::string(); }

  /// A value that goes with (1 + x)^power.
  Told scaled(double start, std::size_t k, double power, const std::map<std::size_t, double>& std_of) const {
    const double value = start * std::pow(1 + x(k), power);
    const auto at = std_of.find(k);
    return {value, start,
            at == std_of.end() ? std::nullopt : std::optional(std::abs(value * power) * at->second / (1 + x(k)))};
  }

  void tell(const std::string& name, const std::string& unit, const Told& t, const std::string& note) {
    out_.parameters.push_back({name, unit, t.value, t.start, t.std_error, note});
  }

  std::size_t job_of(const PartsUnknown& u) const {
    const auto at = std::ranges::find(u.of_job, true);
    return at == u.of_job.end() ? 0 : static_cast<std::size_t>(at - u.of_job.begin());
  }

  void add_gains(std::size_t k, const std::map<std::size_t, double>& std_of) {
    const auto ratio = std::ranges::find(unknowns_, UnknownKind::gain_ratio, &PartsUnknown::kind);
    const auto r = static_cast<std::size_t>(ratio - unknowns_.begin());
    for (const int axis : {0, 1}) {
      const double start = jobs_[job_of(unknowns_[k])].machine.axis[static_cast<std::size_t>(axis)].position_gain_per_s;
      const double sign = axis == 0 ? 1 : -1;
      Told t = scaled(start, k, -0.5, std_of);
      t.value /= std::sqrt(1 + sign * x(r));
      if (const auto var = variance_of_sum({{k, 0.5 / (1 + x(k))}, {r, 0.5 * sign / (1 + sign * x(r))}}); t.std_error)
        t.std_error = t.value * std::sqrt(*var);
      const bool together = t.std_error && !std_of.contains(r);
      tell(fmt::format("axis.{}.position_gain_per_s", "xy"[axis]), "1/s", t,
           together ? "X and Y together: their ratio is not determined" : note(k));
    }
  }

  std::size_t of_kind(UnknownKind kind) const {
    return static_cast<std::size_t>(std::ranges::find(unknowns_, kind, &PartsUnknown::kind) - unknowns_.begin());
  }

  /// Variance of a weighted sum of determined unknowns; nothing where none of them is.
  std::optional<double> variance_of_sum(std::vector<std::pair<std::size_t, double>> weights) const {
    std::erase_if(weights, [&](const auto& w) { return !index_.contains(w.first); });
    if (weights.empty()) return std::nullopt;
    double var = 0;
    for (const auto& [a, of_a] : weights)
      for (const auto& [b, of_b] : weights) var += of_a * of_b * covariance_(index_.at(a), index_.at(b));
    return std::max(0.0, var);
  }

  void add_forces(std::size_t k, const std::map<std::size_t, double>& std_of) {
    tell("force_scale", "1", scaled(1, k, 1, std_of), note(k));
    const Job &first = jobs_.front(), fitted = job_at(0, x_);
    for (const auto& c : machine::description(first.material.law).coefficients) {
      if (c.role == machine::CoefficientRole::shape || first.material.*c.field == 0) continue;
      std::vector<std::pair<std::size_t, double>> scales{{k, 1 / (1 + x(k))}};
      const auto add = [&](UnknownKind kind) {
        if (const std::size_t s = of_kind(kind); s < unknowns_.size()) scales.emplace_back(s, 1 / (1 + x(s)));
      };
      if (c.role == machine::CoefficientRole::edge) add(UnknownKind::edge);
      if (c.component == machine::Component::radial) add(UnknownKind::radial);
      Told t{fitted.material.*c.field, first.material.*c.field, std::nullopt};
      if (const auto var = variance_of_sum(scales)) t.std_error = std::abs(t.value) * std::sqrt(*var);
      tell(std::string(c.key), std::string(c.unit), t, note(k));
    }
  }

  void add_parameter(std::size_t k, const std::map<std::size_t, double>& std_of) {
    const PartsUnknown& u = unknowns_[k];
    const Job& job = jobs_[job_of(u)];
    const auto own = std_of.contains(k) ? std::optional(std_of.at(k)) : std::nullopt;
    switch (u.kind) {
      case UnknownKind::offset: {
        const double start = job.tools.at(u.tool).diameter_mm;
        return tell(u.name, "mm", {start + x(k), start, own}, note(k));
      }
      case UnknownKind::gain:
        return add_gains(k, std_of);
      case UnknownKind::force:
        return add_forces(k, std_of);
      case UnknownKind::edge:
      case UnknownKind::radial:
        return tell(u.name, "1", scaled(1, k, 1, std_of), note(k));
      case UnknownKind::root:
        return tell(u.name, "N/um", scaled(job.tools.at(u.tool).root_stiffness_N_per_mm / 1000, k, -1, std_of),
                    note(k));
      case UnknownKind::root_rotation:
        return tell(u.name, "Nm/rad",
                    scaled(job.tools.at(u.tool).root_rotational_stiffness_Nmm_per_rad / 1000, k, -1, std_of), note(k));
      case UnknownKind::drift:
        return tell(u.name, "um/day", {1000 * x(k), 0, own ? std::optional(1000 * *own) : own}, note(k));
      case UnknownKind::gain_ratio:
        return;
    }
  }

  void add_parameters() {
    const std::vector<std::size_t> ks = active();
    std::map<std::size_t, double> std_of;
    if (!ks.empty()) {
      covariance_ = sigma_mm_ * sigma_mm_ * unit_covariance(ks).value();
      for (std::size_t i = 0; i < ks.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        index_[ks[i]] = at;
        std_of[ks[i]] = std::sqrt(covariance_(at, at));
      }
      for (std::size_t i = 0; i < ks.size(); ++i)
        for (std::size_t j = i + 1; j < ks.size(); ++j)
          out_.correlations.push_back({unknowns_[ks[i]].name, unknowns_[ks[j]].name,
                                       covariance_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) /
                                           (std_of[ks[i]] * std_of[ks[j]])});
    }
    for (std::size_t k = 0; k < unknowns_.size(); ++k) add_parameter(k, std_of);
    add_model_error(std_of);
  }

  void add_model_error(const std::map<std::size_t, double>& std_of) {
    out_.error = inspect::model_error_of(jobs_.front());
    double offsets = 0;
    int count = 0;
    for (const auto& [k, s] : std_of) {
      if (unknowns_[k].kind == UnknownKind::force) out_.error.deflection = s / (1 + x(k));
      if (unknowns_[k].kind == UnknownKind::gain) out_.error.contour = s / (1 + x(k));  // of v^2 / (r K^2)
      if (unknowns_[k].kind == UnknownKind::offset) offsets += s * s, ++count;
    }
    if (count > 0) out_.error.size_mm = std::hypot(std::sqrt(offsets / count), sigma_mm_);
  }

  FitPartsResult finish() {
    predict_held_out();
    add_residuals();
    add_groups();
    add_parameters();
    for (const auto& [k, refusal] : refused_) {
      out_.confounded.push_back(fmt::format("{}: {}", unknowns_[k].name, refusal.note));
      out_.suggestions.push_back(refusal.suggestion);
    }
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      Job job = job_at(j, x_);
      for (std::size_t k = 0; k < unknowns_.size(); ++k)
        if (unknowns_[k].kind == UnknownKind::offset && unknowns_[k].of_job[j])
          unknowns_[k].apply(job, x_[static_cast<Eigen::Index>(k)]);
      out_.jobs.push_back(std::move(job));
    }
    if (out_.message.empty())
      out_.message = out_.converged ? fmt::format("converged in {} rounds", out_.rounds)
                                    : fmt::format("did not converge in {} rounds", out_.rounds);
    return std::move(out_);
  }

  const std::vector<Job>& jobs_;
  const FitPartsOptions& options_;
  const std::vector<PartsRow> rows_;
  const std::vector<PartsUnknown> unknowns_;
  VectorXd x_;
  VectorXd slopes_at_;  ///< where slope_ was found
  std::vector<bool> active_;
  std::vector<std::size_t> fitted_;  ///< rows
  std::vector<Sizes> sizes_;         ///< of every job, at x_
  std::vector<MatrixXd> slope_;      ///< of every job: features by unknowns
  struct Refusal {
    std::string note, suggestion;
  };
  std::map<std::size_t, Refusal> refused_;     ///< by unknown
  std::set<std::size_t> taken_again_;          ///< unknowns that are not taken once more
  std::map<std::size_t, Eigen::Index> index_;  ///< of an active unknown in covariance_
  MatrixXd covariance_;
  double sigma_mm_ = kNoise_mm;
  FitPartsResult out_;
};

}  // namespace

std::string job_name(const Job& job) {
  const std::filesystem::path path(job.path);
  if (path.stem() == "job" && path.has_parent_path()) return path.parent_path().filename().string();
  return path.stem().string();
}

Job coarser(Job job) {
  constexpr double kWidest_rad = 4 * kPi / 180;
  job.simulation.voxel_mm *= 2;
  if (job.simulation.envelope_step_mm > 0) job.simulation.envelope_step_mm *= 1.5;
  job.simulation.rotation_step_rad = std::min(4 * job.simulation.rotation_step_rad, kWidest_rad);
  return job;
}

std::vector<std::optional<PredictedSize>> predict_features(const Job& job) {
  Diagnostics found;
  const simulate::Setup setup = simulate::set_up(job, {}, {found, found, found});
  const simulate::Prediction p = simulate::predict_surface(setup.predictor, job, setup.target, setup.program, {}, "");
  std::vector<std::optional<PredictedSize>> out;
  for (const auto& r : inspect::evaluate(job.features, p.surface, job.simulation.voxel_mm))
    out.push_back(r.predicted_mm ? std::optional(PredictedSize{*r.predicted_mm, r.deflection_um / 1000})
                                 : std::nullopt);
  return out;
}

FitPartsResult fit_parts(const std::vector<Job>& jobs, const FitPartsOptions& options) {
  return Fit(jobs, options).run();
}

}  // namespace camber::calib
