#include "calib/control_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include "base/units.h"
#include "feedmodel/motion_plan.h"

namespace camber::calib {
namespace {

using machine::CornerLaw;
using machine::Machine;

constexpr double kBetterBy = 1e-3;        // share by which another law must lower the held-out cost
constexpr double kRicherBetterBy = 0.05;  // and one with an angle more
constexpr double kWideGapRad = 12.0 * kPi / 180.0;
constexpr double kSlightRad = 0.5 * kPi / 180.0;
constexpr double kBluntRad = 125.0 * kPi / 180.0;  // sharper corners are stops for every law, or all but stops
constexpr int kCoarseSteps = 16;
constexpr double kAddedUp = 1.5;  // of a limit: a block at half of it and one that stops, together
constexpr double kBellTimeS = 0.04;
constexpr double kGoodCost = 0.3;  // times agree to what they are known to
constexpr double kNearCost = 1.5;  // times the cost of the best law
constexpr double kThresholdRad = 5.0 * kPi / 180.0;

struct NamedLaw {
  const char* name;
  CornerLaw law;
};
constexpr NamedLaw kLaws[] = {{"rounding within a tolerance", CornerLaw::blend},
                              {"speed difference by axis", CornerLaw::speed_difference},
                              {"speed change by angle", CornerLaw::angle},
                              {"radius of three points", CornerLaw::radius},
                              {"exact stop", CornerLaw::exact_stop}};

/// The law's number at a value that lets every corner pass, until the fit finds the real one.
void set_law(machine::Corner& corner, CornerLaw law) {
  if (corner.law == law) return;
  corner = {.law = law, .tolerance_mm = law == CornerLaw::blend ? machine::kNoLimit : 0.0};
}

/// Angles between lines that follow each other, ascending.
std::set<double> corner_angles(const std::vector<TimedLines>& data) {
  std::set<double> angles{0.0};
  for (const TimedLines& lines : data) {
    const auto& moves = lines.program->moves;
    for (std::size_t i = 1; i < moves.size(); ++i) {
      if (moves[i].kind != nc::MoveKind::linear || moves[i - 1].kind != nc::MoveKind::linear) continue;
      const Vec3 from = direction_at(*lines.program, moves[i - 1], 1.0),
                 to = direction_at(*lines.program, moves[i], 0.0);
      if (from.isZero() || to.isZero()) continue;
      angles.insert(std::round(1e4 * std::acos(std::clamp(from.dot(to), -1.0, 1.0))) / 1e4);
    }
  }
  return angles;
}

/// Index into Accelerations.
std::optional<std::size_t> axis_of_acceleration(const LimitParameter& p) {
  constexpr std::string_view kLetters = "xyzabc", kAxis = "axis.";
  if (!p.name.starts_with(kAxis) || p.name.find(".acceleration_") == p.name.npos) return std::nullopt;
  return kLetters.find(p.name[kAxis.size()]);
}

bool is_number_of_law(const LimitParameter& p) {
  return p.name.starts_with("control.corner.") && p.name != "control.corner.step_share";
}

bool is_bell_time(const LimitParameter& p) { return p.name == "cycle.bell_time_ms"; }

bool is_stop_share(const LimitParameter& p) { return p.name == "control.stop_acceleration_share"; }

/// Start values of the law's number and of the accelerations, which make up for each other: the commands of a trace may
/// have been smoothed, so that the accelerations seen in them are too low by a factor that all axes share. Where blocks
/// overlap they are not, but motions that add up show too much.
void start_together(const std::vector<TimedLines>& data, const Machine& base, std::vector<LimitParameter>& parameters) {
  std::vector<LimitParameter> best = parameters;
  double least = INFINITY;
  const bool overlap = blocks_overlap(data, base);
  const std::vector<double> factors = overlap ? std::vector{1.0, 1 / kAddedUp} : std::vector{1.0, 2.0, 4.0, 8.0};
  const bool bell = std::ranges::any_of(parameters, is_bell_time);
  const std::vector<double> bell_times_ms = bell ? std::vector{20.0, 50.0, 120.0} : std::vector{0.0};
  const auto consider = [&](double factor, double bell_time_ms) {
    std::vector<LimitParameter> here = parameters;
    for (LimitParameter& p : here) {
      if (axis_of_acceleration(p) && !p.from_ramps)
        p.start = std::clamp(factor * p.start, p.least * 1.001, p.most * 0.999);
      if (is_bell_time(p)) p.start = bell_time_ms;
    }
    double cost = scan_start(data, base, here, here.size() - 1, kCoarseSteps);
    for (std::size_t i = 0; i < here.size(); ++i)
      if (is_number_of_law(here[i]) || (overlap && is_stop_share(here[i])))
        cost = scan_start(data, base, here, i, kCoarseSteps);
    if (cost >= least) return;
    least = cost;
    best = here;
  };
  for (const double factor : factors)
    for (const double bell_time_ms : bell_times_ms) consider(factor, bell_time_ms);
  parameters = best;
}

/// Whether the parts' times agree clearly better with one of the accelerations that ramps hold a little different.
bool times_contradict_ramps(const std::vector<TimedLines>& data, const LimitFit& fit) {
  constexpr double kOther = 1.01, kBetter = 0.9;
  const auto better = [&](const LimitParameter& p, double factor) {
    Machine other = fit.whole;
    p.set(other, factor * p.fitted.value);
    return cost_of(data, other).fitted < kBetter * fit.fitted_cost;
  };
  return std::ranges::any_of(fit.parameters, [&](const LimitParameter& p) {
    return p.from_ramps && (better(p, 1 / kOther) || better(p, kOther));
  });
}

LimitFit refit(const std::vector<TimedLines>& data, const Machine& machine, const LimitFit& from, int max_iterations) {
  std::vector<LimitParameter> parameters = limit_parameters(machine, any_logged(data), any_lags(data));
  for (LimitParameter& p : parameters) {
    const auto same = std::ranges::find(from.parameters, p.name, &LimitParameter::name);
    const double start = same != from.parameters.end() ? same->fitted.value : p.get(machine);
    if (std::isfinite(start)) p.start = std::clamp(start, p.least * 1.001, p.most * 0.999);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == "control.corner.stop_time_ms") scan_start(data, machine, parameters, i);
  return fit_limits(data, machine, std::move(parameters), max_iterations, false);
}

/// The speed difference is the only law whose number an axis may have of its own.
Machine with_limit_for_each_axis(Machine m) {
  for (machine::Axis& axis : m.axis) axis.speed_difference_mm_per_s = m.control.corner.speed_difference_mm_per_s;
  return m;
}

/// Index of the speed difference where, with a limit for each axis, it is clearly better than the best law: with one
/// for all axes another law may come as near to the times.
std::optional<std::size_t> better_by_axis(const std::vector<TimedLines>& data, const std::vector<TriedLaw>& tried,
                                          std::size_t best, int max_iterations) {
  constexpr double kNear = 3.0;
  const double cost = tried[best].fit.held_out_cost;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (i == best) continue;
    const LimitFit& fit = tried[i].fit;
    if (fit.whole.control.corner.law != CornerLaw::speed_difference || fit.held_out_cost > kNear * cost) continue;
    const LimitFit by_axis = refit(data, with_limit_for_each_axis(fit.whole), fit, max_iterations);
    if (by_axis.held_out_cost < (1 - kRicherBetterBy) * cost) return i;
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::pair<std::string, Machine>> machines_of_each_law(const Machine& start) {
  std::vector<std::pair<std::string, Machine>> machines;
  for (const bool own : {true, false}) {
    for (const NamedLaw& named : kLaws) {
      if ((named.law == start.control.corner.law) != own) continue;
      Machine m = start;
      set_law(m.control.corner, named.law);
      for (machine::Axis& axis : m.axis) axis.speed_difference_mm_per_s = machine::kNoLimit;
      machines.emplace_back(named.name, m);
    }
  }
  return machines;
}

LimitFit fit_law(const std::vector<TimedLines>& data, const Machine& base, const TracedAccelerations& acceleration,
                 int max_iterations) {
  std::vector<LimitParameter> parameters = limit_parameters(base, any_logged(data), any_lags(data));
  const bool overlap = blocks_overlap(data, base);
  for (LimitParameter& p : parameters) {
    const auto axis = axis_of_acceleration(p);
    if (!axis) continue;
    const FittedValue& held = acceleration.held[*axis];
    if (acceleration.highest[*axis] > p.least) p.start = acceleration.highest[*axis];
    if (!overlap || held.value <= p.least || held.value >= p.most) continue;
    p.start = held.value;
    p.fitted = held;
    p.from_ramps = true;
  }
  start_together(data, base, parameters);
  LimitFit fit = fit_limits(data, base, parameters, max_iterations, true);
  if (!times_contradict_ramps(data, fit)) return fit;
  for (LimitParameter& p : parameters) p.from_ramps = false;
  return fit_limits(data, base, std::move(parameters), max_iterations, true);
}

double held_out_percent(const std::vector<TimedLines>& data, const Machine& machine) {
  double sum = 0;
  std::size_t count = 0;
  for (const TimedLines& lines : data) {
    const auto planned = planned_times_s(lines, machine, feedmodel::plan_motion(*lines.program, machine));
    for (std::size_t i = 0; i < planned.size(); ++i) {
      if (lines.time_s[i] <= 0 || !lines.kept_back[i]) continue;
      sum += 100 * std::abs(planned[i] / lines.time_s[i] - 1);
      ++count;
    }
  }
  return count ? sum / static_cast<double>(count) : 0;
}

std::vector<TriedLaw> try_laws(const std::vector<TimedLines>& data, const Machine& start,
                               const TracedAccelerations& acceleration, int max_iterations, std::size_t& best,
                               bool only_own) {
  std::vector<TriedLaw> tried;
  best = 0;
  const bool overlap = blocks_overlap(data, start);
  for (const auto& [name, machine] : machines_of_each_law(start)) {
    if (overlap && machine.control.corner.law != CornerLaw::blend) continue;
    if (only_own && !tried.empty()) break;
    LimitFit fit = fit_law(data, machine, acceleration, max_iterations);
    const double percent = held_out_percent(data, fit.whole);
    tried.push_back({name, std::move(fit), percent});
    const double margin = best == 0 ? 1 - kBetterBy : 1.0;
    if (tried.back().fit.held_out_cost < margin * tried[best].fit.held_out_cost) best = tried.size() - 1;
  }
  // An exact stop is every other law with a number that is nearly nothing: these must be clearly better.
  for (std::size_t i = 0; i < tried.size(); ++i)
    if (tried[i].fit.whole.control.corner.law == CornerLaw::exact_stop &&
        tried[best].fit.held_out_cost > (1 - kRicherBetterBy) * tried[i].fit.held_out_cost)
      best = i;
  if (const auto index = better_by_axis(data, tried, best, max_iterations)) best = *index;
  return tried;
}

namespace {

/// Ramps whose acceleration builds up, under every law that comes near to the standing one: without them the wrong law
/// may be the best.
LimitFit try_bell(const std::vector<TimedLines>& data, const LimitFit& standing,
                  const TracedAccelerations& acceleration, std::vector<TriedLaw>& tried, int max_iterations) {
  LimitFit best = standing;
  if (standing.held_out_cost < kGoodCost || blocks_overlap(data, standing.whole) ||
      standing.whole.cycle.acceleration_law != machine::AccelerationLaw::linear)
    return best;
  const std::vector<TriedLaw> laws = tried;
  for (const TriedLaw& law : laws) {
    Machine m = law.fit.whole;
    if (m.control.corner.law == CornerLaw::blend || law.fit.held_out_cost > kNearCost * standing.held_out_cost)
      continue;
    m.cycle.acceleration_law = machine::AccelerationLaw::bell;
    m.cycle.bell_time_s = kBellTimeS;
    const LimitFit fit = fit_law(data, m, acceleration, max_iterations);
    tried.push_back({law.name + " and bell ramps", fit, held_out_percent(data, fit.whole)});
    const double margin =
        best.whole.cycle.acceleration_law == standing.whole.cycle.acceleration_law ? 1 - kRicherBetterBy : 1.0;
    if (fit.held_out_cost < margin * best.held_out_cost) best = fit;
  }
  return best;
}

}  // namespace

LimitFit try_details(const std::vector<TimedLines>& data, const LimitFit& standing,
                     const TracedAccelerations& acceleration, std::vector<TriedLaw>& tried, int max_iterations) {
  LimitFit best = try_bell(data, standing, acceleration, tried, max_iterations);
  const auto consider = [&](const std::string& name, const Machine& machine, double margin = 1 - kRicherBetterBy) {
    LimitFit fit = refit(data, machine, best, max_iterations);
    tried.push_back({name, fit, held_out_percent(data, fit.whole)});
    if (fit.held_out_cost < margin * best.held_out_cost) best = std::move(fit);
  };
  if (best.whole.control.corner.law == CornerLaw::speed_difference)
    consider("  and a limit for each axis", with_limit_for_each_axis(best.whole));
  const std::set<double> angles = corner_angles(data);
  for (auto low = angles.begin(), high = std::next(low); high != angles.end(); ++low, ++high) {
    if (*low < kSlightRad || *high > kBluntRad || *high - *low < kWideGapRad) continue;
    Machine m = best.whole;
    m.control.corner.stop_angle_rad = (*low + *high) / 2;
    consider(fmt::format("  and a stop above {:.0f} degrees", deg_from_rad(m.control.corner.stop_angle_rad)), m);
  }
  const auto slight = angles.lower_bound(kSlightRad);
  if (slight != angles.end() && *slight < kThresholdRad) {
    Machine m = best.whole;
    m.control.corner.threshold_rad = kThresholdRad;
    // Pieces of a log may have no slight corner that limits the speed; the number of the law then says nothing of them.
    consider("  and no corner under 5 degrees", m, any_logged(data) ? 1 + kBetterBy : 1 - kRicherBetterBy);
  }
  return best;
}

}  // namespace camber::calib
