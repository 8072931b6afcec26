#include "api/commands/fit_feed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "api/commands/rotary_program.h"
#include "base/json.h"
#include "calib/column_map.h"
#include "calib/fit_drive.h"
#include "calib/machine_log.h"
#include "calib/place_trace.h"
#include "calib/trace_check.h"
#include "kinematics/control_options.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/machine_program.h"
#include "kinematics/offset_check.h"
#include "nc/language.h"

namespace camber::api {
namespace {

using calib::FitFeedResult;

/// What a trace file holds shows in its content.
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

/// Samples of a position log in a piece whose ends are known to a fraction of one.
constexpr double kPieceSamples = 30;

/// By the lines that a log names; where it names none, or too few, by its positions.
std::vector<calib::TimedStretch> log_times(const calib::MachineLog& log, const nc::Interpretation& program) {
  auto timed = calib::logged_stretches(log, calib::feed_stretches(program));
  if (!timed.empty() || !calib::has_positions(log)) return timed;
  const calib::ServoTrace trace = calib::position_trace(log);
  const auto placed = trace.size() > 1 ? calib::place_on_path(trace, program) : std::nullopt;
  if (!placed)
    fail_on_file(log.path,
                 "the positions do not follow the path of the program; a log of this program was expected, in mm",
                 "trace-program");
  return calib::placed_stretches(trace, program, *placed, kPieceSamples * trace.period_s,
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

nc::Interpretation moves_of(const TracedProgram& traced, const machine::Machine& start, Diagnostics& diagnostics) {
  const kinematics::ReadingOptions options{.given = traced.interpreter, .rotary = kinematics::RotaryWords::always};
  const auto read = [&](const nc::Program& text) {
    nc::Interpretation moves = kinematics::read_moves(text, start, options, diagnostics);
    if (diagnostics.errors() == 0 && kinematics::has_rotary_motion(moves, start)) {
      kinematics::check_offsets(text, moves, kinematics::Asked::joints, diagnostics);
      kinematics::place_moves(moves, start);
    }
    return moves;
  };
  return read(traced.text ? *traced.text
                          : nc::read_program(SourceText::read(traced.program),
                                             nc::language_asked_for(traced.interpreter), diagnostics));
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
  const auto timed = calib::placed_stretches(run.trace, run.program, *placed, kPieceSamples * run.trace.period_s);
  if (timed.empty())
    fail_on_file(run.trace.path,
                 fmt::format("holds no piece of feed motion of {:.3g} s, which samples {:.3g} s apart need",
                             kPieceSamples * run.trace.period_s, run.trace.period_s),
                 "log-stretches");
  calib::StretchRun& stretches = stretch_run(runs, name, run.program);
  stretches.timed.insert(stretches.timed.end(), timed.begin(), timed.end());
  runs.servo.pop_back();
}

/// JSON has no infinity.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json error_json(const calib::FitError& e) {
  return {{"parts", e.parts},
          {"part_time_percent", e.part_time_percent},
          {"speed_rms_percent", e.speed_rms_percent},
          {"speed_p95_percent", e.speed_p95_percent}};
}

constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};

template <std::size_t n>
Json residuals_json(const std::array<calib::SpeedResidual, n>& residuals, const std::array<const char*, n>& names) {
  Json list = Json::array();
  for (std::size_t i = 0; i < n; ++i)
    list.push_back(
        {{"where", names[i]}, {"stations", residuals[i].stations}, {"speed_rms_percent", residuals[i].rms_percent}});
  return list;
}

Json parameters_json(const std::vector<calib::FitParameter>& parameters) {
  Json list = Json::array();
  for (const calib::FitParameter& p : parameters)
    list.push_back({{"name", p.name},
                    {"value", number(p.value)},
                    {"unit", p.unit},
                    {"std_error", p.std_error ? number(*p.std_error) : Json(nullptr)},
                    {"written", p.written},
                    {"stretches", p.stretches},
                    {"changed_from", p.changed_from ? number(*p.changed_from) : Json(nullptr)},
                    {"note", p.note}});
  return list;
}

Json errors_json(const calib::StretchErrors& e) {
  return {{"stretch_time_mean_percent", e.mean},
          {"stretch_time_p90_percent", e.p90},
          {"stretch_time_worst_percent", e.worst},
          {"total_time_percent", e.total}};
}

Json report_of(const calib::StretchFit& fit) {
  Json report;
  report["parameters"] = parameters_json(fit.parameters);
  report["held_out"] = errors_json(fit.held_out);
  report["held_out"]["stretches"] = fit.stretches.size();
  report["fitted"] = errors_json(fit.fitted);
  report["baselines"] = {{"constant_feed", errors_json(fit.constant_feed)},
                         {"stop_at_every_block", errors_json(fit.stop_every_block)}};
  for (const calib::JudgedLaw& law : fit.laws)
    report["laws"].push_back({{"name", law.law.name},
                              {"held_out", errors_json(law.held_out)},
                              {"kind_held_out", errors_json(law.kind_held_out)}});
  for (const calib::JudgedStretch& s : fit.stretches)
    report["stretches"].push_back({{"program", s.program_name},
                                   {"line_first", s.timed.stretch.line_first},
                                   {"line_last", s.timed.stretch.line_last},
                                   {"tool", s.timed.stretch.tool},
                                   {"time_s", s.timed.time_s},
                                   {"held_out_s", s.held_out_s},
                                   {"kind", name_of(s.kind)},
                                   {"kind_held_out_s", s.kind_held_out_s},
                                   {"fitted_s", s.fitted_s},
                                   {"constant_feed_s", s.constant_feed_s},
                                   {"stop_every_block_s", s.stop_every_block_s}});
  report["converged"] = fit.converged;
  report["message"] = fit.message;
  return report;
}

Json report_of(const FitFeedResult& result) {
  Json report;
  report["parameters"] = parameters_json(result.parameters);
  report["held_out"] = error_json(result.held_out);
  if (result.promise)
    report["held_out"]["next_program_time_percent"] = {result.promise->low_percent, result.promise->high_percent};
  report["fitted"] = error_json(result.fitted);
  for (int i = 0; i < 3; ++i)
    report["drives"].push_back({{"axis", std::string(1, "xyz"[i])},
                                {"moved", result.drives[i].moved},
                                {"model", result.drives[i].model},
                                {"fitted_rms_mm", result.drives[i].fitted_rms_mm},
                                {"held_out_rms_mm", result.drives[i].held_out_rms_mm}});
  for (const char letter : result.machine.kinematics.rotary_axes()) {
    const calib::DriveFit& drive = result.rotary_drives[static_cast<std::size_t>(letter - 'a')];
    report["drives"].push_back({{"axis", std::string(1, letter)},
                                {"moved", drive.moved},
                                {"model", drive.model},
                                {"fitted_rms_deg", drive.fitted_rms_mm},
                                {"held_out_rms_deg", drive.held_out_rms_mm}});
  }
  for (const calib::RunAccuracy& run : result.runs)
    report["runs"].push_back({{"program", run.program_name},
                              {"time_trace_s", run.accuracy.time_trace_s},
                              {"time_model_s", run.accuracy.time_model_s},
                              {"time_error_percent", run.accuracy.time_error_percent},
                              {"speed_rms_percent", run.accuracy.speed_rms_percent},
                              {"speed_p95_percent", run.accuracy.speed_p95_percent},
                              {"by_place", residuals_json(run.accuracy.by_state, calib::kPathStates)},
                              {"by_axis", residuals_json(run.accuracy.by_axis, kAxisNames)}});
  for (const calib::LoggedTime& t : result.logged)
    report["logged"].push_back({{"program", t.program_name},
                                {"line_first", t.part.line_first},
                                {"line_last", t.part.line_last},
                                {"held_out", t.kept_back},
                                {"time_s", t.time_s},
                                {"model_s", t.model_s}});
  if (!result.logged.empty()) {
    report["fitted"]["logged_time_percent"] = result.logged_fitted.mean;
    report["held_out"]["logged_time_percent"] = result.logged_held_out.mean;
  }
  for (const calib::JudgedCornerLaw& law : result.laws)
    report["laws"].push_back(
        {{"name", law.name}, {"held_out", {{"part_time_percent", law.held_out_percent}, {"cost", law.held_out_cost}}}});
  report["law"] = result.law;
  report["residual_median_ms"] = result.residual_median_ms;
  report["converged"] = result.converged;
  report["message"] = result.message;
  return report;
}

}  // namespace

bool FeedRuns::any_lines() const {
  return std::any_of(servo.begin(), servo.end(), [](const calib::FeedRun& run) { return !run.trace.line.empty(); });
}

FeedRuns read_runs(std::span<const TracedProgram> traced, const std::string& columns, const machine::Machine& start,
                   Diagnostics& diagnostics) {
  std::optional<calib::ColumnMap> map;
  if (!columns.empty()) map = calib::read_column_map(columns, diagnostics);
  FeedRuns runs;
  for (const TracedProgram& one : traced) {
    nc::Interpretation moves = moves_of(one, start, diagnostics);
    diagnostics.throw_if_errors();
    const TraceKind kind = kind_of(one.trace);
    if (kind == TraceKind::servo) {
      auto trace =
          map ? calib::read_mapped_trace(one.trace, *map, diagnostics) : calib::read_trace(one.trace, diagnostics);
      add_trace(runs, one.program, std::move(moves), std::move(trace), start, diagnostics);
    } else {
      add_times(stretch_run(runs, one.program, moves), one.trace, kind, diagnostics);
    }
  }
  return runs;
}

FeedFit fit_runs(const FeedRuns& runs, const machine::Machine& start, const calib::FitFeedOptions& options) {
  if (runs.stretches.empty() || runs.any_lines()) return calib::fit_feed(runs.servo, runs.stretches, start, options);
  calib::StretchFit fit = calib::fit_stretches(runs.stretches, start, {});
  std::vector<const calib::ServoTrace*> traces;
  for (const calib::FeedRun& run : runs.servo) traces.push_back(&run.trace);
  for (int axis = 0; axis < 3 && !traces.empty(); ++axis)
    calib::add_drive(fit.machine, fit.parameters, axis, calib::fit_drive(traces, axis, {}));
  return fit;
}

std::string fit_json(const FeedFit& fit) {
  return std::visit([](const auto& result) { return report_of(result); }, fit).dump(2) + "\n";
}

}  // namespace camber::api
