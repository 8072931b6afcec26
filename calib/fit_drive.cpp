#include "calib/fit_drive.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "base/cancel.h"
#include "feedmodel/drive.h"

namespace camber::calib {
namespace {

using feedmodel::Drive;
using feedmodel::DriveOptions;

constexpr double kEnoughMm = 0.001;    // a residual under this needs no filter to explain it
constexpr double kNearlyAsGood = 1.5;  // times the least held-out error
constexpr double kAlmostAsGood = 1.1;
constexpr double kRestS = 0.3;    // a command that stood for longer: the axis rests
constexpr double kWarmUpS = 0.5;  // of a slice that begins in motion
constexpr double kMaxDeadTimeS = 0.04;
constexpr double kDeterminedFraction = 0.3;
constexpr double kSamplingFraction = 0.05;  // of the sample distance: what an input between samples may differ by
constexpr double kMaxJitter = 0.1;          // of the sample distance
constexpr double kPositionScale = 1000;     // residuals in um, or thousandths of a degree
constexpr std::size_t kFewestSamples = 50;
constexpr double kPieceS = 0.5;  // errors further apart than this have nothing in common
constexpr double kTriedFeedForward = 0.5;
constexpr double kTraceStepMm = 1e-4;  // what traces are rounded to

/// The numbers of a drive, in the order in which models take them up.
enum Number { log_gain, log_lag, feed_forward, acceleration, dead_time, backlash, kNumbers };
using Numbers = std::array<double, kNumbers>;
using Free = std::array<bool, kNumbers>;

struct NumberBounds {
  double least, most;
};
const std::array<NumberBounds, kNumbers> kBounds{{{std::log(0.5), std::log(2000.0)},
                                                  {std::log(1e-4), std::log(0.1)},
                                                  {0, 1.2},
                                                  {0, 0.1},
                                                  {0, kMaxDeadTimeS},
                                                  {0, 0.5}}};

/// A stretch of motion of the axis, at even times.
struct Slice {
  double period_s = 0;
  bool held_out = false;
  std::size_t warm_up = 0;  // samples that are not judged
  std::vector<double> command, actual;
  std::size_t steps = 1;     // of the drive from sample to sample
  std::vector<double> fine;  // so many commands for each sample, the last of them its own

  double step_s() const { return period_s / static_cast<double>(steps); }
};

/// The command between samples on a cubic through four of them: a log that leaves samples out shows the ramps of a
/// finer interpolation so, where straight lines would cut them off.
void fill_between(Slice& slice, std::size_t steps) {
  const std::vector<double>& c = slice.command;
  slice.steps = steps;
  slice.fine.assign(steps, c.front());
  for (std::size_t k = 1; k < c.size(); ++k) {
    const double from = c[k - 1], to = c[k], before = k > 1 ? c[k - 2] : 2 * from - to,
                 after = k + 1 < c.size() ? c[k + 1] : 2 * to - from;
    for (std::size_t i = 1; i <= steps; ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(steps), v = 1 - u;
      slice.fine.push_back(v * from + u * to -
                           u * v * (v * (before - 2 * from + to) + u * (from - 2 * to + after)) / 2);
    }
  }
}

struct Model {
  Free free{true};
  double filter_s = 0;
  double lead_s = 0;  // of the feed forward before the equation
  Numbers fixed{};    // those that are not free

  int count() const { return static_cast<int>(std::count(free.begin(), free.end(), true)); }
};

DriveOptions options_of(const Model& model, const Numbers& p, double period_s) {
  return {.filter_s = model.filter_s,
          .gain_per_s = std::exp(p[log_gain]),
          .velocity_lag_s = model.free[log_lag] ? std::exp(p[log_lag]) : 0.0,
          .feed_forward_percent = 100 * p[feed_forward],
          .acceleration_feed_forward_s = p[acceleration] + model.lead_s * p[feed_forward],
          .dead_time_s = p[dead_time],
          .backlash = p[backlash],
          .period_s = period_s};
}

/// `use(sample, position)` for each sample of a slice, by the model. The load begins where it is seen: the motor may
/// rest anywhere in the play.
template <class Use>
void follow(const Slice& slice, const Model& model, const Numbers& p, const Use& use) {
  DriveOptions options = options_of(model, p, slice.step_s());
  feedmodel::Backlash load(std::exchange(options.backlash, 0.0), slice.actual.front());
  Drive drive(options, slice.command.front());
  for (std::size_t i = 0; i < slice.fine.size(); ++i) {
    const double position = load(drive(slice.fine[i]));
    if ((i + 1) % slice.steps == 0) use(i / slice.steps, position);
  }
}

/// `use(error)` for each sample of a slice that is judged.
template <class Use>
void run(const Slice& slice, const Model& model, const Numbers& p, const Use& use) {
  follow(slice, model, p, [&](std::size_t k, double position) {
    if (k >= slice.warm_up) use(position - slice.actual[k]);
  });
}

// --- slices ---------------------------------------------------------------------------------------------------

/// Positions of one axis at even times.
struct EvenSamples {
  double period_s = 0;
  std::vector<double> command, actual;
};

EvenSamples even_samples(const ServoTrace& trace, const Stretch& stretch, int axis) {
  EvenSamples out{trace.period_s, {}, {}};
  bool even = true;
  for (std::size_t k = stretch.first + 1; k < stretch.end && even; ++k)
    even = std::abs(trace.t_s[k] - trace.t_s[k - 1] - trace.period_s) < kMaxJitter * trace.period_s;
  if (even) {
    for (std::size_t k = stretch.first; k < stretch.end; ++k) {
      out.command.push_back(trace.command_mm[k][axis]);
      out.actual.push_back(trace.actual_mm[k][axis]);
    }
    return out;
  }
  std::size_t k = stretch.first;
  for (double t = trace.t_s[k]; k + 1 < stretch.end; t += trace.period_s) {
    while (k + 1 < stretch.end && trace.t_s[k + 1] < t) ++k;
    if (k + 1 >= stretch.end) break;
    const double u = (t - trace.t_s[k]) / (trace.t_s[k + 1] - trace.t_s[k]);
    out.command.push_back((1 - u) * trace.command_mm[k][axis] + u * trace.command_mm[k + 1][axis]);
    out.actual.push_back((1 - u) * trace.actual_mm[k][axis] + u * trace.actual_mm[k + 1][axis]);
  }
  return out;
}

std::size_t samples_in(double s, double period_s) {
  return static_cast<std::size_t>(std::max(1L, std::lround(s / period_s)));
}

/// Number of samples after which a model that began at rest, with the first of `n` commands, is where the axis is. Zero
/// where the axis is seen to rest before it moves; the axis may be on its way where a trace begins or has a hole.
template <class Command>
std::size_t unknown_start(const Command& command, std::size_t n, double period_s) {
  std::size_t moved = 1;
  while (moved < n && command(moved) == command(0)) ++moved;
  return moved < n && moved <= samples_in(kRestS, period_s) ? samples_in(kWarmUpS, period_s) : 0;
}

void add_slices(const EvenSamples& samples, double slice_s, std::vector<Slice>& out) {
  const auto count = [&](double s) { return samples_in(s, samples.period_s); };
  const std::size_t rest = count(kRestS), warm_up = count(kWarmUpS), length = count(slice_s),
                    n = samples.command.size(),
                    unknown = unknown_start([&](std::size_t k) { return samples.command[k]; }, n, samples.period_s);
  const auto add = [&](std::size_t from, std::size_t first, std::size_t end) {
    Slice s;
    s.period_s = samples.period_s;
    s.warm_up = first - from;
    const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
    s.command.assign(samples.command.begin() + at(from), samples.command.begin() + at(end));
    s.actual.assign(samples.actual.begin() + at(from), samples.actual.begin() + at(end));
    s.fine = s.command;
    out.push_back(std::move(s));
  };
  std::size_t moves_from = 0;
  for (std::size_t k = 0; k < n;) {
    // From the sample before the first step of the command to where it has stood for long enough.
    while (k + 1 < n && samples.command[k + 1] == samples.command[k]) ++k;
    if (k + 1 >= n) break;
    moves_from = k;
    std::size_t still = 0;
    while (++k < n && still < rest) still = samples.command[k] == samples.command[k - 1] ? still + 1 : 0;
    for (std::size_t first = std::max(moves_from, unknown); first < k; first += length)
      add(first - std::min(warm_up, first - moves_from), first, std::min(first + length, k));
  }
}

/// Slices of the motion, no more samples than max_samples, every third held out.
std::vector<Slice> slices_of(const std::vector<const ServoTrace*>& traces, int axis, const DriveFitOptions& options) {
  std::vector<Slice> all;
  for (const ServoTrace* trace : traces)
    for (const Stretch& stretch : trace->stretches)
      if (stretch.end > stretch.first + 2) add_slices(even_samples(*trace, stretch, axis), options.slice_s, all);
  std::size_t samples = 0;
  for (const Slice& s : all) samples += s.command.size();
  const std::size_t every = samples / options.max_samples + 1;
  std::vector<Slice> slices;
  for (std::size_t i = 0; i < all.size(); i += every) slices.push_back(std::move(all[i]));
  for (std::size_t i = 2; i < slices.size(); i += 3) slices[i].held_out = true;
  return slices;
}

bool moves(const ServoTrace& trace, int axis, double range_mm) {
  if (!trace.has_command[axis] || !trace.has_actual[axis]) return false;
  const auto less = [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
  const auto [low, high] = std::minmax_element(trace.command_mm.begin(), trace.command_mm.end(), less);
  return (*high)[axis] - (*low)[axis] > range_mm;
}

// --- start values: the equation of the drive is linear in its numbers -----------------------------------------

/// Three first-order lags.
std::vector<double> low_pass(const std::vector<double>& in, double time_constant_s, double period_s) {
  const double a = std::exp(-period_s / time_constant_s);
  std::array<double, 3> state;
  state.fill(in.front());
  std::vector<double> out;
  for (double v : in) {
    for (double& s : state) v = s = a * s + (1 - a) * v;
    out.push_back(v);
  }
  return out;
}

/// x' = Kp (c - x) + F c' + Ka c'' - Tv x'', in its normal equations.
struct Equation {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double square = 0;
};

Equation equation_of(const std::vector<Slice>& slices, double filter_s, std::size_t delay) {
  Equation e;
  for (const Slice& s : slices) {
    if (s.held_out || s.command.size() < delay + 4) continue;
    const double t = s.period_s, lag_s = std::max(4 * t, 0.004);
    feedmodel::AxisFilter average(static_cast<std::size_t>(std::lround(filter_s / t)), s.command.front());
    std::vector<double> command;
    for (double c : s.command) command.push_back(average(c));
    const std::vector<double> c = low_pass(command, lag_s, t), x = low_pass(s.actual, lag_s, t);
    for (std::size_t k = std::max<std::size_t>(delay + 1, s.warm_up); k + 1 < x.size(); ++k) {
      const std::size_t d = k - delay;
      const Eigen::Vector4d row(c[d] - x[k], (c[d + 1] - c[d - 1]) / (2 * t),
                                (c[d + 1] - 2 * c[d] + c[d - 1]) / (t * t),
                                -(x[k + 1] - 2 * x[k] + x[k - 1]) / (t * t));
      const double speed = (x[k + 1] - x[k - 1]) / (2 * t);
      e.normal += row * row.transpose();
      e.right += row * speed;
      e.square += speed * speed;
    }
  }
  return e;
}

/// The numbers that a model leaves free; the squares that remain.
double solve_equation(const Equation& e, const Model& model, Numbers& p) {
  constexpr std::array kColumns{log_gain, feed_forward, acceleration, log_lag};
  std::vector<int> used;
  for (int i = 0; i < 4; ++i)
    if (model.free[kColumns[static_cast<std::size_t>(i)]]) used.push_back(i);
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    b[i] = e.right[used[i]];
    for (Eigen::Index j = 0; j < n; ++j) a(i, j) = e.normal(used[i], used[j]);
  }
  const Eigen::VectorXd scale = a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd v =
      scale.asDiagonal() * (scale.asDiagonal() * a * scale.asDiagonal()).fullPivLu().solve(scale.asDiagonal() * b);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Number number = kColumns[static_cast<std::size_t>(used[i])];
    const auto [least, most] = kBounds[number];
    const bool is_log = number == log_gain || number == log_lag;
    const double value = is_log ? std::log(std::max(v[i], 1e-6)) : v[i];
    const double margin = is_log ? 0.1 : 0.01 * (most - least);
    p[number] = std::clamp(value, least + margin, most - margin);
  }
  return e.square - v.dot(b);
}

Numbers linear_start(const std::vector<Slice>& slices, const Model& model) {
  Numbers best{3.4, -6.2, 0, 0, 0, 0};
  double least = INFINITY;
  const double period_s = slices.front().period_s;
  const auto delays =
      model.free[dead_time] ? static_cast<std::size_t>(std::min(40.0, kMaxDeadTimeS / period_s)) : std::size_t{0};
  const std::size_t step = delays / 20 + 1;
  for (std::size_t delay = 0; delay <= delays; delay += step) {
    Numbers p = best;
    const double left = solve_equation(equation_of(slices, model.filter_s, delay), model, p);
    if (left >= least) continue;
    least = left;
    best = p;
    best[dead_time] = std::clamp(static_cast<double>(delay) * period_s, 0.0, 0.99 * kMaxDeadTimeS);
  }
  return best;
}

// --- least squares over the positions -------------------------------------------------------------------------

class DriveResiduals {
 public:
  DriveResiduals(const std::vector<Slice>& slices, const Model& model) : slices_(slices), model_(model) {}

  bool operator()(const double* const* parameters, double* residuals) const {
    cancellation_point();
    const Numbers p = with_free(parameters[0]);
    for (const Slice& s : slices_)
      if (!s.held_out) run(s, model_, p, [&](double error) { *residuals++ = kPositionScale * error; });
    return true;
  }

  Numbers with_free(const double* free) const {
    Numbers p = model_.fixed;
    for (std::size_t i = 0; i < kNumbers; ++i)
      if (model_.free[i]) p[i] = *free++;
    return p;
  }

 private:
  const std::vector<Slice>& slices_;
  Model model_;
};

struct Candidate {
  Model model;
  Numbers p{}, error{};
  double fitted_rms = 0, held_out_rms = INFINITY;
  bool converged = false;
};

std::size_t judged_samples(const std::vector<Slice>& slices, bool held_out) {
  std::size_t n = 0;
  for (const Slice& s : slices)
    if (s.held_out == held_out) n += s.command.size() - s.warm_up;
  return n;
}

/// Returns the model's speed of the axis at every fitted sample, in the unit of the residuals per second.
std::vector<double> modelled_speeds(const Candidate& c, const std::vector<Slice>& slices) {
  std::vector<double> speeds;
  for (const Slice& s : slices) {
    if (s.held_out) continue;
    double before = s.command.front();
    follow(s, c.model, c.p, [&](std::size_t k, double position) {
      if (k >= s.warm_up) speeds.push_back(kPositionScale * (position - before) / s.period_s);
      before = position;
    });
  }
  return speeds;
}

/// Sandwich over pieces of the slices, with the correction for few of them, and what a shift by a fraction of the
/// sample distance would do: to a number alone, and to all of them together, where some make up for each other.
void set_errors(Candidate& c, const std::vector<Slice>& slices, const std::vector<double>& residuals,
                const ceres::CRSMatrix& jacobian) {
  const int n = c.model.count();
  const double shift_s = kSamplingFraction * slices.front().period_s, gain = std::exp(c.p[log_gain]);
  const std::vector<double> speeds = modelled_speeds(c, slices);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n), middle = normal;
  Eigen::VectorXd shifted = Eigen::VectorXd::Zero(n);
  int row = 0, pieces = 0;
  for (const Slice& s : slices) {
    if (s.held_out) continue;
    const int end = row + static_cast<int>(s.command.size() - s.warm_up);
    const int piece = static_cast<int>(samples_in(kPieceS, s.period_s));
    while (row < end) {
      Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
      for (const int stop = std::min(end, row + piece); row < stop; ++row) {
        const Eigen::Map<const Eigen::VectorXd> j(&jacobian.values[static_cast<std::size_t>(jacobian.rows[row])], n);
        normal += j * j.transpose();
        score += j * residuals[static_cast<std::size_t>(row)];
        shifted += j * (shift_s * speeds[static_cast<std::size_t>(row)]);
      }
      middle += score * score.transpose();
      ++pieces;
    }
  }
  middle *= static_cast<double>(pieces) / std::max(1, pieces - n);
  c.error.fill(INFINITY);
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(scale.asDiagonal() * normal * scale.asDiagonal());
  if (!lu.isInvertible()) return;
  const Eigen::MatrixXd inverse = scale.asDiagonal() * lu.inverse() * scale.asDiagonal();
  const Eigen::MatrixXd covariance = inverse * middle * inverse;
  const Eigen::VectorXd together = inverse * shifted;
  const Numbers alone{shift_s * gain, shift_s / std::exp(c.p[log_lag]), shift_s * gain, shift_s, shift_s, 0};
  int k = 0;
  for (std::size_t i = 0; i < kNumbers; ++i)
    if (c.model.free[i]) {
      c.error[i] = std::hypot(std::sqrt(std::max(0.0, covariance(k, k))), std::max(alone[i], std::abs(together[k])));
      ++k;
    }
}

void judge(Candidate& c, const std::vector<Slice>& slices) {
  double sum[2] = {0, 0};
  std::size_t n[2] = {0, 0};
  for (const Slice& s : slices)
    run(s, c.model, c.p, [&](double error) {
      sum[s.held_out] += error * error;
      ++n[s.held_out];
    });
  c.fitted_rms = n[0] ? std::sqrt(sum[0] / static_cast<double>(n[0])) : 0;
  c.held_out_rms = n[1] ? std::sqrt(sum[1] / static_cast<double>(n[1])) : c.fitted_rms;
}

Candidate solve(const std::vector<Slice>& slices, const Model& model, const Numbers& start) {
  Candidate c{.model = model, .p = start};
  auto* functor = new DriveResiduals(slices, model);
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<DriveResiduals, ceres::FORWARD>>(functor);
  cost->AddParameterBlock(model.count());
  cost->SetNumResiduals(static_cast<int>(judged_samples(slices, false)));
  std::vector<double> free;
  std::vector<NumberBounds> bounds;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    if (!model.free[i]) continue;
    free.push_back(std::clamp(start[i], kBounds[i].least, kBounds[i].most));
    bounds.push_back(kBounds[i]);
  }
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, free.data());
  for (int i = 0; i < model.count(); ++i) {
    problem.SetParameterLowerBound(free.data(), i, bounds[static_cast<std::size_t>(i)].least);
    problem.SetParameterUpperBound(free.data(), i, bounds[static_cast<std::size_t>(i)].most);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = 40;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  c.converged = summary.termination_type == ceres::CONVERGENCE;
  c.p = functor->with_free(free.data());
  std::vector<double> residuals;
  ceres::CRSMatrix jacobian;
  problem.Evaluate({}, nullptr, &residuals, nullptr, &jacobian);
  set_errors(c, slices, residuals, jacobian);
  judge(c, slices);
  return c;
}

/// Solves from a linear fit and from the simpler model before; returns the better end.
Candidate solve_from_both(const std::vector<Slice>& slices, const Model& model, const Candidate& before) {
  Candidate best = solve(slices, model, linear_start(slices, model));
  if (!std::isfinite(before.held_out_rms)) return best;
  Numbers p = before.p;
  if (model.free[log_lag] && !before.model.free[log_lag]) p[log_lag] = std::log(0.003);
  const Candidate other = solve(slices, model, p);
  return other.fitted_rms < best.fitted_rms ? other : best;
}

// --- choice ---------------------------------------------------------------------------------------------------

/// The unit in which an error of a number counts as a fraction of it.
double size_of(const Candidate& c, std::size_t i) { return i == log_gain || i == log_lag ? 1.0 : std::abs(c.p[i]); }

/// Another model that explains the trace nearly as well and finds other values, by errors no larger than a fraction of
/// them, says that these are no better known.
void add_ambiguity(Candidate& best, const std::vector<Candidate>& tried) {
  Numbers spread{};
  for (const Candidate& c : tried) {
    if (!c.converged || c.held_out_rms > kNearlyAsGood * best.held_out_rms) continue;
    bool determined = true;
    for (std::size_t i = 0; i < kNumbers; ++i)
      if (c.model.free[i]) determined = determined && c.error[i] < kDeterminedFraction * size_of(c, i);
    if (!determined) continue;
    for (std::size_t i = 0; i < kNumbers; ++i)
      if (c.model.free[i] && best.model.free[i]) spread[i] = std::max(spread[i], std::abs(c.p[i] - best.p[i]));
  }
  for (std::size_t i = 0; i < kNumbers; ++i) best.error[i] = std::hypot(best.error[i], spread[i]);
}

std::string name_of(const Model& model) {
  static constexpr std::array<std::pair<Number, const char*>, 5> kNames{{{log_lag, "velocity lag"},
                                                                         {feed_forward, "feed-forward"},
                                                                         {acceleration, "acceleration feed-forward"},
                                                                         {dead_time, "dead time"},
                                                                         {backlash, "backlash"}}};
  std::vector<std::string> parts{"position loop"};
  for (const auto& [number, name] : kNames)
    if (model.free[number]) parts.emplace_back(name);
  std::string text = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) text += (i + 1 < parts.size() ? ", " : " and ") + parts[i];
  if (model.filter_s > 0) text += " after a moving average";
  return text;
}

/// With half of the speed fed forward and the other numbers fitted again the trace is explained as well: it shows how
/// far the axis is behind, gain / (1 - feed forward), and neither of both.
bool hides_feed_forward(const std::vector<Slice>& slices, const Candidate& best) {
  if (best.model.free[feed_forward]) return false;
  Model model = best.model;
  model.fixed[feed_forward] = kTriedFeedForward;
  Numbers start = best.p;
  start[log_gain] += std::log(1 - kTriedFeedForward);
  return solve(slices, model, start).held_out_rms < kNearlyAsGood * best.held_out_rms + kTraceStepMm;
}

DriveFit result_of(const Candidate& c) {
  DriveFit fit;
  fit.moved = true;
  fit.converged = c.converged;
  const double gain = std::exp(c.p[log_gain]), lag_s = std::exp(c.p[log_lag]);
  fit.gain_per_s = {gain, gain * c.error[log_gain]};
  if (c.model.free[log_lag]) fit.velocity_lag_s = {lag_s, lag_s * c.error[log_lag]};
  if (c.model.free[feed_forward]) fit.feed_forward_percent = {100 * c.p[feed_forward], 100 * c.error[feed_forward]};
  if (c.model.free[acceleration]) fit.acceleration_feed_forward_s = {c.p[acceleration], c.error[acceleration]};
  if (c.model.lead_s > 0)
    fit.acceleration_feed_forward_s = {c.model.lead_s * c.p[feed_forward], c.model.lead_s * c.error[feed_forward]};
  if (c.model.free[dead_time]) fit.dead_time_s = {c.p[dead_time], c.error[dead_time]};
  if (c.model.free[backlash]) fit.backlash = {c.p[backlash], c.error[backlash]};
  fit.filter_s = {c.model.filter_s, 0};
  fit.fitted_rms_mm = c.fitted_rms;
  fit.held_out_rms_mm = c.held_out_rms;
  fit.model = name_of(c.model);
  return fit;
}

/// An error that is no chance, seen from another.
double clearly_below(double rms, const DriveFitOptions& options) {
  return (1.0 - options.better_by) * rms - options.better_by_mm;
}

/// The model with fewer numbers stands unless the other's error is clearly lower, of two with as many the first.
bool stands_against(const Candidate& first, const Candidate& second, const DriveFitOptions& options) {
  if (first.model.count() > second.model.count())
    return first.held_out_rms < clearly_below(second.held_out_rms, options);
  return second.held_out_rms > clearly_below(first.held_out_rms, options);
}

class DriveSearch {
 public:
  DriveSearch(std::vector<Slice> slices, const DriveFitOptions& options)
      : slices_(std::move(slices)), options_(options) {}

  Candidate best() {
    search_models(0, true, true);
    consider_backlash();
    bool better = false;  // the last one was the best: the next may be better still
    for (double filter_s = 0.002; filter_s <= 0.13 && (better || best_.held_out_rms > kEnoughMm); filter_s *= 2)
      better = search_models(filter_s, true, false);
    // Between the values of the list, to a period.
    const double period_s = slices_.front().step_s();
    for (double step_s = best_.model.filter_s / 4; best_.model.filter_s > 0 && step_s > 0.5 * period_s; step_s /= 2) {
      const Model from = best_.model;
      if (!consider({from.free, from.filter_s + step_s, from.lead_s}, best_))
        consider({from.free, from.filter_s - step_s, from.lead_s}, best_);
    }
    if (best_.model.filter_s > 0) search_models(best_.model.filter_s, false, true);
    consider_backlash();
    add_ambiguity(best_, tried_);
    return best_;
  }

 private:
  /// The models of one filter, each from the one before it: another filter's gain and lag make up for what that filter
  /// is not. Those with more numbers only while something is left to explain. `plain`: without feed forward of the
  /// acceleration, `accelerated`: with it.
  bool search_models(double filter_s, bool plain, bool accelerated) {
    //                            gain  lag    ff    acceleration  dead time
    constexpr Free kModels[] = {{true, false, false, false, false}, {true, true, false, false, false},
                                {true, false, true, false, false},  {true, false, false, false, true},
                                {true, true, true, false, false},   {true, true, false, false, true},
                                {true, false, true, false, true},   {true, true, true, false, true},
                                {true, true, true, true, false},    {true, true, true, true, true}};
    bool better = false;
    Candidate before = plain ? Candidate() : best_;
    const auto look_at = [&](const Model& model) {
      better |= consider(model, before);
      if (tried_.back().fitted_rms < before.fitted_rms || !std::isfinite(before.held_out_rms)) before = tried_.back();
    };
    for (const Free& free : kModels) {
      if (best_.held_out_rms < 2 * options_.better_by_mm) break;
      if (free[acceleration] ? accelerated : plain) look_at({free, filter_s});
      if (accelerated && free[feed_forward] && !free[acceleration]) look_at({free, filter_s, options_.period_s / 2});
    }
    return better;
  }

  /// Behind the best model, and behind those with no more numbers that come near to it: what a backlash hides may be
  /// what tells them apart.
  void consider_backlash() {
    if (best_.model.free[backlash] || best_.held_out_rms < 2 * options_.better_by_mm) return;
    std::vector<Candidate> near{best_};
    for (const Candidate& c : tried_)
      if (c.model.count() <= best_.model.count() && c.model.filter_s == best_.model.filter_s &&
          c.model.free != best_.model.free && c.held_out_rms < kAlmostAsGood * best_.held_out_rms)
        near.push_back(c);
    for (const Candidate& c : near) {
      Model model = c.model;
      model.free[backlash] = true;
      consider(model, c);
    }
  }

  bool consider(const Model& model, const Candidate& before) {
    tried_.push_back(solve_from_both(slices_, model, before));
    const Candidate& c = tried_.back();
    // With as many numbers the better one is taken, with more of them only one that is clearly better.
    const bool richer = model.count() > best_.model.count();
    const double limit = richer ? clearly_below(best_.held_out_rms, options_) : best_.held_out_rms;
    const bool better = !std::isfinite(best_.held_out_rms) || c.held_out_rms < limit;
    if (better) best_ = c;
    return better;
  }

  std::vector<Slice> slices_;
  DriveFitOptions options_;
  std::vector<Candidate> tried_;
  Candidate best_;
};

}  // namespace

bool is_determined(const FittedValue& value) {
  return std::isfinite(value.std_error) && value.std_error <= kDeterminedFraction * std::abs(value.value);
}

DriveFit fit_drive(const std::vector<const ServoTrace*>& all, int axis, const DriveFitOptions& options) {
  std::vector<const ServoTrace*> traces;
  for (const ServoTrace* trace : all)
    if (moves(*trace, axis, options.moved_mm)) traces.push_back(trace);
  std::vector<Slice> slices = slices_of(traces, axis, options);
  if (judged_samples(slices, false) < kFewestSamples) return {};
  Candidate best = DriveSearch(slices, options).best();
  if (const std::size_t steps = samples_in(slices.front().period_s, options.period_s); steps > 1) {
    std::vector<Slice> finer = slices;
    for (Slice& s : finer) fill_between(s, steps);
    Candidate other = DriveSearch(finer, options).best();
    if (stands_against(other, best, options)) std::swap(best, other), slices = std::move(finer);
    add_ambiguity(best, {other});
  }
  DriveFit fit = result_of(best);
  if (hides_feed_forward(slices, best)) fit.feed_forward_percent = {0, INFINITY};
  return fit;
}

double drive_rms_mm(const std::vector<const ServoTrace*>& all, int axis, const machine::Axis& model) {
  double sum = 0;
  std::size_t n = 0;
  for (const ServoTrace* trace : all) {
    if (!moves(*trace, axis, 0)) continue;
    for (const Stretch& stretch : trace->stretches) {
      Drive drive(feedmodel::drive_options(model, model.filter_s, trace->period_s),
                  trace->command_mm[stretch.first][axis]);
      const std::size_t unknown =
          unknown_start([&](std::size_t k) { return trace->command_mm[stretch.first + k][axis]; },
                        stretch.end - stretch.first, trace->period_s);
      for (std::size_t k = stretch.first; k < stretch.end; ++k) {
        const double error = drive(trace->command_mm[k][axis]) - trace->actual_mm[k][axis];
        if (k - stretch.first < unknown) continue;
        sum += error * error;
        ++n;
      }
    }
  }
  return n ? std::sqrt(sum / static_cast<double>(n)) : 0;
}

}  // namespace camber::calib
