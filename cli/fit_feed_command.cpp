#include "cli/fit_feed_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/output_file.h"
#include "base/units.h"
#include "calib/block_time.h"
#include "calib/column_map.h"
#include "calib/cross_validate.h"
#include "calib/fit_feed.h"
#include "calib/fit_stretches.h"
#include "calib/machine_log.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "feedmodel/control_options.h"
#include "machine/machine.h"
#include "nc/program.h"
#include "report/block_time_plot.h"

namespace camber::cli {
namespace {

using calib::FitFeedResult;
using nlohmann::ordered_json;

/// What a trace file holds is told by its content.
enum class TraceKind { servo, machine_log, stretch_table };

TraceKind kind_of(const std::string& path) {
  if (calib::is_machine_log(path)) return TraceKind::machine_log;
  return calib::is_stretch_table(path) ? TraceKind::stretch_table : TraceKind::servo;
}

struct Runs {
  std::vector<calib::FeedRun> servo;
  std::vector<calib::StretchRun> stretches;  ///< one for each program; empty where all traces are servo traces

  /// Whether a servo trace tells which line it commands, so that the limits can be fitted block by block.
  bool any_lines() const {
    return std::any_of(servo.begin(), servo.end(), [](const calib::FeedRun& run) { return !run.trace.line.empty(); });
  }
};

/// The stretches of one program belong together, however many logs tell of it: copies of a geometry must not be in
/// two folds.
calib::StretchRun& stretch_run(Runs& runs, const std::string& name, const nc::Interpretation& program) {
  for (calib::StretchRun& run : runs.stretches)
    if (run.program_name == name) return run;
  runs.stretches.push_back({name, program, {}});
  return runs.stretches.back();
}

void add_times(calib::StretchRun& run, const std::string& path, TraceKind kind, Diagnostics& diagnostics) {
  const auto timed =
      kind == TraceKind::machine_log
          ? calib::logged_stretches(calib::read_machine_log(path, diagnostics), calib::feed_stretches(run.program))
          : calib::read_stretch_table(path, run.program);
  if (timed.empty())
    fail_on_file(path, "holds no whole stretch of feed moves of the program at 100 % override", "log-stretches");
  run.timed.insert(run.timed.end(), timed.begin(), timed.end());
}

Runs read_runs(const FitFeedArguments& arguments, const machine::Machine& start, Diagnostics& diagnostics) {
  if (arguments.programs.size() != arguments.traces.size() || arguments.programs.empty())
    fail_on_file(arguments.machine,
                 fmt::format("{} programs and {} traces are given; each --program needs its --trace",
                             arguments.programs.size(), arguments.traces.size()),
                 "fit-runs");
  std::optional<calib::ColumnMap> columns;
  if (!arguments.columns.empty()) columns = calib::read_column_map(arguments.columns, diagnostics);
  Runs runs;
  for (std::size_t i = 0; i < arguments.programs.size(); ++i) {
    const nc::Program program = nc::read_program(SourceText::read(arguments.programs[i]), diagnostics);
    nc::Interpretation moves =
        nc::interpret(program, feedmodel::interpreter_options(start, arguments.interpreter), diagnostics);
    diagnostics.throw_if_errors();
    const TraceKind kind = kind_of(arguments.traces[i]);
    if (kind == TraceKind::servo) {
      auto trace = columns ? calib::read_mapped_trace(arguments.traces[i], *columns, diagnostics)
                           : calib::read_trace(arguments.traces[i], diagnostics);
      runs.servo.push_back({arguments.programs[i], std::move(moves), std::move(trace)});
    } else {
      add_times(stretch_run(runs, arguments.programs[i], moves), arguments.traces[i], kind, diagnostics);
    }
  }
  return runs;
}

double percent(double value, double reference) { return 100 * (value / reference - 1); }

void print_parameters(const std::vector<calib::FitParameter>& parameters) {
  fmt::print("{:<44} {:>14} {:<7} {:>12}\n", "parameter", "value", "unit", "std error");
  for (const calib::FitParameter& p : parameters)
    fmt::print("{:<44} {:>14.6g} {:<7} {:>12}  {}\n", p.name, p.value, p.unit,
               p.std_error ? fmt::format("{:.2g}", *p.std_error) : "-", p.note);
}

void print_laws(const FitFeedResult& result) {
  fmt::print("{:<52} {:>10} {:>10}\n", "corner law, parts kept back", "time, %", "cost");
  for (const calib::JudgedCornerLaw& law : result.laws)
    fmt::print("{:<52} {:>10.3f} {:>10.3f}\n", law.name, law.held_out_percent, law.held_out_cost);
  fmt::print("taken: {}\n\n", result.law);
}

/// Stretches of the logs: over all, and those that are off by the most.
void print_logged(const FitFeedResult& result) {
  if (result.logged.empty()) return;
  const auto line = [](const char* name, const calib::LoggedError& e) {
    fmt::print("{:<9} {:>4} logged stretches: time {:.2f} % mean, {:.2f} % worst\n", name, e.stretches, e.mean,
               e.worst);
  };
  line("fitted", result.logged_fitted);
  line("held out", result.logged_held_out);
  constexpr std::size_t kShown = 5;
  std::vector<calib::LoggedTime> worst = result.logged;
  std::ranges::stable_sort(worst, std::greater<>(),
                           [](const calib::LoggedTime& t) { return std::abs(t.model_s - t.time_s) / t.time_s; });
  for (std::size_t i = 0; i < std::min(kShown, worst.size()); ++i)
    fmt::print("  {}: lines {}-{}: {:.3f} s logged, {:.3f} s predicted ({:+.2f} %){}\n", worst[i].program_name,
               worst[i].part.line_first, worst[i].part.line_last, worst[i].time_s, worst[i].model_s,
               percent(worst[i].model_s, worst[i].time_s), worst[i].kept_back ? ", held out" : "");
}

void print(const FitFeedResult& result) {
  print_laws(result);
  print_parameters(result.parameters);
  constexpr const char* kAxes = "xyz";
  for (int i = 0; i < 3; ++i) {
    const calib::DriveFit& drive = result.drives[i];
    if (!drive.moved) continue;
    fmt::print("axis {}: {}; position rms {:.3f} um fitted, {:.3f} um held out\n", kAxes[i], drive.model,
               1000 * drive.fitted_rms_mm, 1000 * drive.held_out_rms_mm);
  }
  const auto line = [&](const char* name, const calib::FitError& e) {
    fmt::print("{:<9} {:>4} parts: time {:.2f} % mean, path speed rms {:.2f} %, p95 {:.2f} % of the feed\n", name,
               e.parts, e.part_time_percent, e.speed_rms_percent, e.speed_p95_percent);
  };
  line("fitted", result.fitted);
  line("held out", result.held_out);
  for (const calib::RunAccuracy& run : result.runs)
    fmt::print("{}: {:.2f} s traced, {:.2f} s predicted ({:+.2f} %), path speed rms {:.2f} %, p95 {:.2f} %\n",
               run.program_name, run.accuracy.time_trace_s, run.accuracy.time_model_s, run.accuracy.time_error_percent,
               run.accuracy.speed_rms_percent, run.accuracy.speed_p95_percent);
  print_logged(result);
  fmt::print("residual of the parts' times: median {:.2f} ms; {}\n", result.residual_median_ms, result.message);
}

/// JSON has no infinity.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

ordered_json error_json(const calib::FitError& e) {
  return {{"parts", e.parts},
          {"part_time_percent", e.part_time_percent},
          {"speed_rms_percent", e.speed_rms_percent},
          {"speed_p95_percent", e.speed_p95_percent}};
}

ordered_json parameters_json(const std::vector<calib::FitParameter>& parameters) {
  ordered_json list = ordered_json::array();
  for (const calib::FitParameter& p : parameters)
    list.push_back({{"name", p.name},
                    {"value", number(p.value)},
                    {"unit", p.unit},
                    {"std_error", p.std_error ? number(*p.std_error) : ordered_json(nullptr)},
                    {"written", p.written},
                    {"note", p.note}});
  return list;
}

void print(const calib::StretchFit& fit) {
  print_parameters(fit.parameters);
  const auto line = [](const std::string& name, const calib::StretchErrors& e) {
    fmt::print("{:<76} {:>7.2f} {:>7.2f} {:>7.2f} {:>+7.2f}\n", name, e.mean, e.p90, e.worst, e.total);
  };
  fmt::print("\n{:<76} {:>7} {:>7} {:>7} {:>7}\n",
             fmt::format("error of the stretch times, % ({} geometries, {} folds)", fit.stretches.size(), fit.folds),
             "mean", "p90", "worst", "total");
  for (const calib::JudgedLaw& law : fit.laws) {
    line("held out: " + law.law.name, law.held_out);
    line("  each kind of motion by a fit on the others", law.kind_held_out);
  }
  if (!fit.laws.empty()) {
    line("chosen, held out: " + fit.laws[fit.chosen].law.name, fit.held_out);
    line("chosen, each kind of motion by a fit on the others", fit.laws[fit.chosen].kind_held_out);
    line("chosen, fitted to all", fit.fitted);
  }
  line("constant feed", fit.constant_feed);
  line("stop at every block", fit.stop_every_block);
  fmt::print("\n{:<16} {:>4} {:>8} {:>10} {:>9} {:>9} {:>9} {:>10} {:>10}   %\n", "lines", "tool", "kind", "machine, s",
             "held out", "by kind", "fitted", "const feed", "stop each");
  for (const calib::JudgedStretch& s : fit.stretches) {
    const auto& t = s.timed;
    fmt::print("{:<16} {:>4} {:>8} {:>10.3f} {:>+9.2f} {:>+9.2f} {:>+9.2f} {:>+10.2f} {:>+10.2f}\n",
               fmt::format("{}-{}", t.stretch.line_first, t.stretch.line_last), t.stretch.tool, name_of(s.kind),
               t.time_s, percent(s.held_out_s, t.time_s), percent(s.kind_held_out_s, t.time_s),
               percent(s.fitted_s, t.time_s), percent(s.constant_feed_s, t.time_s),
               percent(s.stop_every_block_s, t.time_s));
  }
  for (const auto& gap : fit.unseen_corners_rad)
    fmt::print("no corner between {:.1f} and {:.1f} degrees was seen; camber protocol writes programs that have them\n",
               deg_from_rad(gap[0]), deg_from_rad(gap[1]));
  fmt::print("{}\n", fit.message);
}

ordered_json errors_json(const calib::StretchErrors& e) {
  return {{"stretch_time_mean_percent", e.mean},
          {"stretch_time_p90_percent", e.p90},
          {"stretch_time_worst_percent", e.worst},
          {"total_time_percent", e.total}};
}

ordered_json report_of(const calib::StretchFit& fit) {
  ordered_json report;
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

ordered_json report_of(const FitFeedResult& result) {
  ordered_json report;
  report["parameters"] = parameters_json(result.parameters);
  report["held_out"] = error_json(result.held_out);
  report["fitted"] = error_json(result.fitted);
  for (int i = 0; i < 3; ++i)
    report["drives"].push_back({{"axis", std::string(1, "xyz"[i])},
                                {"moved", result.drives[i].moved},
                                {"model", result.drives[i].model},
                                {"fitted_rms_mm", result.drives[i].fitted_rms_mm},
                                {"held_out_rms_mm", result.drives[i].held_out_rms_mm}});
  for (const calib::RunAccuracy& run : result.runs)
    report["runs"].push_back({{"program", run.program_name},
                              {"time_trace_s", run.accuracy.time_trace_s},
                              {"time_model_s", run.accuracy.time_model_s},
                              {"time_error_percent", run.accuracy.time_error_percent},
                              {"speed_rms_percent", run.accuracy.speed_rms_percent},
                              {"speed_p95_percent", run.accuracy.speed_p95_percent}});
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

/// Writes the machine and the report, prints, and tells how it went.
template <class Result>
int finish(const Result& result, const machine::Machine& fitted, const FitFeedArguments& arguments,
           const GlobalOptions& options) {
  if (!options.quiet) print(result);
  write_file(arguments.output, machine::to_toml(fitted));
  if (!arguments.json.empty()) write_file(arguments.json, report_of(result).dump(2) + "\n");
  if (!result.converged) print_error(result.message);
  return result.converged ? kDone : kNumbersDidNotWorkOut;
}

void print(const std::vector<calib::HeldOutRun>& runs) {
  fmt::print(
      "\nleave one trace out: every trace predicted by a fit on the others\n{:<34} {:>7} {:>6} {:>6} {:>6} {:>11} "
      "{:>7} {:>7}\n",
      "", "total %", "part %", "p90 %", "worst", "over 0.5 %", "rms %", "p95 %");
  const auto line = [](const std::string& name, const calib::FeedAccuracy& a) {
    const calib::PartTimes t = calib::part_times(a);
    fmt::print("{:<34} {:>+7.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>4} of {:>4} {:>7.2f} {:>7.2f}\n", name,
               a.time_error_percent, t.mean, t.p90, t.worst, t.over, t.parts, a.speed_rms_percent, a.speed_p95_percent);
  };
  for (const calib::HeldOutRun& run : runs) {
    const std::size_t slash = run.program_name.find_last_of('/');
    line(slash == std::string::npos ? run.program_name : run.program_name.substr(slash + 1), run.accuracy);
    line("  constant feed", run.constant_feed);
    line("  stop at every block", run.stop_every_block);
    fmt::print("  drives alone: x {:.3f}, y {:.3f}, z {:.3f} um rms\n", 1000 * run.drive_rms_mm[0],
               1000 * run.drive_rms_mm[1], 1000 * run.drive_rms_mm[2]);
  }
}

void plot_block_time(const Runs& runs, const FitFeedArguments& arguments, const GlobalOptions& options) {
  std::vector<std::pair<const nc::Interpretation*, const calib::ServoTrace*>> traced;
  for (const calib::FeedRun& run : runs.servo) traced.emplace_back(&run.program, &run.trace);
  const calib::BlockTimeFit fit = calib::fit_block_time(traced);
  write_file(arguments.block_time_plot, report::block_time_svg(fit));
  if (options.quiet) return;
  for (const calib::ChordRun& r : fit.runs)
    if (r.saturated)
      fmt::print("lines {}-{}: {:.4g} mm at F{:.0f}: {:.0f} mm/min, {:.4g} ms a block\n", r.line_first, r.line_last,
                 r.chord_mm, mm_per_min_from_mm_per_s(r.feed_mm_per_s), mm_per_min_from_mm_per_s(r.speed_mm_per_s),
                 1000 * r.block_time_s);
  fmt::print("{}\n", fit.message);
}

/// Times of stretches; the drives from the servo traces without lines, where some are given beside them.
int fit_to_times(const Runs& runs, const machine::Machine& start, const FitFeedArguments& arguments,
                 const GlobalOptions& options) {
  calib::StretchFit fit = calib::fit_stretches(runs.stretches, start, {});
  std::vector<const calib::ServoTrace*> traces;
  for (const calib::FeedRun& run : runs.servo) traces.push_back(&run.trace);
  for (int axis = 0; axis < 3 && !traces.empty(); ++axis)
    calib::add_drive(fit.machine, fit.parameters, axis, calib::fit_drive(traces, axis, {}));
  return finish(fit, fit.machine, arguments, options);
}

}  // namespace

int run_fit_feed(const FitFeedArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Machine start = machine::read_machine(arguments.machine, diagnostics);
  const Runs runs = read_runs(arguments, start, diagnostics);
  settle(diagnostics, options);
  print_translation(start.translation, options);
  if (!arguments.block_time_plot.empty()) plot_block_time(runs, arguments, options);
  if (!runs.stretches.empty() && !runs.any_lines()) return fit_to_times(runs, start, arguments, options);
  ProgressLine progress(options, "fitting");
  const FitFeedResult result = calib::fit_feed(runs.servo, runs.stretches, start, {});
  progress.clear();
  const int status = finish(result, result.machine, arguments, options);
  if (!arguments.leave_one_out) return status;
  progress.show("leaving out one after the other");
  const auto left_out = calib::leave_one_out(runs.servo, start, {}, runs.stretches);
  progress.clear();
  print(left_out);
  return status;
}

}  // namespace camber::cli
