#include "calib/fit_acceleration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "calib/fit_feed_model.h"

namespace camber::calib {
namespace {

constexpr double kLookS = 0.4;  // after a start
constexpr double kMaxRampS = 0.25;
constexpr double kMovesMm = 0.05;     // over the look
constexpr double kFewestPeriods = 8;  // a shorter one looks like a start that is a period or two off
constexpr double kBetterBy = 0.7;     // fraction of the squares that an average must take away
constexpr std::size_t kGroups = 5;
constexpr std::size_t kFewestStarts = 5;
constexpr std::size_t kMaxStarts = 120;

/// Commands of one axis since the start of a part, as planned and as traced, from where they began.
struct Start {
  std::vector<double> planned_mm, traced_mm;
};

struct Samples {
  std::vector<double> command_mm;
  std::vector<std::uint32_t> line;
};

Samples planned_samples(const nc::Interpretation& program, const machine::Machine& machine, int axis) {
  machine::Machine m = machine;
  for (machine::Axis& a : m.axis)
    a = {.max_velocity_mm_per_s = a.max_velocity_mm_per_s,
         .acceleration_mm_per_s2 = a.acceleration_mm_per_s2,
         .rapid_mm_per_s = a.rapid_mm_per_s,
         .rapid_acceleration_mm_per_s2 = a.rapid_acceleration_mm_per_s2};
  Samples out;
  feedmodel::predict_feed(program, m, [&](std::span<const feedmodel::TimedSample> run) {
    for (const feedmodel::TimedSample& s : run) {
      out.command_mm.push_back(s.command_mm[axis]);
      out.line.push_back(s.feed_command_mm_per_s > 0 ? program.moves[s.move].block + 1 : 0);
    }
  });
  return out;
}

/// First sample of each part that begins after a rest; parts in the order of their lines.
std::vector<std::size_t> starts_of(const std::vector<std::uint32_t>& line, const std::vector<TracePart>& parts) {
  std::vector<std::size_t> starts(parts.size(), 0);
  std::size_t k = 1;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::size_t i = k;
    while (i < line.size() && (line[i] < parts[p].line_first || line[i] > parts[p].line_last)) ++i;
    if (i == line.size()) continue;
    if (line[i - 1] == 0) starts[p] = i;
    k = i + 1;
  }
  return starts;
}

void add_starts(const FeedRun& run, const machine::Machine& machine, int axis, std::vector<Start>& out) {
  if (run.trace.line.empty() || !run.trace.has_command[static_cast<std::size_t>(axis)]) return;
  const Samples planned = planned_samples(run.program, machine, axis);
  const std::vector<TracePart> parts = parts_of(run.program, machine);
  const auto in_plan = starts_of(planned.line, parts), in_trace = starts_of(run.trace.line, parts);
  const auto look = static_cast<std::size_t>(kLookS / run.trace.period_s);
  const double step = run.trace.period_s / machine.control.period_s;  // of a sample of the trace, in periods
  for (std::size_t p = 0; p < parts.size() && out.size() < kMaxStarts; ++p) {
    const std::size_t a = in_plan[p], b = in_trace[p];
    if (a == 0 || b == 0) continue;
    Start s;
    for (std::size_t i = 0; i < look; ++i) {
      const double at = static_cast<double>(a) + step * static_cast<double>(i);
      const auto k = static_cast<std::size_t>(at);
      const bool same_part = k + 1 < planned.line.size() && b + i < run.trace.line.size() &&
                             run.trace.line[b + i] >= parts[p].line_first &&
                             run.trace.line[b + i] <= parts[p].line_last;
      if (!same_part) break;
      const double u = at - static_cast<double>(k);
      s.planned_mm.push_back((1 - u) * planned.command_mm[k] + u * planned.command_mm[k + 1] - planned.command_mm[a]);
      s.traced_mm.push_back(run.trace.command_mm[b + i][axis] - run.trace.command_mm[b][axis]);
    }
    if (s.planned_mm.size() > 3 && std::abs(s.planned_mm.back()) > kMovesMm) out.push_back(std::move(s));
  }
}

/// Sum of squares between the traced commands and the planned ones averaged over `window` periods.
double squares(const Start& s, std::size_t window) {
  double sum = 0, mean = 0;
  for (std::size_t i = 0; i < s.planned_mm.size(); ++i) {
    mean += s.planned_mm[i] - (i >= window ? s.planned_mm[i - window] : 0.0);
    const double d = mean / static_cast<double>(window) - s.traced_mm[i];
    sum += d * d;
  }
  return sum;
}

/// The best window, in periods, of a table of squares [start][window - 1]; `left_out`: a group, or kGroups.
double best_window(const std::vector<std::vector<double>>& table, std::size_t left_out) {
  std::vector<double> sum(table.front().size(), 0.0);
  for (std::size_t i = 0; i < table.size(); ++i)
    for (std::size_t w = 0; w < sum.size() && i % kGroups != left_out; ++w) sum[w] += table[i][w];
  const auto at = static_cast<std::size_t>(std::min_element(sum.begin(), sum.end()) - sum.begin());
  double shift = 0;
  if (at > 0 && at + 1 < sum.size()) {
    const double curve = sum[at - 1] - 2 * sum[at] + sum[at + 1];
    if (curve > 0) shift = 0.5 * (sum[at - 1] - sum[at + 1]) / curve;
  }
  return static_cast<double>(at + 1) + std::clamp(shift, -0.5, 0.5);
}

}  // namespace

std::optional<FittedValue> ramp_time_s(const std::vector<FeedRun>& runs, const machine::Machine& machine, int axis) {
  std::vector<Start> starts;
  for (const FeedRun& run : runs) add_starts(run, machine, axis, starts);
  if (starts.size() < kFewestStarts) return std::nullopt;
  const double period_s = runs.front().trace.period_s;
  const auto most = static_cast<std::size_t>(kMaxRampS / period_s);
  std::vector<std::vector<double>> table(starts.size(), std::vector<double>(most));
  double without = 0, with = 0;
  for (std::size_t i = 0; i < starts.size(); ++i)
    for (std::size_t w = 0; w < most; ++w) table[i][w] = squares(starts[i], w + 1);
  const double window = best_window(table, kGroups);
  for (const auto& row : table) {
    without += row.front();
    with += row[static_cast<std::size_t>(std::lround(window)) - 1];
  }
  if (window < kFewestPeriods || with > (1 - kBetterBy) * without) return std::nullopt;
  double mean = 0, spread = 0;
  std::array<double, kGroups> left_out{};
  for (std::size_t g = 0; g < kGroups; ++g) mean += (left_out[g] = best_window(table, g)) / kGroups;
  for (const double w : left_out) spread += (w - mean) * (w - mean);
  const double jackknife = std::sqrt((kGroups - 1.0) / kGroups * spread);
  return FittedValue{window * period_s, period_s * std::max(0.3, jackknife)};
}

namespace {

constexpr double kRestS = 0.02;
constexpr double kRiseMovesMm = 0.001;  // over the look
constexpr std::size_t kHalfWindow = 4;  // periods; a speed difference is taken over twice as many
constexpr double kFallen = 0.7;         // of the greatest acceleration: it is over
constexpr std::size_t kFewestRises = 3;

/// Acceleration along the path at every sample of [first, end), of the commanded positions.
std::vector<double> accelerations(const ServoTrace& trace, std::size_t first, std::size_t end) {
  const std::size_t h = kHalfWindow;
  const double t = static_cast<double>(h) * trace.period_s;
  std::vector<double> a;
  for (std::size_t k = first; k < end; ++k) {
    const double before = (trace.command_mm[k] - trace.command_mm[k - h]).norm() / t;
    const double after = (trace.command_mm[k + h] - trace.command_mm[k]).norm() / t;
    a.push_back((after - before) / t);
  }
  return a;
}

std::optional<double> rise_of(const std::vector<double>& a, double period_s) {
  std::size_t top = 0;
  for (std::size_t i = 0; i < a.size() && a[i] > kFallen * a[top]; ++i)
    if (a[i] > a[top]) top = i;
  for (std::size_t i = 1; i < a.size(); ++i) {
    if (a[i] > a[top]) top = i;
    if (a[i] < kFallen * a[top] && i > top) break;
  }
  if (a.empty() || a[top] <= 0) return std::nullopt;
  double low = -1, high = -1, held = 0;
  for (std::size_t i = 1; i < a.size(); ++i) {
    const auto crossing = [&](double level) {
      return static_cast<double>(i) - (a[i] - level) / std::max(1e-12, a[i] - a[i - 1]);
    };
    if (low < 0 && a[i] >= 0.1 * a[top]) low = crossing(0.1 * a[top]);
    if (high < 0 && a[i] >= 0.9 * a[top]) high = crossing(0.9 * a[top]);
    if (high >= 0 && a[i] < 0.9 * a[top]) break;
    if (high >= 0) ++held;
  }
  const double apparent = (high - low) / 0.8, window = 1.0 * kHalfWindow;
  if (low < 0 || high < 0 || held < 0.5 * apparent) return std::nullopt;
  return period_s * std::sqrt(std::max(0.0, apparent * apparent - window * window));
}

void add_starts(const ServoTrace& trace, std::vector<double>& rises) {
  const auto rest = static_cast<std::size_t>(kRestS / trace.period_s);
  const auto look = static_cast<std::size_t>(kLookS / trace.period_s);
  for (const Stretch& s : trace.stretches) {
    std::size_t still = 0;
    for (std::size_t k = s.first + 1; k + look + kHalfWindow < s.end; ++k) {
      if (trace.command_mm[k] == trace.command_mm[k - 1]) {
        ++still;
        continue;
      }
      const bool starts = still >= rest && k > s.first + rest &&
                          (trace.command_mm[k + look] - trace.command_mm[k]).norm() > kRiseMovesMm;
      still = 0;
      if (!starts) continue;
      const std::size_t from = k - std::min(k - s.first - kHalfWindow, 2 * kHalfWindow);
      if (const auto rise = rise_of(accelerations(trace, from, k + look), trace.period_s)) rises.push_back(*rise);
    }
  }
}

}  // namespace

std::optional<FittedValue> smoothing_time_s(const std::vector<const ServoTrace*>& traces) {
  std::vector<double> rises;
  for (const ServoTrace* trace : traces) add_starts(*trace, rises);
  if (rises.size() < kFewestRises) return std::nullopt;
  std::sort(rises.begin(), rises.end());
  const double value = rises[rises.size() * 3 / 4];
  if (value <= 2 * kHalfWindow * traces.front()->period_s) return std::nullopt;
  return FittedValue{value, 0.5 * std::max(traces.front()->period_s, rises.back() - rises[rises.size() / 2])};
}

namespace {

constexpr double kHeldWindowS = 0.06, kHeldLongerS = 0.01;
constexpr std::size_t kFewHeld = 20;
constexpr double kHeldBand = 5e-4;      // samples of one ramp differ by less than this share: rounding of the trace
constexpr double kBelowOwnTop = 0.995;  // of an axis that does not limit

/// Returns the acceleration of one axis, over windows of ten periods (a trace is rounded). 0: the axis rests.
double traced_acceleration(const std::vector<const ServoTrace*>& traces, int axis) {
  constexpr std::size_t kWindow = 10, kLeftOut = 20;
  std::vector<double> highest;  // a heap, least in front
  for (const ServoTrace* trace : traces) {
    const auto& c = trace->command_mm;
    const double t = static_cast<double>(kWindow) * trace->period_s;
    for (const Stretch& s : trace->stretches)
      for (std::size_t k = s.first; k + 2 * kWindow < s.end; ++k) {
        const double a = std::abs(c[k + 2 * kWindow][axis] - 2 * c[k + kWindow][axis] + c[k][axis]) / (t * t);
        if (highest.size() > kLeftOut && a <= highest.front()) continue;
        highest.push_back(a);
        std::push_heap(highest.begin(), highest.end(), std::greater<>());
        if (highest.size() <= kLeftOut + 1) continue;
        std::pop_heap(highest.begin(), highest.end(), std::greater<>());
        highest.pop_back();
      }
  }
  return highest.empty() ? 0 : highest.front();
}

/// Lines on the exact path without tool-centre-point control, by number.
std::vector<char> exact_lines(const nc::Interpretation& program) {
  std::vector<char> lines;
  for (const nc::Move& move : program.moves) {
    const nc::ModalState& state = program.state_of(move);
    if (lines.size() <= move.block + 1) lines.resize(move.block + 2, 0);
    lines[move.block + 1] = state.path_control != nc::PathControl::blend && state.tip_control == nc::TipControl::off;
  }
  return lines;
}

/// Second differences of the axes over one window, per s^2.
struct RampSample {
  std::array<float, 6> value{};
  std::array<bool, 6> lasts{};  ///< the same a little later: the whole window lies in a ramp
};

void add_second_differences(const FeedRun& run, std::vector<RampSample>& out) {
  const ServoTrace& trace = run.trace;
  const std::vector<char> exact = exact_lines(run.program);
  const auto window = static_cast<std::size_t>(std::max(1L, std::lround(kHeldWindowS / trace.period_s)));
  const auto later = static_cast<std::size_t>(std::max(1L, std::lround(kHeldLongerS / trace.period_s)));
  const double t = static_cast<double>(window) * trace.period_s;
  const auto is_exact = [&](std::size_t k) {
    return trace.line[k] > 0 && trace.line[k] < exact.size() && exact[trace.line[k]] != 0;
  };
  const auto difference = [&](const std::vector<Vec3>& c, std::size_t k, int i) {
    return std::abs(c[k + 2 * window][i] - 2 * c[k + window][i] + c[k][i]) / (t * t);
  };
  const auto add = [&](const std::vector<Vec3>& c, std::size_t k, RampSample& sample, std::size_t first) {
    for (int i = 0; i < 3; ++i) {
      const std::size_t axis = first + static_cast<std::size_t>(i);
      const double a = difference(c, k, i);
      sample.value[axis] = static_cast<float>(a);
      sample.lasts[axis] = std::abs(difference(c, k + later, i) - a) < kHeldBand * a;
    }
  };
  const std::size_t length = 2 * window + later;
  for (const Stretch& s : trace.stretches)
    for (std::size_t k = s.first; k + length < std::min(s.end, trace.line.size()); ++k) {
      // A ramp lies within one block.
      if (!is_exact(k) || trace.line[k + window] != trace.line[k] || trace.line[k + length] != trace.line[k]) continue;
      RampSample sample;
      add(trace.command_mm, k, sample, 0);
      if (!trace.rotary_command_deg.empty()) add(trace.rotary_command_deg, k, sample, 3);
      out.push_back(sample);
    }
}

double top_of(const std::vector<RampSample>& all, std::size_t axis) {
  std::vector<float> values;
  for (const RampSample& s : all)
    if (s.lasts[axis]) values.push_back(s.value[axis]);
  if (values.size() <= kFewHeld) return 0;
  std::ranges::nth_element(values, values.begin() + kFewHeld, std::greater<>());
  return values[kFewHeld];
}

FittedValue held(const std::vector<RampSample>& all, const std::array<double, 6>& top, std::size_t axis) {
  const auto alone = [&](const RampSample& s) {
    for (std::size_t i = 0; i < top.size(); ++i)
      if (i != axis && top[i] > 0 && s.value[i] > kBelowOwnTop * top[i]) return false;
    return true;
  };
  std::vector<float> near;
  for (const RampSample& s : all)
    if (s.lasts[axis] && s.value[axis] > (1 - kHeldBand) * top[axis] && alone(s)) near.push_back(s.value[axis]);
  if (top[axis] <= 0 || near.size() < kFewHeld) return {};
  const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
  std::nth_element(near.begin(), middle, near.end());
  return {*middle, kHeldBand / 2 * *middle};
}

}  // namespace

Accelerations traced_accelerations(const std::vector<const ServoTrace*>& traces,
                                   const std::vector<const ServoTrace*>& rotary) {
  Accelerations out{};
  for (int axis = 0; axis < 3; ++axis) {
    out[static_cast<std::size_t>(axis)] = traced_acceleration(traces, axis);
    if (!rotary.empty()) out[3 + static_cast<std::size_t>(axis)] = traced_acceleration(rotary, axis);
  }
  return out;
}

std::array<FittedValue, 6> held_accelerations(const std::vector<FeedRun>& runs) {
  std::vector<RampSample> all;
  for (const FeedRun& run : runs)
    if (!run.trace.line.empty()) add_second_differences(run, all);
  std::array<double, 6> top{};
  for (std::size_t i = 0; i < top.size(); ++i) top[i] = top_of(all, i);
  std::array<FittedValue, 6> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = held(all, top, i);
  return out;
}

}  // namespace camber::calib
