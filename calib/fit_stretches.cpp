#include "calib/fit_stretches.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "calib/bounded_least_squares.h"
#include "calib/fit_limits.h"
#include "feedmodel/fitted_range.h"
#include "feedmodel/motion_plan.h"

namespace camber::calib {
namespace {

using machine::CornerLaw;
using machine::Machine;

constexpr double kTimeFraction = 0.003;             // a model's error grows with the time
constexpr double kLossScale = 3.0;                  // residuals beyond count less and less
constexpr double kWideLossScale = 100.0;            // first, from far away
constexpr double kGapRad = 5.0 * kPi / 180.0;       // a gap worth telling
constexpr double kWideGapRad = 12.0 * kPi / 180.0;  // and one in which a control's stop angle may well lie
constexpr double kBluntRad = 120.0 * kPi / 180.0;   // sharper corners are stops for every law
constexpr double kBetterBy = 0.05;                  // share by which a richer law must lower the held-out error
constexpr double kThresholdRad = 5.0 * kPi / 180.0;
constexpr double kKindFraction = 0.1;  // of the length, that makes a stretch one of helices, or of arcs
constexpr double kFacetMm = 1.0;
constexpr double kSlightCorner = 0.5 * kPi / 180.0;
constexpr std::size_t kFewestTools = 3;
constexpr int kGeometryFolds = 5;
constexpr double kFewestBlocks = 20;         // in a stretch that may tell the block time
constexpr double kSlowed = 1.3;              // such a stretch takes this much longer than programmed
constexpr double kFractionOfBlocks = 0.9;    // of its time a block, at which the fit of the block time begins
constexpr double kDeterminedFraction = 0.5;  // a value whose error is a larger fraction of it is not told

/// The stretches that are fitted, from all programs, one after the other with a rest between.
struct Data {
  struct Item {
    JudgedStretch judged;
    std::size_t program = 0, move_first = 0, move_end = 0;  ///< of the shortened program
    int fold = 0;
  };
  std::vector<nc::Interpretation> programs;
  std::vector<Item> items;
  int folds = 0;
};

void set_folds(Data& data) {
  std::map<std::pair<std::size_t, int>, int> tools;
  for (const auto& item : data.items)
    tools.try_emplace({item.program, item.judged.timed.stretch.tool}, static_cast<int>(tools.size()));
  const bool by_tool = tools.size() >= kFewestTools;
  for (std::size_t i = 0; i < data.items.size(); ++i) {
    auto& item = data.items[i];
    item.fold = by_tool ? tools[{item.program, item.judged.timed.stretch.tool}] : static_cast<int>(i) % kGeometryFolds;
  }
  data.folds = by_tool ? static_cast<int>(tools.size()) : std::min(kGeometryFolds, static_cast<int>(data.items.size()));
}

Data shortened(const std::vector<StretchRun>& runs) {
  Data data;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    StretchProgram program(runs[r].program, false);
    for (const TimedStretch& t : one_for_each_geometry(runs[r].timed, runs[r].program)) {
      Data::Item item;
      item.judged.timed = t;
      item.judged.program_name = runs[r].program_name;
      item.judged.constant_feed_s = programmed_time_s(t, runs[r].program);
      item.program = r;
      item.judged.kind = kind_of(t.stretch, runs[r].program);
      std::tie(item.move_first, item.move_end) = program.add(t);
      data.items.push_back(item);
    }
    data.programs.push_back(program.take());
  }
  set_folds(data);
  return data;
}

/// Commanded time of an item: its segments, the waits at stops within it, half a period for each start, and the wait
/// before the rapid that follows a whole stretch. Summed by hand, not read off the clock, whose whole periods a fit
/// would stumble on. `at`: a segment before it.
double time_s(const Data::Item& item, const Machine& machine, const feedmodel::MotionPlan& plan, std::size_t& at) {
  const auto& all = plan.times;
  const FeedStretch& stretch = item.judged.timed.stretch;
  double time_s = stretch.ends_in_motion() ? 0 : machine.control.rapid_change_s;
  while (at > 0 && all[at - 1].move >= item.move_first) --at;
  while (at < all.size() && all[at].move < item.move_first) ++at;
  std::optional<std::size_t> first;
  std::size_t last = at;
  for (; at < all.size() && all[at].move < item.move_end; ++at) {
    const bool waited = at > 0 && all[at].start_s > all[at - 1].start_s + all[at - 1].duration_s + 1e-9 &&
                        all[at].move > item.move_first;
    time_s += all[at].duration_s + (waited ? 0.5 * machine.control.period_s : 0.0);
    if (all[at].rest) continue;
    if (!first) first = at;
    last = at;
  }
  if (first && stretch.first_u > 0) time_s -= time_outside_s(plan, *first, stretch.first_u, 1);
  if (first && stretch.last_u < 1) time_s -= time_outside_s(plan, last, 0, stretch.last_u);
  return time_s;
}

std::vector<double> times_s(const Data& data, const Machine& machine) {
  std::vector<double> times;
  std::size_t item = 0;
  for (std::size_t p = 0; p < data.programs.size(); ++p) {
    const feedmodel::MotionPlan plan = feedmodel::plan_motion(data.programs[p], machine);
    for (std::size_t at = 0; item < data.items.size() && data.items[item].program == p; ++item)
      times.push_back(time_s(data.items[item], machine, plan, at));
  }
  return times;
}

LimitParameter positive(const char* name, const char* unit, double (*get)(const Machine&),
                        void (*set)(Machine&, double), double least, double most, double start) {
  return {
      .name = name, .unit = unit, .get = get, .set = set, .least = least, .most = most, .start = start, .fitted = {}};
}

std::vector<LimitParameter> parameters_of(const StretchLaw& law) {
  std::vector<LimitParameter> p;
  if (law.axis_acceleration) {
    p.push_back(positive(
        "axis.x.acceleration_mm_per_s2", "mm/s2", [](const Machine& m) { return m.axis[0].acceleration_mm_per_s2; },
        [](Machine& m, double v) { m.axis[0].acceleration_mm_per_s2 = m.axis[1].acceleration_mm_per_s2 = v; }, 20,
        50000, 500));
    p.push_back(positive(
        "axis.z.acceleration_mm_per_s2", "mm/s2", [](const Machine& m) { return m.axis[2].acceleration_mm_per_s2; },
        [](Machine& m, double v) { m.axis[2].acceleration_mm_per_s2 = v; }, 20, 50000, 500));
  } else {
    p.push_back(positive(
        "control.path_acceleration_mm_per_s2", "mm/s2",
        [](const Machine& m) { return m.control.path_acceleration_mm_per_s2; },
        [](Machine& m, double v) { m.control.path_acceleration_mm_per_s2 = v; }, 20, 50000, 500));
  }
  p.push_back(positive(
      "control.arc_normal_share", "1", [](const Machine& m) { return m.control.arc_normal_fraction; },
      [](Machine& m, double v) { m.control.arc_normal_fraction = v; }, 0.02, 50, 1.3));
  if (law.corner == CornerLaw::angle)
    p.push_back(positive(
        "control.corner.time_ms", "ms", [](const Machine& m) { return 1000 * m.control.corner.time_s; },
        [](Machine& m, double v) { m.control.corner.time_s = v / 1000; }, 0.01, 1000, 8));
  else if (law.corner == CornerLaw::radius)
    p.push_back(positive(
        "control.corner.acceleration_mm_per_s2", "mm/s2",
        [](const Machine& m) { return m.control.corner.acceleration_mm_per_s2; },
        [](Machine& m, double v) { m.control.corner.acceleration_mm_per_s2 = v; }, 0.1, 100000, 500));
  else
    p.push_back(positive(
        "control.corner.speed_difference_mm_per_min", "mm/min",
        [](const Machine& m) { return 60 * m.control.corner.speed_difference_mm_per_s; },
        [](Machine& m, double v) { m.control.corner.speed_difference_mm_per_s = v / 60; }, 1, 60000, 200));
  if (std::isfinite(law.stop_angle_rad))
    p.push_back(positive(
        "control.corner.stop_time_ms", "ms", [](const Machine& m) { return 1000 * m.control.corner.stop_time_s; },
        [](Machine& m, double v) { m.control.corner.stop_time_s = v / 1000; }, 0.1, 2000, 30));
  if (law.block_time_s > 0)
    p.push_back(positive(
        "control.block_time_ms", "ms", [](const Machine& m) { return 1000 * m.control.block_time_s; },
        [](Machine& m, double v) { m.control.block_time_s = v / 1000; }, 0.1, 500, 1000 * law.block_time_s));
  p.push_back(positive(
      "control.rapid_change_ms", "ms", [](const Machine& m) { return 1000 * m.control.rapid_change_s; },
      [](Machine& m, double v) { m.control.rapid_change_s = v / 1000; }, 0.1, 5000, 100));
  return p;
}

Machine base_of(const Machine& start, const StretchLaw& law) {
  Machine m = start;
  m.control.corner.law = law.corner;
  m.control.corner.stop_angle_rad = law.stop_angle_rad;
  m.control.corner.threshold_rad = law.threshold_rad;
  m.control.in_position_mm = machine::kNoLimit;  // waits are between the stretches
  m.control.path_acceleration_mm_per_s2 = machine::kNoLimit;
  if (!law.axis_acceleration)
    for (machine::Axis& axis : m.axis) axis.acceleration_mm_per_s2 = machine::kNoLimit;
  return m;
}

Machine machine_at(const Machine& base, const std::vector<LimitParameter>& parameters, const double* logs) {
  Machine m = base;
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i].set(m, std::exp(logs[i]));
  return m;
}

class StretchResiduals {
 public:
  StretchResiduals(const Data& data, const Machine& base, const std::vector<LimitParameter>& parameters, int left_out,
                   double loss_scale)
      : data_(data), base_(base), parameters_(parameters), left_out_(left_out), loss_scale_(loss_scale) {}

  bool operator()(const double* const* logs, double* out) const {
    const auto times = times_s(data_, machine_at(base_, parameters_, logs[0]));
    for (std::size_t i = 0; i < times.size(); ++i) {
      const TimedStretch& t = data_.items[i].judged.timed;
      const double r = data_.items[i].fold == left_out_
                           ? 0.0
                           : (times[i] - t.time_s) / std::hypot(t.sigma_s, kTimeFraction * t.time_s);
      out[i] = std::copysign(loss_scale_ * std::sqrt(std::log1p(r * r / (loss_scale_ * loss_scale_))), r);
    }
    return true;
  }

 private:
  const Data& data_;
  const Machine& base_;
  const std::vector<LimitParameter>& parameters_;
  int left_out_;
  double loss_scale_;
};

struct Solution {
  std::vector<double> logs;
  bool converged = false;
};

Solution solve(const Data& data, const Machine& base, const std::vector<LimitParameter>& parameters, int left_out,
               std::vector<double> logs, double loss_scale, int max_iterations) {
  ceres::NumericDiffOptions step;
  step.relative_step_size = 1e-3;
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<StretchResiduals, ceres::FORWARD>>(
      new StretchResiduals(data, base, parameters, left_out, loss_scale), ceres::TAKE_OWNERSHIP, step);
  cost->AddParameterBlock(static_cast<int>(parameters.size()));
  cost->SetNumResiduals(static_cast<int>(data.items.size()));
  const bool converged = least_squares_within_bounds(
      std::move(cost), parameters, {.function_tolerance = 1e-6, .max_iterations = max_iterations}, logs);
  return {std::move(logs), converged};
}

double known_to_s(const TimedStretch& t) { return std::hypot(t.sigma_s, kTimeFraction * t.time_s); }

double mean_score(const Data& data, const std::vector<double>& predicted_s) {
  double sum = 0;
  for (std::size_t i = 0; i < predicted_s.size(); ++i) {
    const TimedStretch& t = data.items[i].judged.timed;
    sum += std::abs(predicted_s[i] - t.time_s) / known_to_s(t);
  }
  return sum / static_cast<double>(predicted_s.size());
}

std::vector<double> measured_s(const Data& data) {
  std::vector<double> times;
  for (const auto& item : data.items) times.push_back(item.judged.timed.time_s);
  return times;
}

/// A corner law, fitted to all stretches and to all but each fold.
struct Trial {
  StretchLaw law;
  Machine machine;
  std::vector<LimitParameter> parameters;
  Solution whole;
  std::vector<Solution> folds;
  std::vector<double> fitted_s, held_out_s, kind_held_out_s;
};

/// The same stretches, a fold for each kind of motion.
Data folded_by_kind(Data data) {
  std::map<MotionKind, int> kinds;
  for (const auto& item : data.items) kinds.try_emplace(item.judged.kind, static_cast<int>(kinds.size()));
  for (auto& item : data.items) item.fold = kinds[item.judged.kind];
  data.folds = static_cast<int>(kinds.size());
  return data;
}

/// Fits again without each fold, from the whole fit.
void hold_out(Trial& trial, const Data& data, const Machine& start, int max_iterations) {
  const Machine base = base_of(start, trial.law);
  trial.folds.clear();
  trial.held_out_s = trial.fitted_s;
  for (int fold = 0; fold < data.folds; ++fold) {
    trial.folds.push_back(solve(data, base, trial.parameters, fold, trial.whole.logs, kLossScale, max_iterations));
    const auto times = times_s(data, machine_at(base, trial.parameters, trial.folds.back().logs.data()));
    for (std::size_t i = 0; i < times.size(); ++i)
      if (data.items[i].fold == fold) trial.held_out_s[i] = times[i];
  }
}

/// Least time a block of all stretches: none of a control's blocks can take less than its block time. 0 where that
/// stretch goes about as fast as it was programmed, so that its blocks were not too many.
double likely_block_time_s(const Data& data) {
  double least = INFINITY;
  bool slowed = false;
  for (const auto& item : data.items) {
    const auto blocks = static_cast<double>(item.move_end - item.move_first);
    const double block_s = item.judged.timed.time_s / blocks;
    if (blocks < kFewestBlocks || block_s >= least) continue;
    least = block_s;
    slowed = item.judged.timed.time_s > kSlowed * item.judged.constant_feed_s;
  }
  return slowed ? kFractionOfBlocks * least : 0;
}

/// Each law without a stop angle, with a block time as well: what many short blocks cost no other number may take up.
void add_block_time(std::vector<StretchLaw>& laws, double block_time_s) {
  for (std::size_t i = 0, n = laws.size(); i < n && block_time_s > 0; ++i) {
    if (std::isfinite(laws[i].stop_angle_rad)) continue;
    StretchLaw law = laws[i];
    law.block_time_s = block_time_s;
    law.name += ", block time";
    laws.push_back(law);
  }
}

Trial try_law(const Data& data, const Machine& start, const StretchLaw& law, int max_iterations) {
  Trial trial;
  trial.law = law;
  trial.parameters = parameters_of(law);
  const Machine base = base_of(start, law);
  std::vector<double> logs;
  for (const LimitParameter& p : trial.parameters) logs.push_back(std::log(p.start));
  const Solution rough = solve(data, base, trial.parameters, -1, logs, kWideLossScale, max_iterations);
  trial.whole = solve(data, base, trial.parameters, -1, rough.logs, kLossScale, max_iterations);
  trial.machine = machine_at(base, trial.parameters, trial.whole.logs.data());
  trial.fitted_s = times_s(data, trial.machine);
  Trial by_kind = trial;
  hold_out(by_kind, folded_by_kind(data), start, max_iterations);
  trial.kind_held_out_s = by_kind.held_out_s;
  hold_out(trial, data, start, max_iterations);
  return trial;
}

/// Delete-a-group jackknife: s^2 = (k - 1) / k sum (p_i - mean p)^2 over the k folds, in the logarithm. It needs no
/// independent residuals within a fold.
double jackknife_error(const Trial& trial, std::size_t parameter) {
  const auto k = static_cast<double>(trial.folds.size());
  if (k < 2) return INFINITY;
  double mean = 0, sum = 0;
  for (const Solution& s : trial.folds) mean += s.logs[parameter] / k;
  for (const Solution& s : trial.folds) sum += (s.logs[parameter] - mean) * (s.logs[parameter] - mean);
  return std::sqrt((k - 1) / k * sum);
}

/// Whether a change of the parameter by a factor e moves any time by what it is known to.
bool tells(const Data& data, const Trial& trial, std::size_t parameter) {
  Machine moved = trial.machine;
  trial.parameters[parameter].set(moved, std::exp(trial.whole.logs[parameter] - 1));
  const std::vector<double> times = times_s(data, moved);
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::abs(times[i] - trial.fitted_s[i]) > known_to_s(data.items[i].judged.timed)) return true;
  return false;
}

/// A number that no stretch tells is left as the machine file has it; that of the corner law, which the file may not
/// have, as the fit began with it.
FitParameter left_as_it_was(StretchFit& fit, const LimitParameter& p, const Machine& start) {
  const bool of_law = p.name.starts_with("control.corner.");
  if (!of_law) p.set(fit.machine, p.get(start));
  return {p.name,
          p.get(fit.machine),
          p.unit,
          std::nullopt,
          fmt::format("not determined by the stretches; {} (run what camber protocol writes)",
                      of_law ? "a usual value" : "start value kept"),
          of_law};
}

void add_parameters(StretchFit& fit, const Data& data, const Trial& trial, const Machine& start) {
  for (std::size_t i = 0; i < trial.parameters.size(); ++i) {
    if (!tells(data, trial, i)) {
      fit.parameters.push_back(left_as_it_was(fit, trial.parameters[i], start));
      continue;
    }
    const double value = std::exp(trial.whole.logs[i]), error = jackknife_error(trial, i);
    FitParameter p{trial.parameters[i].name, value, trial.parameters[i].unit, std::nullopt, "", true};
    if (error < kDeterminedFraction)
      p.std_error = value * error;
    else
      p.note = "poorly determined by the stretches (run what camber protocol writes)";
    fit.parameters.push_back(p);
  }
  if (std::isfinite(trial.law.stop_angle_rad)) {
    FitParameter p{
        "control.corner.stop_angle_degrees", trial.law.stop_angle_rad * 180 / kPi, "deg", std::nullopt, "", true};
    for (const auto& gap : fit.unseen_corners_rad)
      if (gap[0] <= trial.law.stop_angle_rad && trial.law.stop_angle_rad <= gap[1])
        p.note = fmt::format("anywhere between {:.1f} and {:.1f}: the programs have no corner in between",
                             gap[0] * 180 / kPi, gap[1] * 180 / kPi);
    fit.parameters.push_back(p);
  }
}

std::vector<std::array<double, 2>> corner_gaps(const std::vector<StretchRun>& runs) {
  std::vector<double> angles{0.0};
  for (const StretchRun& run : runs) {
    for (const TimedStretch& t : one_for_each_geometry(run.timed, run.program)) {
      for (std::size_t i = t.stretch.move_first + 1; i < t.stretch.move_end; ++i) {
        const Vec3 from = direction_at(run.program, run.program.moves[i - 1], 1.0),
                   to = direction_at(run.program, run.program.moves[i], 0.0);
        angles.push_back(std::acos(std::clamp(from.dot(to), -1.0, 1.0)));
      }
    }
  }
  std::sort(angles.begin(), angles.end());
  std::vector<std::array<double, 2>> gaps;
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (angles[i] - angles[i - 1] > kGapRad) gaps.push_back({angles[i - 1], angles[i]});
  if (angles.back() < kPi - kGapRad) gaps.push_back({angles.back(), kPi});
  return gaps;
}

Machine stops_at_every_block(Machine m) {
  m.control.corner.law = CornerLaw::exact_stop;
  m.control.corner.stop_time_s = 0;
  return m;
}

}  // namespace

std::string_view name_of(MotionKind kind) {
  constexpr std::string_view kNames[] = {"helices", "facets", "arcs", "lines"};
  return kNames[static_cast<std::size_t>(kind)];
}

MotionKind kind_of(const FeedStretch& stretch, const nc::Interpretation& program) {
  double helices = 0, arcs = 0, all = 0;
  std::vector<double> lines;
  for (std::size_t i = stretch.move_first; i < stretch.move_end; ++i) {
    const nc::Move& move = program.moves[i];
    const double length = length_mm(program, move);
    all += length;
    if (move.kind == nc::MoveKind::linear) lines.push_back(length);
    if (move.kind != nc::MoveKind::arc) continue;
    const bool rises = std::abs(program.arcs[move.arc].normal.dot(move.end_mm - move.start_mm)) > 1e-6;
    (rises ? helices : arcs) += length;
  }
  if (helices > kKindFraction * all) return MotionKind::helices;
  const auto middle = lines.begin() + static_cast<std::ptrdiff_t>(lines.size() / 2);
  std::nth_element(lines.begin(), middle, lines.end());
  if (!lines.empty() && *middle < kFacetMm) return MotionKind::facets;
  return arcs > kKindFraction * all ? MotionKind::arcs : MotionKind::lines;
}

StretchErrors stretch_errors(const std::vector<double>& time_s, const std::vector<double>& predicted_s) {
  StretchErrors e;
  std::vector<double> errors;
  double sum = 0, predicted = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    errors.push_back(100 * std::abs(predicted_s[i] / time_s[i] - 1));
    sum += time_s[i];
    predicted += predicted_s[i];
  }
  if (errors.empty()) return e;
  std::sort(errors.begin(), errors.end());
  for (double x : errors) e.mean += x / static_cast<double>(errors.size());
  e.p90 = errors[static_cast<std::size_t>(std::ceil(0.9 * static_cast<double>(errors.size()))) - 1];
  e.worst = errors.back();
  e.total = 100 * (predicted / sum - 1);
  return e;
}

std::vector<StretchLaw> candidate_laws(const std::vector<StretchRun>& runs) {
  std::vector<StretchLaw> laws;
  std::vector<double> stops{machine::kNoLimit};
  for (const auto& gap : corner_gaps(runs))
    if (gap[0] > kSlightCorner && gap[1] < kBluntRad && gap[1] - gap[0] > kWideGapRad)
      stops.push_back(0.5 * (gap[0] + gap[1]));
  for (const auto& [corner, name] : {std::pair(CornerLaw::angle, "speed change along the path"),
                                     {CornerLaw::speed_difference, "speed difference by axis"},
                                     {CornerLaw::radius, "radius of three points"}}) {
    for (double stop : stops)
      laws.push_back({.name = std::isfinite(stop) ? fmt::format("{}, stop above {:.0f} deg", name, stop * 180 / kPi)
                                                  : std::string(name),
                      .corner = corner,
                      .stop_angle_rad = stop});
  }
  return laws;
}

StretchFit fit_stretches(const std::vector<StretchRun>& runs, const Machine& start,
                         const FitStretchesOptions& options) {
  StretchFit fit;
  fit.machine = start;
  const Data data = shortened(runs);
  fit.folds = data.folds;
  fit.unseen_corners_rad = corner_gaps(runs);
  std::vector<StretchLaw> laws = options.laws.empty() ? candidate_laws(runs) : options.laws;
  if (options.laws.empty()) add_block_time(laws, likely_block_time_s(data));
  if (data.items.size() <= parameters_of(laws.front()).size()) {
    fit.message = fmt::format("{} geometries are too few for {} numbers; nothing was fitted", data.items.size(),
                              parameters_of(laws.front()).size());
    return fit;
  }
  const std::vector<double> measured = measured_s(data);
  std::optional<Trial> best;
  const auto consider = [&](const StretchLaw& law) {
    Trial trial = try_law(data, start, law, options.max_iterations);
    fit.laws.push_back({law, stretch_errors(measured, trial.fitted_s), stretch_errors(measured, trial.held_out_s),
                        stretch_errors(measured, trial.kind_held_out_s),
                        mean_score(data, trial.held_out_s) + mean_score(data, trial.kind_held_out_s)});
    const bool richer = best && (law.axis_acceleration || law.threshold_rad > 0 || law.block_time_s > 0 ||
                                 (std::isfinite(law.stop_angle_rad) && std::isinf(best->law.stop_angle_rad)));
    const double better_by = richer ? kBetterBy : 0.0;
    if (best && fit.laws.back().score >= (1 - better_by) * fit.laws[fit.chosen].score) return;
    fit.chosen = fit.laws.size() - 1;
    best = std::move(trial);
  };
  for (const StretchLaw& law : laws) consider(law);
  if (options.laws.empty()) {
    StretchLaw with_threshold = best->law;
    with_threshold.threshold_rad = kThresholdRad;
    with_threshold.name += ", no corner under 5 deg";
    consider(with_threshold);
    StretchLaw with_axes = best->law;
    with_axes.axis_acceleration = true;
    with_axes.name += ", acceleration by axis";
    consider(with_axes);
  }
  fit.machine = best->machine;
  std::vector<const nc::Interpretation*> programs;
  for (const nc::Interpretation& program : data.programs) programs.push_back(&program);
  fit.machine.fitted_range = feedmodel::range_of(programs);
  add_parameters(fit, data, *best, start);
  const auto stopping = times_s(data, stops_at_every_block(fit.machine));
  std::vector<double> constant;
  for (std::size_t i = 0; i < data.items.size(); ++i) {
    JudgedStretch s = data.items[i].judged;
    s.fitted_s = best->fitted_s[i];
    s.held_out_s = best->held_out_s[i];
    s.kind_held_out_s = best->kind_held_out_s[i];
    s.stop_every_block_s = stopping[i];
    constant.push_back(s.constant_feed_s);
    fit.stretches.push_back(s);
  }
  fit.fitted = fit.laws[fit.chosen].fitted;
  fit.held_out = fit.laws[fit.chosen].held_out;
  fit.promise = time_promise(measured, best->kind_held_out_s);
  fit.machine.control.in_position_mm = start.control.in_position_mm;
  fit.constant_feed = stretch_errors(measured, constant);
  fit.stop_every_block = stretch_errors(measured, stopping);
  fit.converged = best->whole.converged;
  fit.message = fit.converged ? "converged" : "the fit did not converge within its steps";
  return fit;
}

}  // namespace camber::calib
