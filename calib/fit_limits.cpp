#include "calib/fit_limits.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/units.h"
#include "calib/bounded_least_squares.h"
#include "feedmodel/motion_plan.h"
#include "kinematics/joint_map.h"

namespace camber::calib {
namespace {

using machine::Machine;

constexpr double kTimeNoise = 0.001;     // s; a part's time is known to about a sample, but not better
constexpr double kTimeFraction = 0.002;  // and to this fraction of itself
constexpr double kLogFraction = 0.003;   // a model's error grows with the time; stretches of a log are long
constexpr double kUsualArcNormal = 0.87, kUsualArcTangential = 0.5, kUsualStop = 0.5;
constexpr double kDeterminedError = 0.5;  // of a logarithm
constexpr double kPriorWeight = 0.3;      // of a logarithm: start values count where times tell nothing
constexpr double kTelling = 0.3;          // of what a part's time is known to, by a change by a factor e
constexpr double kNoTime = 1e-9;          // s
constexpr double kShiftSamples = 0.5;
constexpr double kWideLossScale = 300.0;
constexpr double kLossScale = 3.0;  // residuals beyond this many of those count less and less
constexpr double kStep = 1e-3;  // of a logarithm; the plan has small kinks (whole periods): a wide step ignores them
constexpr double kWideStep = 1e-2;  // blocks that overlap last whole periods: their times are steps
constexpr double kFarSearchStep = 0.04, kNearSearchStep = 0.01, kLastSearchStep = 2e-4;  // of a logarithm
constexpr int kMaxSearches = 200;

template <int axis>
LimitParameter acceleration(const char* name) {
  return {.name = name,
          .unit = "mm/s2",
          .get = [](const Machine& m) { return m.axis[axis].acceleration_mm_per_s2; },
          .set = [](Machine& m, double v) { m.axis[axis].acceleration_mm_per_s2 = v; },
          .least = 5,
          .most = 50000,
          .start = 500,
          .fitted = {}};
}

template <int axis>
LimitParameter rotary_acceleration(const char* name) {
  return {.name = name,
          .unit = "deg/s2",
          .get = [](const Machine& m) { return deg_from_rad(m.rotary[axis].acceleration_rad_per_s2); },
          .set = [](Machine& m, double v) { m.rotary[axis].acceleration_rad_per_s2 = rad_from_deg(v); },
          .least = 1,
          .most = 100000,
          .start = 300,
          .fitted = {}};
}

/// Adds the accelerations of the chain's axes.
void add_rotary_accelerations(const Machine& machine, std::vector<LimitParameter>& p) {
  const std::string axes = machine.kinematics.rotary_axes();
  if (axes.find('a') != axes.npos) p.push_back(rotary_acceleration<0>("axis.a.acceleration_deg_per_s2"));
  if (axes.find('b') != axes.npos) p.push_back(rotary_acceleration<1>("axis.b.acceleration_deg_per_s2"));
  if (axes.find('c') != axes.npos) p.push_back(rotary_acceleration<2>("axis.c.acceleration_deg_per_s2"));
}

LimitParameter a_number(const char* name, const char* unit, double (*get)(const Machine&),
                        void (*set)(Machine&, double), double least, double most, double start) {
  return {
      .name = name, .unit = unit, .get = get, .set = set, .least = least, .most = most, .start = start, .fitted = {}};
}

template <int axis>
LimitParameter speed_difference(const char* name) {
  return {.name = name,
          .unit = "mm/min",
          .get = [](const Machine& m) { return 60 * m.axis[axis].speed_difference_mm_per_s; },
          .set = [](Machine& m, double v) { m.axis[axis].speed_difference_mm_per_s = v / 60; },
          .least = 0.5,
          .most = 60000,
          .start = 200,
          .fitted = {}};
}

/// Describes the position gain of an axis as a parameter: logged times determine it by the lag.
template <int axis>
LimitParameter position_gain(const char* name) {
  return {.name = name,
          .unit = "1/s",
          .get = [](const Machine& m) { return m.axis[axis].position_gain_per_s; },
          .set = [](Machine& m, double v) { m.axis[axis].position_gain_per_s = v; },
          .least = 5,
          .most = 2000,
          .start = 40,
          .fitted = {}};
}

/// Whether each axis has a permitted speed difference of its own.
bool differs_by_axis(const Machine& m) {
  return m.control.corner.law == machine::CornerLaw::speed_difference &&
         std::ranges::all_of(m.axis, [](const machine::Axis& a) { return std::isfinite(a.speed_difference_mm_per_s); });
}

/// The number of a corner law. That of the rounding is the program's (G64 P) or the machine file's.
std::optional<LimitParameter> law_parameter(machine::CornerLaw law) {
  switch (law) {
    case machine::CornerLaw::speed_difference:
      return a_number(
          "control.corner.speed_difference_mm_per_min", "mm/min",
          [](const Machine& m) { return 60 * m.control.corner.speed_difference_mm_per_s; },
          [](Machine& m, double v) { m.control.corner.speed_difference_mm_per_s = v / 60; }, 0.5, 60000, 200);
    case machine::CornerLaw::angle:
      return a_number(
          "control.corner.time_ms", "ms", [](const Machine& m) { return 1000 * m.control.corner.time_s; },
          [](Machine& m, double v) { m.control.corner.time_s = v / 1000; }, 0.01, 1000, 5);
    case machine::CornerLaw::radius:
      return a_number(
          "control.corner.acceleration_mm_per_s2", "mm/s2",
          [](const Machine& m) { return m.control.corner.acceleration_mm_per_s2; },
          [](Machine& m, double v) { m.control.corner.acceleration_mm_per_s2 = v; }, 0.1, 100000, 500);
    case machine::CornerLaw::blend:
    case machine::CornerLaw::exact_stop:
      break;
  }
  return std::nullopt;
}

LimitParameter stop_time_parameter() {
  return a_number(
      "control.corner.stop_time_ms", "ms", [](const Machine& m) { return 1000 * m.control.corner.stop_time_s; },
      [](Machine& m, double v) { m.control.corner.stop_time_s = v / 1000; }, 0.1, 2000, 30);
}

LimitParameter bell_time_parameter() {
  return a_number(
      "cycle.bell_time_ms", "ms", [](const Machine& m) { return 1000 * m.cycle.bell_time_s; },
      [](Machine& m, double v) { m.cycle.bell_time_s = v / 1000; }, 1, 500, 40);
}

bool is_acceleration(const LimitParameter& p) { return p.name.find(".acceleration_") != p.name.npos; }

double scale_of(const TimedLines& lines, std::size_t part) {
  const double time_s = lines.time_s[part];
  return lines.logged() ? std::hypot(lines.sigma_s[part], kLogFraction * time_s)
                        : std::max(kTimeNoise, lines.step_s) + kTimeFraction * time_s;
}

/// Residuals of the fitted parts, in units of what a part's time is known to.
void residuals_of(const std::vector<TimedLines>& data, const Machine& machine, bool kept_back,
                  std::vector<double>& residuals) {
  residuals.clear();
  feedmodel::MotionPlan plan;
  const nc::Interpretation* planned_program = nullptr;
  for (const TimedLines& lines : data) {
    if (lines.program != planned_program) plan = feedmodel::plan_motion(*lines.program, machine);
    planned_program = lines.program;
    const std::vector<double> planned = planned_times_s(lines, machine, plan);
    for (std::size_t i = 0; i < planned.size(); ++i) {
      if (lines.time_s[i] <= 0 || (lines.kept_back[i] != 0) != kept_back) continue;
      residuals.push_back((planned[i] - lines.time_s[i]) / scale_of(lines, i));
    }
  }
}

double robust_cost(const std::vector<double>& residuals) {
  double sum = 0;
  for (double r : residuals) sum += kLossScale * kLossScale * std::log1p(r * r / (kLossScale * kLossScale));
  return residuals.empty() ? 0 : sum / static_cast<double>(residuals.size());
}

Machine machine_at(const Machine& base, const std::vector<LimitParameter>& parameters, const double* logs) {
  Machine m = base;
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i].set(m, std::exp(logs[i]));
  return m;
}

class TimeResiduals {
 public:
  TimeResiduals(const std::vector<TimedLines>& data, const Machine& base, const std::vector<LimitParameter>& parameters,
                double loss_scale)
      : data_(data), base_(base), parameters_(parameters), loss_scale_(loss_scale) {}

  bool operator()(const double* const* logs, double* out) const {
    std::vector<double> residuals;
    residuals_of(data_, machine_at(base_, parameters_, logs[0]), false, residuals);
    // The square root of the Cauchy loss, residual by residual.
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const double r = residuals[i];
      out[i] = std::copysign(loss_scale_ * std::sqrt(std::log1p(r * r / (loss_scale_ * loss_scale_))), r);
    }
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      out[residuals.size() + i] = kPriorWeight * (logs[0][i] - std::log(parameters_[i].start));
    return true;
  }

 private:
  const std::vector<TimedLines>& data_;
  const Machine& base_;
  const std::vector<LimitParameter>& parameters_;
  double loss_scale_;
};

std::unique_ptr<ceres::CostFunction> make_cost(const std::vector<TimedLines>& data, const Machine& base,
                                               const std::vector<LimitParameter>& parameters, std::size_t residuals,
                                               double loss_scale) {
  ceres::NumericDiffOptions step;
  step.relative_step_size = blocks_overlap(data, base) ? kWideStep : kStep;
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<TimeResiduals, ceres::FORWARD>>(
      new TimeResiduals(data, base, parameters, loss_scale), ceres::TAKE_OWNERSHIP, step);
  cost->AddParameterBlock(static_cast<int>(parameters.size()));
  cost->SetNumResiduals(static_cast<int>(residuals + parameters.size()));
  return cost;
}

/// Least squares; returns whether it has converged.
bool solve_limits(const std::vector<TimedLines>& data, const Machine& base,
                  const std::vector<LimitParameter>& parameters, double loss_scale, int max_iterations,
                  std::vector<double>& logs) {
  std::vector<double> residuals;
  residuals_of(data, machine_at(base, parameters, logs.data()), false, residuals);
  return least_squares_within_bounds(make_cost(data, base, parameters, residuals.size(), loss_scale), parameters,
                                     {.function_tolerance = 1e-4, .max_iterations = max_iterations}, logs);
}

/// Compass search: the times of blocks that overlap are steps of a period, on which a derivative cannot settle. A
/// parameter that changes nothing either way is left out of the finer steps. Returns whether it came to the finest.
bool search(const std::vector<TimedLines>& data, const Machine& base, const std::vector<LimitParameter>& parameters,
            double first_step, std::vector<double>& logs) {
  std::vector<double> residuals;
  const auto cost = [&](const std::vector<double>& at) {
    residuals_of(data, machine_at(base, parameters, at.data()), false, residuals);
    double prior = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
      prior += std::pow(kPriorWeight * (at[i] - std::log(parameters[i].start)), 2);
    return robust_cost(residuals) + prior / static_cast<double>(std::max<std::size_t>(1, residuals.size()));
  };
  double least = cost(logs);
  std::vector<char> idle(logs.size(), 0);
  for (std::size_t i = 0; i < idle.size(); ++i) idle[i] = parameters[i].from_ramps;
  const auto improve = [&](std::size_t i, double step) {
    bool changes = false;
    for (const double by : {step, -step}) {
      std::vector<double> there = logs;
      there[i] = std::clamp(logs[i] + by, std::log(parameters[i].least), std::log(parameters[i].most));
      const double here = cost(there);
      changes = changes || here != least;
      if (here >= least) continue;
      least = here;
      logs = there;
      return true;
    }
    idle[i] = !changes;
    return false;
  };
  int searches = 0;
  for (double step = first_step; step > kLastSearchStep && searches < kMaxSearches; ++searches) {
    bool improved = false;
    for (std::size_t i = 0; i < logs.size(); ++i) improved |= !idle[i] && improve(i, step);
    if (!improved) step /= 2;
  }
  return searches < kMaxSearches;
}

/// One residual of the fitted parts, in their order: its part, and the scale of its time.
struct Row {
  int group = 0;
  double scale_s = 0, step_s = 0;
  bool logged = false;
};

std::vector<Row> rows_of(const std::vector<TimedLines>& data) {
  std::vector<Row> rows;
  for (const TimedLines& lines : data)
    for (std::size_t i = 0; i < lines.time_s.size(); ++i)
      if (lines.time_s[i] > 0 && !lines.kept_back[i])
        rows.push_back({lines.group[i], scale_of(lines, i), lines.step_s, lines.logged()});
  return rows;
}

/// Standard errors from the Jacobian; parameters that hardly change any time are marked as not determined.
void set_errors(LimitFit& fit, const std::vector<TimedLines>& data, const Machine& base,
                const std::vector<double>& logs, std::size_t count) {
  const auto n = static_cast<int>(fit.parameters.size());
  const auto cost = make_cost(data, base, fit.parameters, count, kLossScale);
  std::vector<double> residuals(count + fit.parameters.size()), jacobian((count + fit.parameters.size()) * n);
  const double* blocks[] = {logs.data()};
  double* jacobians[] = {jacobian.data()};
  cost->Evaluate(blocks, residuals.data(), jacobians);
  const Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> j(
      jacobian.data(), static_cast<Eigen::Index>(count), n);
  const auto rows = rows_of(data);
  std::vector<int> determined;
  for (int i = 0; i < n; ++i) {
    if (fit.parameters[i].from_ramps) {
      fit.parameters[i].determined = true;
      continue;
    }
    // A change by a factor e moves some time by its noise.
    fit.parameters[i].acts = fit.parameters[i].determined = j.col(i).norm() > 1.0;
    double logged = 0;
    for (std::size_t row = 0; row < count; ++row)
      if (rows[row].logged) logged += std::pow(j(static_cast<Eigen::Index>(row), i), 2);
    fit.parameters[i].logged_fraction = logged > 0 ? logged / j.col(i).squaredNorm() : 0;
    fit.parameters[i].fitted = {std::exp(logs[i]), INFINITY};
    std::set<int> groups;
    for (std::size_t row = 0; row < count; ++row)
      if (std::abs(j(static_cast<Eigen::Index>(row), i)) > kTelling) groups.insert(rows[row].group);
    fit.parameters[i].stretches = static_cast<int>(groups.size());
    if (fit.parameters[i].determined) determined.push_back(i);
  }
  if (determined.empty()) return;
  Eigen::MatrixXd normal(determined.size(), determined.size());
  for (std::size_t a = 0; a < determined.size(); ++a)
    for (std::size_t b = 0; b < determined.size(); ++b)
      normal(a, b) = j.col(determined[a]).dot(j.col(determined[b])) + (a == b ? kPriorWeight * kPriorWeight : 0.0);
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(normal);
  if (!lu.isInvertible()) return;
  const Eigen::MatrixXd inverse = lu.inverse();
  std::map<int, Eigen::VectorXd> scores;
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(determined.size()));
  for (std::size_t row = 0; row < count; ++row) {
    Eigen::VectorXd gradient(determined.size());
    for (std::size_t a = 0; a < determined.size(); ++a) gradient(a) = j(static_cast<Eigen::Index>(row), determined[a]);
    auto& score = scores.try_emplace(rows[row].group, Eigen::VectorXd::Zero(gradient.size())).first->second;
    score += gradient * residuals[row];
    if (!rows[row].logged) shift += gradient * (kShiftSamples * rows[row].step_s / rows[row].scale_s);
  }
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(inverse.rows(), inverse.cols());
  for (const auto& [group, score] : scores) middle += score * score.transpose();
  middle.diagonal().array() += kPriorWeight * kPriorWeight;
  shift = inverse * shift;
  const Eigen::MatrixXd covariance = inverse * middle * inverse + shift * shift.transpose();
  for (std::size_t a = 0; a < determined.size(); ++a) {
    LimitParameter& p = fit.parameters[determined[a]];
    const double log_error = std::sqrt(std::max(0.0, covariance(a, a)));
    p.fitted.std_error = p.fitted.value * log_error;
    if (log_error > kDeterminedError) p.determined = false;
  }
  // An axis that moves has a limit, even where its value is hardly known.
  for (int i = 0; i < n; ++i) {
    LimitParameter& p = fit.parameters[i];
    p.poor = !p.determined && is_acceleration(p) && std::isinf(p.get(base)) && j.col(i).norm() > 0;
    // Directions have length one: a lag that all axes share does not show.
    p.determined = (p.determined || p.poor) && !p.name.ends_with("position_gain_per_s");
  }
}

}  // namespace

bool blocks_overlap(const std::vector<TimedLines>& data, const Machine& machine) {
  if (!machine.control.kind.turning_blocks_overlap || machine.control.joint_limits) return false;
  return std::ranges::any_of(
      data, [&](const TimedLines& lines) { return kinematics::has_rotary_motion(*lines.program, machine); });
}

LimitCost cost_of(const std::vector<TimedLines>& data, const Machine& machine) {
  LimitCost cost;
  std::vector<double> residuals;
  residuals_of(data, machine, false, residuals);
  cost.fitted = robust_cost(residuals);
  residuals_of(data, machine, true, residuals);
  cost.held_out = robust_cost(residuals);
  return cost;
}

bool same_times(const std::vector<TimedLines>& data, const Machine& a, const Machine& b) {
  std::vector<double> of_a, of_b;
  for (const bool kept_back : {false, true}) {
    residuals_of(data, a, kept_back, of_a);
    residuals_of(data, b, kept_back, of_b);
    if (of_a != of_b) return false;
  }
  return true;
}

bool any_logged(const std::vector<TimedLines>& data) {
  return std::any_of(data.begin(), data.end(), [](const TimedLines& lines) { return lines.logged(); });
}

bool any_lags(const std::vector<TimedLines>& data) {
  return std::ranges::any_of(data, [](const TimedLines& lines) {
    return std::ranges::any_of(lines.turns, [](const Vec3& turn) { return !turn.isZero(0); });
  });
}

std::vector<LimitParameter> limit_parameters(const Machine& machine, bool logged, bool lags) {
  const auto fraction = [](const char* name, double (*get)(const Machine&), void (*set)(Machine&, double),
                           double value) {
    LimitParameter p{
        .name = name, .unit = "1", .get = get, .set = set, .least = 0.02, .most = 1, .start = value, .fitted = {}};
    p.usual = value;
    return p;
  };
  std::vector<LimitParameter> p;
  p.push_back(acceleration<0>("axis.x.acceleration_mm_per_s2"));
  p.push_back(acceleration<1>("axis.y.acceleration_mm_per_s2"));
  p.push_back(acceleration<2>("axis.z.acceleration_mm_per_s2"));
  add_rotary_accelerations(machine, p);
  p.push_back(fraction(
      "control.arc_normal_share", [](const Machine& m) { return m.control.arc_normal_fraction; },
      [](Machine& m, double v) { m.control.arc_normal_fraction = v; }, kUsualArcNormal));
  p.push_back(fraction(
      "control.arc_tangential_share", [](const Machine& m) { return m.control.arc_tangential_fraction; },
      [](Machine& m, double v) { m.control.arc_tangential_fraction = v; }, kUsualArcTangential));
  if (machine.control.corner.law == machine::CornerLaw::blend) {
    p.push_back(fraction(
        "control.stop_acceleration_share", [](const Machine& m) { return m.control.stop_acceleration_fraction; },
        [](Machine& m, double v) { m.control.stop_acceleration_fraction = v; }, kUsualStop));
    p.push_back({.name = "control.corner.step_share",
                 .unit = "1",
                 .get = [](const Machine& m) { return m.control.corner.step_fraction; },
                 .set = [](Machine& m, double v) { m.control.corner.step_fraction = v; },
                 .least = 1e-3,
                 .most = 0.7,
                 .start = 0.05,
                 .usual = 0.1,
                 .fitted = {}});
  }
  if (differs_by_axis(machine)) {
    p.push_back(speed_difference<0>("axis.x.speed_difference_mm_per_min"));
    p.push_back(speed_difference<1>("axis.y.speed_difference_mm_per_min"));
    p.push_back(speed_difference<2>("axis.z.speed_difference_mm_per_min"));
  } else if (const auto law = law_parameter(machine.control.corner.law)) {
    p.push_back(*law);
  }
  if (std::isfinite(machine.control.corner.stop_angle_rad)) p.push_back(stop_time_parameter());
  if (machine.cycle.acceleration_law == machine::AccelerationLaw::bell) p.push_back(bell_time_parameter());
  if (logged)
    p.push_back(a_number(
        "control.rapid_change_ms", "ms", [](const Machine& m) { return 1000 * m.control.rapid_change_s; },
        [](Machine& m, double v) { m.control.rapid_change_s = v / 1000; }, 0.1, 5000, 30));
  if (lags) {
    p.push_back(position_gain<0>("axis.x.position_gain_per_s"));
    p.push_back(position_gain<1>("axis.y.position_gain_per_s"));
    p.push_back(position_gain<2>("axis.z.position_gain_per_s"));
  }
  p.push_back({.name = "control.block_time_ms",
               .unit = "ms",
               .get = [](const Machine& m) { return 1000 * m.control.block_time_s; },
               .set = [](Machine& m, double v) { m.control.block_time_s = v / 1000; },
               .least = 0.01,
               .most = 50,
               .start = 1000 * machine.control.period_s,
               .fitted = {}});
  return p;
}

namespace {

/// Returns the time of the line's change: the start of a segment, or the middle of its overlap with the one before.
double boundary_s(double before_end_s, const feedmodel::SegmentTime& segment) {
  return segment.overlapped && segment.start_s < before_end_s ? (before_end_s + segment.start_s) / 2 : segment.start_s;
}

bool begins_with_period(double start_s, double period_s) {
  constexpr double kWhole = 1e-6;  // of a period
  const double periods = start_s / period_s;
  return std::abs(periods - std::round(periods)) < kWhole;
}

/// When a part of the segment's length is covered, since its start.
double time_at(const feedmodel::Trapezoid& t, double length_mm) {
  const double accelerated = (t.entry + t.peak) / 2 * t.accelerate_s, cruised = accelerated + t.peak * t.cruise_s;
  const auto ramp_s = [&](double from_speed, double way_mm) {
    if (std::isinf(t.acceleration)) return 0.0;
    return (std::sqrt(from_speed * from_speed + 2 * t.acceleration * std::max(0.0, way_mm)) - from_speed) /
           t.acceleration;
  };
  if (length_mm < accelerated) return ramp_s(t.entry, length_mm);
  if (length_mm < cruised) return t.accelerate_s + (length_mm - accelerated) / t.peak;
  return t.duration_s() - ramp_s(t.exit, t.length - length_mm);
}

}  // namespace

double time_outside_s(const feedmodel::MotionPlan& plan, std::size_t segment, double from_u, double to_u) {
  const auto same = [&](std::size_t i) {
    return i < plan.times.size() && !plan.times[i].rest && plan.times[i].move == plan.times[segment].move;
  };
  std::size_t first = segment, end = segment;
  while (first > 0 && same(first - 1)) --first;
  double whole_mm = 0, before_mm = 0, outside_s = 0;
  for (; same(end); ++end) whole_mm += plan.rows[end].length_mm;
  for (std::size_t i = first; i < end; before_mm += plan.rows[i++].length_mm) {
    const feedmodel::Trapezoid profile = feedmodel::profile_of(plan.rows, i);
    const double planned_s = profile.duration_s();
    const double from_s = time_at(profile, std::clamp(from_u * whole_mm - before_mm, 0.0, profile.length)),
                 to_s = time_at(profile, std::clamp(to_u * whole_mm - before_mm, 0.0, profile.length));
    if (planned_s > 0) outside_s += (1 - (to_s - from_s) / planned_s) * plan.times[i].duration_s;
  }
  return outside_s;
}

std::vector<double> planned_times_s(const TimedLines& data, const Machine& machine, const feedmodel::MotionPlan& plan) {
  assert(data.program != nullptr);
  const std::vector<feedmodel::SegmentTime>& segments = plan.times;
  std::vector<double> times(data.parts.size(), 0.0);
  std::size_t i = 0;
  for (std::size_t p = 0; p < data.parts.size(); ++p) {
    const auto line = [&](std::size_t k) { return data.program->moves[segments[k].move].block + 1; };
    const auto before = [&](std::size_t k) {
      return data.logged() ? segments[k].move < data.moves[p].first : line(k) < data.parts[p].line_first;
    };
    const auto within = [&](std::size_t k) {
      return data.logged() ? segments[k].move < data.moves[p].second : line(k) <= data.parts[p].line_last;
    };
    while (data.logged() && i > 0 && !before(i - 1)) --i;  // a piece may end on the move on which the next one begins
    while (i < segments.size() && (segments[i].rest || before(i))) ++i;
    const std::size_t begin = i;
    std::size_t last = i;
    double first = -1, end = 0;
    const double before_end = i > 0 ? segments[i - 1].start_s + segments[i - 1].duration_s : 0.0;
    for (; i < segments.size() && (segments[i].rest || within(i)); ++i) {
      if (segments[i].rest) continue;
      if (first < 0) first = boundary_s(before_end, segments[i]);
      last = i;
      end = segments[i].start_s + segments[i].duration_s;
    }
    if (first < 0) continue;
    if (i < segments.size()) end = std::min(end, boundary_s(end, segments[i]));
    // A line counts whole periods. Where it begins with one (with every stop, or where it follows a rest) it takes half
    // a period more on average, which a fit can follow better than whole ones.
    const bool stops = i >= segments.size() || segments[i].rest || segments[i].start_s > end + kNoTime;
    const bool counts_more =
        machine.control.starts_on_period ? stops : begins_with_period(first, machine.control.period_s);
    const bool waits = data.logged() && !data.ends_in_motion[p];
    times[p] = end - first + (counts_more ? 0.5 * machine.control.period_s : 0.0) +
               (waits ? machine.control.rapid_change_s : 0.0);
    if (data.fractions.empty()) continue;
    for (int i = 0; i < 3; ++i)
      times[p] +=
          data.turns[p][i] * (1 - machine.axis[i].feed_forward_percent / 100) / machine.axis[i].position_gain_per_s;
    const auto [first_u, last_u] = data.fractions[p];
    if (first_u > 0) times[p] -= time_outside_s(plan, begin, first_u, 1);
    if (last_u < 1) times[p] -= time_outside_s(plan, last, 0, last_u);
  }
  return times;
}

namespace {

/// No part, held out or not, takes less than its blocks, where these are not merged.
double longest_block_time_s(const std::vector<TimedLines>& data) {
  constexpr std::size_t kFewestBlocks = 5;
  constexpr double kTolerance = 1.05;
  double longest = INFINITY;
  for (const TimedLines& lines : data)
    for (std::size_t p = 0; p < lines.parts.size(); ++p) {
      const TracePart& part = lines.parts[p];
      const std::size_t all = lines.logged() ? lines.moves[p].second - lines.moves[p].first
                                             : part.line_last - part.line_first + std::size_t{1},
                        whole = std::max<std::size_t>(all, 2) - 2;
      if (lines.time_s[p] > 0 && whole >= kFewestBlocks)
        longest = std::min(longest, kTolerance * lines.time_s[p] / static_cast<double>(whole));
    }
  return longest;
}

void bound_block_time(const std::vector<TimedLines>& data, const Machine& base, LimitParameter& p) {
  if (p.name != "control.block_time_ms" || base.control.kind.g64_p_merges) return;
  p.most = std::clamp(1000 * longest_block_time_s(data), 2 * p.least, p.most);
  p.start = std::min(p.start, 0.999 * p.most);
}

}  // namespace

double scan_start(const std::vector<TimedLines>& data, const Machine& base, std::vector<LimitParameter>& parameters,
                  std::size_t index, int steps) {
  LimitParameter& p = parameters[index];
  bound_block_time(data, base, p);
  std::vector<double> logs, residuals;
  for (const LimitParameter& q : parameters) logs.push_back(std::log(q.start));
  double least = INFINITY, best = p.start;
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    logs[index] = (1 - u) * std::log(p.least) + u * std::log(p.most);
    residuals_of(data, machine_at(base, parameters, logs.data()), false, residuals);
    const double cost = robust_cost(residuals);
    if (cost > least) continue;  // of equal costs the last: just before the data begins to tell
    least = cost;
    best = std::exp(logs[index]);
  }
  p.start = best;
  return least;
}

namespace {

LimitFit fit_once(const std::vector<TimedLines>& data, const Machine& start, std::vector<LimitParameter> parameters,
                  int max_iterations, bool far_away) {
  LimitFit fit;
  fit.parameters = std::move(parameters);
  std::vector<double> logs;
  for (const LimitParameter& p : fit.parameters) logs.push_back(std::log(p.start));
  std::vector<double> residuals;
  residuals_of(data, machine_at(start, fit.parameters, logs.data()), false, residuals);
  fit.machine = fit.whole = start;
  if (residuals.empty()) {
    // What was read in the ramps of the commands stands by itself.
    for (LimitParameter& p : fit.parameters) {
      p.determined = p.from_ramps;
      if (p.determined) p.set(fit.machine, p.fitted.value);
    }
    fit.whole = fit.machine;
    fit.converged = true;
    return fit;
  }

  const bool overlap = blocks_overlap(data, start);
  // A wide loss first: from far away every part looks like one that no plan explains.
  if (far_away && !overlap) solve_limits(data, start, fit.parameters, kWideLossScale, max_iterations, logs);
  if (!overlap) fit.converged = solve_limits(data, start, fit.parameters, kLossScale, max_iterations, logs);
  if (overlap) fit.converged = search(data, start, fit.parameters, far_away ? kFarSearchStep : kNearSearchStep, logs);
  set_errors(fit, data, start, logs, residuals.size());

  const Machine fitted = fit.whole = machine_at(start, fit.parameters, logs.data());
  for (const LimitParameter& p : fit.parameters)
    if (p.determined) p.set(fit.machine, p.fitted.value);
  std::vector<double> milliseconds;
  for (const TimedLines& lines : data) {
    const auto planned = planned_times_s(lines, fitted, feedmodel::plan_motion(*lines.program, fitted));
    for (std::size_t i = 0; i < planned.size(); ++i)
      if (lines.time_s[i] > 0 && !lines.kept_back[i])
        milliseconds.push_back(1000 * std::abs(planned[i] - lines.time_s[i]));
  }
  const auto middle = milliseconds.begin() + static_cast<std::ptrdiff_t>(milliseconds.size() / 2);
  std::nth_element(milliseconds.begin(), middle, milliseconds.end());
  fit.residual_median_ms = *middle;
  const LimitCost cost = cost_of(data, fitted);
  fit.fitted_cost = cost.fitted;
  fit.held_out_cost = cost.held_out;
  return fit;
}

/// The times tell a value by less than this fraction of it.
bool is_ambiguous(const LimitParameter& p) {
  constexpr double kLogError = 0.3;
  return std::isinf(p.fitted.std_error) ? p.acts : p.fitted.std_error > kLogError * p.fitted.value;
}

/// A block time that logged times do without as well is only the longest that they allow, and others make up for it.
LimitFit without_idle_block_time(LimitFit fit, const std::vector<TimedLines>& data, const Machine& start,
                                 int max_iterations) {
  constexpr double kWorth = 0.02, kShortBlockS = 0.02;
  if (!any_logged(data)) return fit;
  std::vector<LimitParameter> others = fit.parameters;
  for (LimitParameter& p : others) p.start = std::clamp(p.fitted.value, p.least * 1.001, p.most * 0.999);
  LimitParameter block_time = others.back();
  others.pop_back();
  LimitFit without = fit_once(data, start, std::move(others), max_iterations, false);
  const bool short_blocks = longest_block_time_s(data) < kShortBlockS;
  if (short_blocks && without.fitted_cost > (1 + kWorth) * fit.fitted_cost) return fit;
  block_time.determined = block_time.acts = false;
  block_time.fitted.std_error = INFINITY;
  without.parameters.push_back(std::move(block_time));
  return without;
}

}  // namespace

LimitFit fit_limits(const std::vector<TimedLines>& data, const Machine& start, std::vector<LimitParameter> parameters,
                    int max_iterations, bool far_away) {
  for (LimitParameter& p : parameters) {
    p.assumed = false;
    bound_block_time(data, start, p);
  }
  LimitFit fit = fit_once(data, start, parameters, max_iterations, far_away);
  const auto ambiguous = [](const LimitParameter& p) { return !p.from_ramps && is_ambiguous(p); };
  const auto is_share = [&](const LimitParameter& p) { return p.name.ends_with("_share") && ambiguous(p); };
  const bool together =
      std::ranges::any_of(fit.parameters, [&](const auto& p) { return is_acceleration(p) && ambiguous(p); }) &&
      std::ranges::any_of(fit.parameters, is_share);
  if (!together) return without_idle_block_time(std::move(fit), data, start, max_iterations);
  // The times tell accelerations and shares of them only together: the shares keep their usual values.
  Machine base = start;
  std::vector<LimitParameter> free, assumed;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    LimitParameter& p = parameters[i];
    if (!is_share(fit.parameters[i])) {
      free.push_back(p);
      continue;
    }
    p.start = p.usual;
    p.set(base, p.usual);
    p.fitted = {p.usual, INFINITY};
    p.assumed = p.acts = true;
  }
  fit = without_idle_block_time(fit_once(data, base, std::move(free), max_iterations, far_away), data, base,
                                max_iterations);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].assumed)
      fit.parameters.insert(fit.parameters.begin() + static_cast<std::ptrdiff_t>(i), parameters[i]);
  return fit;
}

}  // namespace camber::calib
