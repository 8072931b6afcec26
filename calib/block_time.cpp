#include "calib/block_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace camber::calib {
namespace {

constexpr double kSameLength = 0.03;
constexpr std::size_t kFewestLines = 20;
constexpr double kReached = 0.95;  // of the programmed feed
constexpr double kMinFraction = 0.05;
constexpr double kOtherLength = 1.2;  // lengths that differ by less are one

bool continues(const nc::Interpretation& program, std::size_t i, double chord_mm) {
  const nc::Move &move = program.moves[i], &before = program.moves[i - 1];
  return move.kind == nc::MoveKind::linear && move.feed_mm_per_s == before.feed_mm_per_s && move.block > before.block &&
         std::abs(length_mm(program, move) - chord_mm) < kSameLength * chord_mm;
}

/// Time at which the trace first names a line at or after `line` within [from, to]; negative: never.
double first_time(const ServoTrace& trace, std::uint32_t line, std::uint32_t last) {
  for (std::size_t k = 0; k < trace.size(); ++k)
    if (trace.line[k] >= line && trace.line[k] <= last) return trace.t_s[k];
  return -1;
}

void add_runs(const nc::Interpretation& program, const ServoTrace& trace, std::vector<ChordRun>& runs) {
  const auto& moves = program.moves;
  for (std::size_t first = 0; first < moves.size();) {
    std::size_t end = first + 1;
    const double chord = length_mm(program, moves[first]);
    if (moves[first].kind == nc::MoveKind::linear && chord > 0)
      while (end < moves.size() && continues(program, end, chord)) ++end;
    if (end - first >= kFewestLines) {
      const std::size_t a = first + (end - first) / 4, b = first + 3 * (end - first) / 4;
      const std::uint32_t last = moves[end - 1].block + 1;
      const double from = first_time(trace, moves[a].block + 1, last), to = first_time(trace, moves[b].block + 1, last);
      double length = 0;
      for (std::size_t i = a; i < b; ++i) length += length_mm(program, moves[i]);
      if (from >= 0 && to > from) {
        const double speed = length / (to - from);
        runs.push_back({.line_first = moves[first].block + 1,
                        .line_last = last,
                        .chord_mm = length / static_cast<double>(b - a),
                        .feed_mm_per_s = moves[first].feed_mm_per_s,
                        .speed_mm_per_s = speed,
                        .block_time_s = (to - from) / static_cast<double>(b - a),
                        .resolution_s = trace.period_s / static_cast<double>(b - a)});
      }
    }
    first = end;
  }
}

}  // namespace

BlockTimeFit fit_block_time(const std::vector<std::pair<const nc::Interpretation*, const ServoTrace*>>& runs) {
  BlockTimeFit fit;
  for (const auto& [program, trace] : runs)
    if (!trace->line.empty()) add_runs(*program, *trace, fit.runs);
  double least = INFINITY, shortest = INFINITY, longest = 0;
  for (const ChordRun& r : fit.runs)
    if (r.speed_mm_per_s < kReached * r.feed_mm_per_s) least = std::min(least, r.block_time_s);
  std::vector<double> times;
  double resolution_s = 0;
  for (ChordRun& r : fit.runs) {
    r.saturated = r.speed_mm_per_s < kReached * r.feed_mm_per_s && r.block_time_s < (1 + kMinFraction) * least;
    if (!r.saturated) continue;
    times.push_back(r.block_time_s);
    resolution_s = std::max(resolution_s, r.resolution_s);
    shortest = std::min(shortest, r.chord_mm);
    longest = std::max(longest, r.chord_mm);
  }
  if (times.empty()) {
    fit.message = fit.runs.empty() ? "no run of lines of one length; run the saturation program of camber protocol"
                                   : "every run of lines of one length reaches its feed: the block time is too short "
                                     "to show in these programs";
    return fit;
  }
  if (longest < kOtherLength * shortest) {
    fit.message = fmt::format(
        "lines of {:.3g} mm alone are slower than their feed: another limit could be the cause; run the saturation "
        "program of camber protocol, which has more lengths",
        shortest);
    return fit;
  }
  double mean = 0, square = 0;
  const auto n = static_cast<double>(times.size());
  for (double t : times) mean += t / n;
  for (double t : times) square += (t - mean) * (t - mean);
  fit.block_time_s = FittedValue{mean, std::hypot(std::sqrt(square / std::max(1.0, n - 1) / n), resolution_s)};
  fit.message = fmt::format(
      "block processing time {:.4g} ms, standard error {:.2g} ms, from {} runs of {:.3g} to "
      "{:.3g} mm",
      1000 * mean, 1000 * fit.block_time_s->std_error, times.size(), shortest, longest);
  return fit;
}

}  // namespace camber::calib
