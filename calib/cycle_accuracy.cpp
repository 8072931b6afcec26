#include "calib/cycle_accuracy.h"

#include <algorithm>

#include "calib/feed_accuracy.h"

namespace camber::calib {
namespace {

/// First and last sample between which the command (or, without one, the axes) moves.
Stretch moving(const ServoTrace& trace) {
  const bool commanded = trace.has_command[0] || trace.has_command[1] || trace.has_command[2];
  const std::vector<Vec3>& places = commanded ? trace.command_mm : trace.actual_mm;
  Stretch out{trace.size(), 0};
  for (std::size_t k = 1; k < places.size(); ++k) {
    if (places[k] == places[k - 1]) continue;
    out.first = std::min(out.first, k - 1);
    out.end = k;
  }
  return out;
}

/// Measured seconds of each line, index = line.
std::vector<double> line_times(const ServoTrace& trace, const Stretch& run, std::size_t lines) {
  std::vector<double> out(lines + 1, 0.0);
  for (std::size_t k = run.first; k < run.end; ++k)
    if (trace.line[k] <= lines) out[trace.line[k]] += trace.t_s[k + 1] - trace.t_s[k];
  return out;
}

TimePair& pair_of(CycleAccuracy& accuracy, nc::MoveKind kind) {
  if (kind == nc::MoveKind::rapid) return accuracy.positioning;
  return kind == nc::MoveKind::dwell ? accuracy.dwell : accuracy.cutting;
}

void add_lines(CycleAccuracy& out, const std::vector<double>& measured, const nc::Interpretation& program,
               const std::vector<double>& move_s) {
  std::vector<double> predicted(measured.size(), 0.0);
  std::uint32_t last_line = 0;
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& move = program.moves[i];
    const std::uint32_t line = move.block + 1;
    TimePair& kind = pair_of(out, move.kind);
    kind.predicted_s += move_s[i];
    predicted[line] += move_s[i];
    if (line != last_line) kind.measured_s += measured[line];  // of several moves of one line, with the first
    last_line = line;
  }
  for (const TracePart& part : parts_of(program)) {
    MeasuredPart row{part.line_first, part.line_last, {}};
    for (std::uint32_t line = part.line_first; line <= part.line_last && line < measured.size(); ++line) {
      row.time.measured_s += measured[line];
      row.time.predicted_s += predicted[line];
    }
    if (row.time.measured_s > 0) out.parts.push_back(row);
  }
}

}  // namespace

double TimePair::error_percent() const {
  return measured_s > 0 ? 100.0 * (predicted_s - measured_s) / measured_s : 0.0;
}

CycleAccuracy cycle_accuracy(const ServoTrace& trace, const nc::Interpretation& program,
                             const feedmodel::CycleTime& time) {
  CycleAccuracy out;
  out.total.predicted_s = time.all.time.total_s();
  const Stretch run = moving(trace);
  if (run.first >= run.end) return out;
  out.total.measured_s = trace.t_s[run.end] - trace.t_s[run.first];
  out.has_lines = !trace.line.empty();
  std::uint32_t lines = 0;
  for (const nc::Move& move : program.moves) lines = std::max(lines, move.block + 1);
  if (!out.has_lines) return out;
  add_lines(out, line_times(trace, run, lines), program, time.move_s);
  out.dwell.measured_s = out.total.measured_s - out.cutting.measured_s - out.positioning.measured_s;
  return out;
}

}  // namespace camber::calib
