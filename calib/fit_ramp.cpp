#include "calib/fit_ramp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/fit_feed.h"

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
std::vector<std::size_t> starts_of(const std::vector<std::uint32_t>& line, const std::vector<Part>& parts) {
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
  const std::vector<Part> parts = parts_of(run.program, machine);
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

}  // namespace camber::calib
