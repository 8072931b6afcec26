#include "cli/fit_feed_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "api/commands/fit_feed.h"
#include "base/output_file.h"
#include "base/units.h"
#include "calib/block_time.h"
#include "calib/cross_validate.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/machine.h"
#include "report/block_time_plot.h"
#include "report/fit_feed_page.h"

namespace camber::cli {
namespace {

using calib::FitFeedResult;

double percent(double value, double reference) { return 100 * (value / reference - 1); }

void print_parameters(const std::vector<calib::FitParameter>& parameters) {
  fmt::print("{:<44} {:>14} {:<7} {:>12} {:>5} {:>10}\n", "parameter", "value", "unit", "std error", "from", "before");
  for (const calib::FitParameter& p : parameters)
    fmt::print("{:<44} {:>14.6g} {:<7} {:>12} {:>5} {:>10}  {}\n", p.name, p.value, p.unit,
               p.std_error ? fmt::format("{:.2g}", *p.std_error) : "-",
               p.stretches > 0 ? fmt::format("{}", p.stretches) : "-",
               p.changed_from ? fmt::format("{:.6g}", *p.changed_from) : "-", p.note);
}

void print_laws(const FitFeedResult& result) {
  fmt::print("{:<52} {:>10} {:>10}\n", "corner law, held-out parts", "time, %", "cost");
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
  for (const char letter : result.machine.kinematics.rotary_axes()) {
    const calib::DriveFit& drive = result.rotary_drives[static_cast<std::size_t>(letter - 'a')];
    if (!drive.moved) continue;
    fmt::print("axis {}: {}; position rms {:.6f} degrees fitted, {:.6f} degrees held out\n", letter, drive.model,
               drive.fitted_rms_mm, drive.held_out_rms_mm);
  }
  const auto line = [&](const char* name, const calib::FitError& e) {
    fmt::print("{:<9} {:>4} parts: time {:.2f} % mean, path speed rms {:.2f} %, p95 {:.2f} % of the feed\n", name,
               e.parts, e.part_time_percent, e.speed_rms_percent, e.speed_p95_percent);
  };
  line("fitted", result.fitted);
  line("held out", result.held_out);
  if (result.promise)
    fmt::print("time of a next program like the parts held out: {:+.2f} to {:+.2f} % off in 19 of 20 cases\n",
               result.promise->low_percent, result.promise->high_percent);
  for (const calib::RunAccuracy& run : result.runs)
    fmt::print("{}: {:.2f} s traced, {:.2f} s predicted ({:+.2f} %), path speed rms {:.2f} %, p95 {:.2f} %\n",
               run.program_name, run.accuracy.time_trace_s, run.accuracy.time_model_s, run.accuracy.time_error_percent,
               run.accuracy.speed_rms_percent, run.accuracy.speed_p95_percent);
  print_logged(result);
  fmt::print("residual of part times: median {:.2f} ms; {}\n", result.residual_median_ms, result.message);
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

std::string page_of(const FitFeedResult& result) { return report::fit_feed_page(result); }
std::string page_of(const calib::StretchFit&) { return {}; }

/// Prints, writes the machine, the figures and the page, and says how it went.
int finish(const api::FeedFit& fit, const FitFeedArguments& arguments, const GlobalOptions& options) {
  return std::visit(
      [&](const auto& result) -> int {
        if (!options.quiet) print(result);
        write_file(arguments.output, machine::to_toml(result.machine));
        if (!arguments.json.empty()) write_file(arguments.json, api::fit_json(fit));
        if (const std::string page = page_of(result); !arguments.report.empty() && !page.empty())
          write_file(arguments.report, page);
        if (!result.converged) print_error(result.message);
        return result.converged ? kDone : kNumbersDidNotWorkOut;
      },
      fit);
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
    fmt::print("  drives alone: x {:.3f}, y {:.3f}, z {:.3f} um rms", 1000 * run.drive_rms_mm[0],
               1000 * run.drive_rms_mm[1], 1000 * run.drive_rms_mm[2]);
    for (const auto& [letter, rms_deg] : run.rotary_drive_rms_deg)
      fmt::print(", {} {:.5f} degrees rms", letter, rms_deg);
    fmt::print("\n");
  }
}

void plot_block_time(const api::FeedRuns& runs, const FitFeedArguments& arguments, const GlobalOptions& options) {
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

std::vector<api::TracedProgram> traced_programs(const FitFeedArguments& arguments) {
  std::vector<api::TracedProgram> traced;
  for (std::size_t i = 0; i < arguments.programs.size(); ++i)
    traced.push_back({arguments.programs[i], nullptr, arguments.traces[i], arguments.interpreter});
  return traced;
}

}  // namespace

int run_fit_feed(const FitFeedArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Machine start = machine::read_machine(arguments.machine, diagnostics);
  const api::FeedRuns runs = api::read_runs(traced_programs(arguments), arguments.columns, start, diagnostics);
  settle(diagnostics, options);
  print_translation(start.translation, options);
  if (!arguments.report.empty() && !runs.any_lines())
    fail_on_file(arguments.traces.front(), "has no speeds by line; --report needs a servo trace that names its lines",
                 "fit-report");
  if (!arguments.block_time_plot.empty()) plot_block_time(runs, arguments, options);
  ProgressLine progress(options, "fitting");
  const api::FeedFit fit = api::fit_runs(runs, start, {.update = arguments.update});
  progress.clear();
  const int status = finish(fit, arguments, options);
  if (!arguments.leave_one_out || std::holds_alternative<calib::StretchFit>(fit)) return status;
  progress.show("leave-one-out fits");
  const auto left_out = calib::leave_one_out(runs.servo, start, {}, runs.stretches);
  progress.clear();
  print(left_out);
  return status;
}

}  // namespace camber::cli
