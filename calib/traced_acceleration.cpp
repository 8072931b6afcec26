#include "calib/traced_acceleration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

namespace camber::calib {
namespace {

constexpr double kHeldWindowS = 0.06, kHeldLongerS = 0.01;
constexpr std::size_t kFewHeld = 20;
constexpr double kHeldBand = 5e-4;      // samples of one ramp differ by less than this share: rounding of the trace
constexpr double kBelowOwnTop = 0.995;  // of an axis that does not limit

/// Of one axis, over windows of ten periods (a trace is rounded). 0: the axis rests.
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
    if (!rotary.empty()) out[static_cast<std::size_t>(3 + axis)] = traced_acceleration(rotary, axis);
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
