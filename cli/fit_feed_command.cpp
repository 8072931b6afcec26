// camber fit-feed: a machine's feed model from traces.
#include "camber/fit_feed.h"

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct FitFeedArguments {
  std::vector<std::string> programs, traces;  ///< pairwise
  std::string machine;
  std::string output;           ///< machine.toml
  std::string json;             ///< empty: none
  std::string block_time_plot;  ///< empty: none
  std::string report;           ///< empty: none
  FitFeedOptions options{};
  ReadOptions read{};
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_fit_feed(const FitFeedArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  FitFeedOptions asked = arguments.options;
  asked.block_time = !arguments.block_time_plot.empty();
  asked.page = !arguments.report.empty();
  const Machine start = read_machine(arguments.machine);
  std::vector<FeedTrace> traces;
  for (std::size_t i = 0; i < arguments.programs.size(); ++i)
    traces.push_back({read_program(arguments.programs[i], arguments.read), arguments.traces[i]});
  const FitFeedResult result = fit_feed(traces, start, asked, run_options(progress, options));
  print_translation(start.translation(), options);
  if (asked.block_time) write_file(arguments.block_time_plot, result.block_time_plot);
  if (!options.quiet) fmt::print("{}", result.printed);
  write_file(arguments.output, result.machine.to_toml());
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (!result.page.empty()) write_file(arguments.report, result.page);
  if (!result.converged) print_error(result.message);
  fmt::print("{}", result.left_out);
  return result.converged ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace

void add_fit_feed_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("fit-feed", "fit a machine's feed model to servo traces");
  auto arguments = std::make_shared<FitFeedArguments>();
  command->add_option("--program", arguments->programs, "a program that was run; once for each trace")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("P.nc");
  command->add_option("--trace", arguments->traces, "servo trace, MTConnect log or table of stretch times of that run")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("T");
  command->add_option("--columns", arguments->options.columns, "column map of servo traces in another format")
      ->type_name("C.toml");
  command->add_option("--machine", arguments->machine, "machine to start from")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->output, "the fitted machine")->required()->type_name("fitted.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command
      ->add_option("--block-time-plot", arguments->block_time_plot, "speed against block length of the saturated runs")
      ->type_name("P.svg");
  command->add_option("--report", arguments->report, "page: measured and modelled speed, residuals, parameters")
      ->type_name("R.html");
  command->add_flag(
      "--update", arguments->options.update,
      "refine the machine file: its corner law stands, its numbers change where the traces determine them");
  command->add_flag("--leave-one-out", arguments->options.leave_one_out,
                    "also predict each servo trace by a fit on the others (one fit per trace)");
  add_tool_lengths(*command, arguments->read);
  add_work_offsets(*command, arguments->read);
  add_reading_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    if (arguments->programs.size() != arguments->traces.size())
      throw CLI::ValidationError("--trace",
                                 fmt::format("{} programs and {} traces; the same number of both was expected",
                                             arguments->programs.size(), arguments->traces.size()));
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      std::vector<std::string> inputs = arguments->programs;  // a machine file may be fitted in its place
      inputs.insert(inputs.end(), arguments->traces.begin(), arguments->traces.end());
      check_outputs({arguments->output, arguments->json, arguments->block_time_plot, arguments->report}, inputs);
      return run_fit_feed(*arguments, options);
    };
  });
}

}  // namespace camber::cli
