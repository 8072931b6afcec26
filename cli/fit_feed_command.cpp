#include "cli/fit_feed_command.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/output_file.h"
#include "calib/fit_feed.h"
#include "cli/console.h"
#include "machine/machine.h"
#include "nc/program.h"

namespace camber::cli {
namespace {

using calib::FitFeedResult;
using nlohmann::ordered_json;

std::vector<calib::FeedRun> read_runs(const FitFeedArguments& arguments, Diagnostics& diagnostics) {
  if (arguments.programs.size() != arguments.traces.size() || arguments.programs.empty())
    fail_on_file(arguments.machine,
                 fmt::format("{} programs and {} traces are given; each --program needs its --trace",
                             arguments.programs.size(), arguments.traces.size()),
                 "fit-runs");
  std::vector<calib::FeedRun> runs;
  for (std::size_t i = 0; i < arguments.programs.size(); ++i) {
    const nc::Program program = nc::read_program(SourceText::read(arguments.programs[i]), diagnostics);
    calib::FeedRun run;
    run.program_name = arguments.programs[i];
    run.program = nc::interpret(program, arguments.interpreter, diagnostics);
    diagnostics.throw_if_errors();
    run.trace = calib::read_trace(arguments.traces[i], diagnostics);
    runs.push_back(std::move(run));
  }
  return runs;
}

void print(const FitFeedResult& result) {
  fmt::print("{:<40} {:>14} {:<7} {:>12}\n", "parameter", "value", "unit", "std error");
  for (const calib::FitParameter& p : result.parameters)
    fmt::print("{:<40} {:>14.6g} {:<7} {:>12}  {}\n", p.name, p.value, p.unit,
               p.std_error ? fmt::format("{:.2g}", *p.std_error) : "-", p.note);
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

ordered_json report_of(const FitFeedResult& result) {
  ordered_json report;
  for (const calib::FitParameter& p : result.parameters)
    report["parameters"].push_back({{"name", p.name},
                                    {"value", number(p.value)},
                                    {"unit", p.unit},
                                    {"std_error", p.std_error ? number(*p.std_error) : ordered_json(nullptr)},
                                    {"written", p.written},
                                    {"note", p.note}});
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
  report["residual_median_ms"] = result.residual_median_ms;
  report["converged"] = result.converged;
  report["message"] = result.message;
  return report;
}

}  // namespace

int run_fit_feed(const FitFeedArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Machine start = machine::read_machine(arguments.machine, diagnostics);
  const std::vector<calib::FeedRun> runs = read_runs(arguments, diagnostics);
  settle(diagnostics, options);
  const FitFeedResult result = calib::fit_feed(runs, start, {});
  if (!options.quiet) print(result);
  write_file(arguments.output, machine::to_toml(result.machine));
  if (!arguments.json.empty()) write_file(arguments.json, report_of(result).dump(2) + "\n");
  if (!result.converged) print_error(result.message);
  return result.converged ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
