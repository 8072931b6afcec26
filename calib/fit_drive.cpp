#include "calib/fit_drive.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/cancel.h"
#include "feedmodel/axis_filter.h"
#include "feedmodel/position_loop.h"

namespace camber::calib {
namespace {

using feedmodel::AxisFilter;
using feedmodel::PositionLoop;
using feedmodel::PositionLoopOptions;

constexpr double kEnoughMm = 0.001;    // a residual under this needs no filter to explain it
constexpr double kNearlyAsGood = 2.0;  // times the least held-out error
constexpr std::size_t kMaxResiduals = 60000;

enum class Part { fitted, held_out };

struct Model {
  int parameters = 1;  ///< gain; gain and lag; gain, lag and feed-forward
  double filter_s = 0;
};

PositionLoopOptions loop_options(const Model& model, const double* p, double period_s) {
  PositionLoopOptions o;
  o.gain_per_s = std::exp(p[0]);
  o.velocity_lag_s = model.parameters > 1 ? std::exp(p[1]) : 0.0;
  o.feed_forward_percent = model.parameters > 2 ? 100.0 * p[2] : 0.0;
  o.period_s = period_s;
  return o;
}

/// Runs the model over all traces; `use(error_mm, sample, slice)` for each sample that moves or follows.
template <class Use>
void run(const std::vector<const ServoTrace*>& traces, int axis, const Model& model, const PositionLoopOptions& base,
         const DriveFitOptions& options, const Use& use) {
  for (const ServoTrace* trace : traces) {
    PositionLoopOptions loop_of_trace = base;
    loop_of_trace.period_s = trace->period_s;
    const auto window = static_cast<std::size_t>(std::lround(model.filter_s / trace->period_s));
    for (const Stretch& stretch : trace->stretches) {
      const double start = trace->command_mm[stretch.first][axis];
      AxisFilter filter(window, start);
      PositionLoop loop(loop_of_trace, start);
      const std::size_t end = std::min(stretch.end, options.max_samples);
      for (std::size_t k = stretch.first; k < end; ++k) {
        const double position = loop(filter(trace->command_mm[k][axis]));
        const auto slice = static_cast<long>((trace->t_s[k] - trace->t_s.front()) / options.slice_s);
        use(position - trace->actual_mm[k][axis], slice);
      }
    }
  }
}

Part part_of(long slice) { return slice % 3 == 2 ? Part::held_out : Part::fitted; }

class DriveResiduals {
 public:
  DriveResiduals(const std::vector<const ServoTrace*>& traces, int axis, Model model, const DriveFitOptions& options,
                 std::size_t every)
      : traces_(traces), axis_(axis), model_(model), options_(options), every_(every) {}

  bool operator()(const double* const* parameters, double* residuals) const {
    cancellation_point();
    std::size_t seen = 0, n = 0;
    run(traces_, axis_, model_, loop_options(model_, parameters[0], 0.001), options_, [&](double error, long slice) {
      if (part_of(slice) == Part::fitted && seen++ % every_ == 0) residuals[n++] = 1000.0 * error;
    });
    return true;
  }

 private:
  const std::vector<const ServoTrace*>& traces_;
  int axis_;
  Model model_;
  DriveFitOptions options_;
  std::size_t every_;
};

std::size_t fitted_samples(const std::vector<const ServoTrace*>& traces, int axis, const Model& model,
                           const DriveFitOptions& options) {
  std::size_t n = 0;
  const double p[3] = {3.0, -6.0, 0.0};
  run(traces, axis, model, loop_options(model, p, 0.001), options,
      [&](double, long slice) { n += part_of(slice) == Part::fitted; });
  return n;
}

struct Candidate {
  Model model;
  double p[3] = {3.4, -6.2, 0.0};  ///< log gain, log lag, feed-forward
  double error[3] = {INFINITY, INFINITY, INFINITY};
  double fitted_rms_mm = 0, held_out_rms_mm = 0;
  bool converged = false;
};

void set_errors(Candidate& c, ceres::Problem& problem) {
  std::vector<double> residuals;
  ceres::CRSMatrix crs;
  problem.Evaluate({}, nullptr, &residuals, nullptr, &crs);
  const int n = c.model.parameters;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  for (int row = 0; row < crs.num_rows; ++row)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) normal(i, j) += crs.values[crs.rows[row] + i] * crs.values[crs.rows[row] + j];
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(normal);
  if (!lu.isInvertible()) return;
  double sum = 0;
  for (double r : residuals) sum += r * r;
  const double variance = sum / std::max(1.0, static_cast<double>(residuals.size()) - n);
  const Eigen::MatrixXd covariance = lu.inverse() * variance;
  for (int i = 0; i < n; ++i) c.error[i] = std::sqrt(std::max(0.0, covariance(i, i)));
}

void solve(Candidate& c, const std::vector<const ServoTrace*>& traces, int axis, const DriveFitOptions& options) {
  const std::size_t samples = fitted_samples(traces, axis, c.model, options);
  const std::size_t every = samples / kMaxResiduals + 1;
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<DriveResiduals, ceres::CENTRAL>>(
      new DriveResiduals(traces, axis, c.model, options, every));
  cost->AddParameterBlock(c.model.parameters);
  cost->SetNumResiduals(static_cast<int>((samples + every - 1) / every));
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, c.p);
  if (c.model.parameters > 1) {
    problem.SetParameterLowerBound(c.p, 1, std::log(1e-4));
    problem.SetParameterUpperBound(c.p, 1, std::log(0.1));
  }
  problem.SetParameterLowerBound(c.p, 0, std::log(0.5));
  problem.SetParameterUpperBound(c.p, 0, std::log(2000.0));
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = 40;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  c.converged = summary.termination_type == ceres::CONVERGENCE;
  set_errors(c, problem);

  double sum[2] = {0, 0};
  std::size_t n[2] = {0, 0};
  run(traces, axis, c.model, loop_options(c.model, c.p, 0.001), options, [&](double error, long slice) {
    const int fraction = static_cast<int>(part_of(slice));
    sum[fraction] += error * error;
    ++n[fraction];
  });
  c.fitted_rms_mm = n[0] ? std::sqrt(sum[0] / static_cast<double>(n[0])) : 0;
  c.held_out_rms_mm = n[1] ? std::sqrt(sum[1] / static_cast<double>(n[1])) : c.fitted_rms_mm;
}

bool moves(const ServoTrace& trace, int axis, double range_mm) {
  if (!trace.has_command[axis] || !trace.has_actual[axis]) return false;
  const auto less = [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
  const auto [low, high] = std::minmax_element(trace.command_mm.begin(), trace.command_mm.end(), less);
  return (*high)[axis] - (*low)[axis] > range_mm;
}

/// Another model that explains the trace nearly as well and finds other values says that these are no better known.
void add_ambiguity(Candidate& best, const std::vector<Candidate>& tried) {
  double spread[3] = {0, 0, 0};
  for (const Candidate& c : tried) {
    if (!c.converged || c.held_out_rms_mm > kNearlyAsGood * best.held_out_rms_mm) continue;
    for (int i = 0; i < std::min(c.model.parameters, best.model.parameters); ++i)
      spread[i] = std::max(spread[i], std::abs(c.p[i] - best.p[i]));
  }
  for (int i = 0; i < best.model.parameters; ++i) best.error[i] = std::hypot(best.error[i], spread[i]);
}

DriveFit result_of(const Candidate& c) {
  DriveFit fit;
  fit.moved = true;
  fit.converged = c.converged;
  fit.gain_per_s = {std::exp(c.p[0]), std::exp(c.p[0]) * c.error[0]};
  if (c.model.parameters > 1) fit.velocity_lag_s = {std::exp(c.p[1]), std::exp(c.p[1]) * c.error[1]};
  if (c.model.parameters > 2) fit.feed_forward_percent = {100 * c.p[2], 100 * c.error[2]};
  fit.filter_s = {c.model.filter_s, 0};
  fit.fitted_rms_mm = c.fitted_rms_mm;
  fit.held_out_rms_mm = c.held_out_rms_mm;
  const char* const names[] = {"position loop", "position loop and velocity lag",
                               "position loop, velocity lag and feed-forward"};
  fit.model = names[c.model.parameters - 1];
  if (c.model.filter_s > 0) fit.model += " after a moving average";
  return fit;
}

}  // namespace

DriveFit fit_drive(const std::vector<const ServoTrace*>& all, int axis, const DriveFitOptions& options) {
  std::vector<const ServoTrace*> traces;
  for (const ServoTrace* trace : all)
    if (moves(*trace, axis, options.moved_mm)) traces.push_back(trace);
  if (traces.empty()) return {};

  std::vector<Candidate> all_tried;
  Candidate best;
  best.held_out_rms_mm = INFINITY;
  const auto try_model = [&](int parameters, double filter_s, bool like_last) {
    Candidate c;
    c.model = {parameters, filter_s};
    if (like_last && all_tried.back().converged) std::copy(all_tried.back().p, all_tried.back().p + 3, c.p);
    solve(c, traces, axis, options);
    all_tried.push_back(c);
    const bool better = c.held_out_rms_mm < (1.0 - options.better_by) * best.held_out_rms_mm - options.better_by_mm;
    if (better) best = c;
    return better;
  };
  // From the last model of the same filter: another filter's gain and lag make up for what that filter is not.
  const auto try_models = [&](double filter_s) {
    bool better = false;
    for (int parameters = 1; parameters <= 3; ++parameters) better |= try_model(parameters, filter_s, parameters > 1);
    return better;
  };
  try_models(0);
  bool better = false;  // the last one was the best: the next may be better still
  for (double filter_s = 0.002; filter_s <= 0.13 && (better || best.held_out_rms_mm > kEnoughMm); filter_s *= 2)
    better = try_models(filter_s);
  // Between the values of the list, to a period.
  const double period_s = traces.front()->period_s;
  for (double step_s = best.model.filter_s / 4; best.model.filter_s > 0 && step_s > 0.5 * period_s; step_s /= 2) {
    const Model from = best.model;
    if (!try_model(from.parameters, from.filter_s + step_s, true))
      try_model(from.parameters, from.filter_s - step_s, true);
  }
  add_ambiguity(best, all_tried);
  return result_of(best);
}

double drive_rms_mm(const std::vector<const ServoTrace*>& all, int axis, const machine::Axis& model) {
  std::vector<const ServoTrace*> traces;
  for (const ServoTrace* trace : all)
    if (moves(*trace, axis, 0)) traces.push_back(trace);
  double sum = 0;
  std::size_t n = 0;
  const PositionLoopOptions loop{model.position_gain_per_s, model.velocity_lag_s, model.feed_forward_percent, 0.001};
  DriveFitOptions whole;
  whole.max_samples = SIZE_MAX;
  run(traces, axis, {1, model.filter_s}, loop, whole, [&](double error, long) {
    sum += error * error;
    ++n;
  });
  return n ? std::sqrt(sum / static_cast<double>(n)) : 0;
}

}  // namespace camber::calib
