#include "camber/fit_feed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "api/job.h"
#include "api/program.h"
#include "api/rotary_program.h"
#include "api/run.h"
#include "calib/column_map.h"
#include "calib/fit_drive.h"
#include "calib/machine_log.h"
#include "calib/place_trace.h"
#include "calib/trace_check.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/machine_program.h"
#include "kinematics/offset_check.h"
#include "report/fit_summary.h"

namespace camber {
namespace {

struct FeedRuns {
  std::vector<calib::FeedRun> servo;
  std::vector<calib::StretchRun> stretches;  ///< one for each program; empty where all traces are servo traces

  /// Whether a servo trace names the line it commands, so that the limits can be fitted block by block.
  bool any_lines() const {
    return std::ranges::any_of(servo, [](const calib::FeedRun& run) { return !run.trace.line.empty(); });
  }

  /// Timed pieces of runs.
  std::size_t pieces() const {
    std::size_t count = 0;
    for (const calib::StretchRun& run : stretches)
      count += static_cast<std::size_t>(
          std::ranges::count_if(run.timed, [](const auto& t) { return t.stretch.begins_in_motion(); }));
    return count;
  }
};

constexpr std::size_t kManyPieces = 40;  // tell the limits of each axis

/// Kind of a trace file, by its content.
enum class TraceKind { servo, machine_log, stretch_table };

TraceKind kind_of(const std::string& path) {
  if (calib::is_machine_log(path)) return TraceKind::machine_log;
  return calib::is_stretch_table(path) ? TraceKind::stretch_table : TraceKind::servo;
}

/// The stretches of one program belong together, however many logs tell of it: copies of a geometry must not be in
/// two folds.
calib::StretchRun& stretch_run(FeedRuns& runs, const std::string& name, const nc::Interpretation& program) {
  for (calib::StretchRun& run : runs.stretches)
    if (run.program_name == name) return run;
  runs.stretches.push_back({name, program, {}});
  return runs.stretches.back();
}

constexpr double kLogPieceSamples = 30;  // of a position log in a piece whose ends are known to a fraction of one
constexpr double kPieceS = 0.4, kPieceSamples = 0.8;  // of a trace whose samples are too few to show ramps

/// Times the stretches by the lines that a log names; where it names none, or too few, by its positions.
std::vector<calib::TimedStretch> log_times(const calib::MachineLog& log, const nc::Interpretation& program) {
  auto timed = calib::logged_stretches(log, calib::feed_stretches(program));
  if (!timed.empty() || !calib::has_positions(log)) return timed;
  const calib::ServoTrace trace = calib::position_trace(log);
  const auto placed = trace.size() > 1 ? calib::place_on_path(trace, program) : std::nullopt;
  if (!placed)
    fail_on_file(log.path,
                 "the positions do not follow the path of the program; a log of this program was expected, in mm",
                 "trace-program");
  // Events of the axes come one by one, so that a place is known to a fraction of their distance.
  const calib::PlacingOptions pieces{.piece_s = kLogPieceSamples * trace.period_s, .end_sigma_s = trace.period_s / 4};
  return calib::placed_stretches(trace, program, *placed, pieces,
                                 [&](double from_s, double to_s) { return calib::steady_override(log, from_s, to_s); });
}

void add_times(calib::StretchRun& run, const std::string& path, TraceKind kind, Diagnostics& diagnostics) {
  const auto timed = kind == TraceKind::machine_log ? log_times(calib::read_machine_log(path, diagnostics), run.program)
                                                    : calib::read_stretch_table(path, run.program);
  if (timed.empty())
    fail_on_file(path, "has no stretch of feed moves of the program at a constant override and without a feed hold",
                 "log-stretches");
  run.timed.insert(run.timed.end(), timed.begin(), timed.end());
}

nc::Interpretation moves_of(const Program& program, const machine::Machine& start, Diagnostics& diagnostics) {
  const nc::Program& text = program.impl().text;
  diagnostics.append(program.impl().found);
  nc::Interpretation moves = kinematics::read_moves(
      text, start, {.given = program.impl().options, .rotary = kinematics::RotaryWords::always}, diagnostics);
  if (diagnostics.errors() == 0 && kinematics::has_rotary_motion(moves, start)) {
    kinematics::check_offsets(text, moves, kinematics::Asked::joints, diagnostics);
    kinematics::place_moves(moves, start);
  }
  return moves;
}

/// A servo trace with its lines, where it names them or the path tells them; a position log, the samples of which are
/// too few to show ramps, gives times of pieces.
void add_trace(FeedRuns& runs, const std::string& name, nc::Interpretation moves, calib::ServoTrace trace,
               const machine::Machine& start, Diagnostics& diagnostics) {
  constexpr double kDenseS = 0.0105;  // samples further apart show no ramps
  const bool sparse = trace.period_s > kDenseS;
  const std::array<bool, 3> all{true, true, true};
  const bool placeable =
      (trace.has_actual == all || trace.has_command == all) && !kinematics::has_rotary_motion(moves, start);
  std::optional<calib::PlacedTrace> placed;
  if (placeable && (trace.line.empty() || sparse)) {
    placed = calib::place_on_path(trace, moves);
    // Where it has lines, these tell more exactly what is wrong with it.
    if (!placed && !trace.line.empty()) calib::check_trace({name, moves, trace}, start, diagnostics);
    if (!placed)
      fail_on_file(
          trace.path,
          fmt::format("the positions do not follow the path of {}; a trace of this program was expected, in mm "
                      "and in its work offset (scale and offset of --columns)",
                      name),
          "trace-program");
    if (!sparse) calib::set_lines(trace, moves, *placed);
  }
  runs.servo.push_back({name, std::move(moves), std::move(trace)});
  const calib::FeedRun& run = runs.servo.back();
  calib::check_trace(run, start, diagnostics);
  if (!placed || !sparse) return;
  const auto timed = calib::placed_stretches(run.trace, run.program, *placed,
                                             {.piece_s = std::max(kPieceS, kPieceSamples * run.trace.period_s)});
  if (timed.empty())
    fail_on_file(run.trace.path,
                 fmt::format("holds no two samples in motion within one run of feed moves; they are {:.3g} s apart",
                             run.trace.period_s),
                 "log-stretches");
  calib::StretchRun& stretches = stretch_run(runs, name, run.program);
  stretches.timed.insert(stretches.timed.end(), timed.begin(), timed.end());
  runs.servo.pop_back();
}

/// `columns`: file with a column map; empty: our CSV. Throws InputError.
FeedRuns read_runs(const std::vector<FeedTrace>& traces, const std::string& columns, const machine::Machine& start,
                   Diagnostics& diagnostics) {
  std::optional<calib::ColumnMap> map;
  if (!columns.empty()) map = calib::read_column_map(columns, diagnostics);
  FeedRuns runs;
  for (const FeedTrace& one : traces) {
    nc::Interpretation moves = moves_of(one.program, start, diagnostics);
    diagnostics.throw_if_errors();
    const TraceKind kind = kind_of(one.trace);
    if (kind == TraceKind::servo) {
      auto trace =
          map ? calib::read_mapped_trace(one.trace, *map, diagnostics) : calib::read_trace(one.trace, diagnostics);
      add_trace(runs, one.program.path(), std::move(moves), std::move(trace), start, diagnostics);
    } else {
      add_times(stretch_run(runs, one.program.path(), moves), one.trace, kind, diagnostics);
    }
  }
  return runs;
}

/// Drives come from the servo traces without lines, where some are given beside times of stretches.
report::FeedFit fit_runs(const FeedRuns& runs, const machine::Machine& start, const calib::FitFeedOptions& options) {
  if (runs.stretches.empty() || runs.any_lines()) return calib::fit_feed(runs.servo, runs.stretches, start, options);
  if (runs.pieces() >= kManyPieces) return calib::fit_feed(runs.servo, runs.stretches, start, options);
  calib::StretchFit fit = calib::fit_stretches(runs.stretches, start, {});
  std::vector<const calib::ServoTrace*> traces;
  for (const calib::FeedRun& run : runs.servo) traces.push_back(&run.trace);
  for (int axis = 0; axis < 3 && !traces.empty(); ++axis)
    calib::add_drive(fit.machine, fit.parameters, axis, calib::fit_drive(traces, axis, {}));
  return fit;
}

Machine machine_of(const machine::Machine& fitted) {
  auto impl = std::make_shared<Machine::Impl>();
  impl->machine = fitted;
  return Machine(std::move(impl));
}

std::vector<FitParameter> parameters_of(const std::vector<calib::FitParameter>& parameters) {
  std::vector<FitParameter> out;
  out.reserve(parameters.size());
  for (const auto& p : parameters)
    out.push_back({p.name, p.value, p.unit, p.std_error, p.note, p.written, p.stretches, p.changed_from});
  return out;
}

calib::BlockTimeFit block_times(const FeedRuns& runs) {
  std::vector<std::pair<const nc::Interpretation*, const calib::ServoTrace*>> traced;
  for (const calib::FeedRun& run : runs.servo) traced.emplace_back(&run.program, &run.trace);
  return calib::fit_block_time(traced);
}

void take_fit(const report::FeedFit& fit, bool page, FitFeedResult& result) {
  std::visit(
      [&](const auto& fitted) {
        result.machine = machine_of(fitted.machine);
        result.parameters = parameters_of(fitted.parameters);
        result.converged = fitted.converged;
        result.message = fitted.message;
      },
      fit);
  result.json = report::fit_json(fit);
  result.printed += report::fit_text(fit);
  const auto* by_lines = std::get_if<calib::FitFeedResult>(&fit);
  if (page && by_lines) result.page = report::fit_feed_page(*by_lines);
}

}  // namespace

FitFeedResult v0::fit_feed(const std::vector<FeedTrace>& traces, const Machine& start, const FitFeedOptions& options,
                           const RunOptions& run_options) {
  if (traces.empty()) fail_on_file(start.path(), "a program and its trace are required", "fit-runs");
  FitFeedResult result{.machine = start};
  api::Run run(run_options);
  run.execute([&] {
    const machine::Machine& from = start.impl().machine;
    Diagnostics found = start.impl().found;
    const FeedRuns runs = read_runs(traces, options.columns, from, found);
    run.settle_first(found);
    if (options.page && !runs.any_lines())
      fail_on_file(traces.front().trace, "has no speeds by line; --report needs a servo trace that names its lines",
                   "fit-report");
    if (options.block_time) {
      const calib::BlockTimeFit fit = block_times(runs);
      result.block_time_plot = report::block_time_svg(fit);
      result.printed = report::block_time_text(fit);
    }
    run.show("fitting", 0);
    const report::FeedFit fit = fit_runs(runs, from, {.update = options.update});
    take_fit(fit, options.page, result);
    result.diagnostics = found.all();
    if (!options.leave_one_out || std::holds_alternative<calib::StretchFit>(fit)) return;
    run.steps()("leave-one-out fits", std::nullopt);
    result.left_out = report::left_out_text(calib::leave_one_out(runs.servo, from, {}, runs.stretches));
  });
  return result;
}

}  // namespace camber
