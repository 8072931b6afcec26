// camber feed P.nc --machine M.toml [-o feed.csv] [--report R.html] [--json R.json]
#include "camber/feed.h"

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

struct FeedArguments {
  std::string program, machine;
  std::string json;    ///< empty: none
  std::string report;  ///< page of a machine with rotary axes; empty: none
  FeedOptions options{};
  ReadOptions read{};
};

/// Throws InputError. Returns kDone.
int run_feed(const FeedArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  FeedOptions asked = arguments.options;
  asked.points = false;
  asked.page = !arguments.report.empty();
  const Machine machine = read_machine(arguments.machine);
  const FeedResult result =
      feed(read_program(arguments.program, arguments.read), machine, asked, run_options(progress, options));
  print_translation(machine.translation(), options);
  if (!options.quiet) fmt::print("{}", result.printed);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (!arguments.report.empty()) write_file(arguments.report, result.page);
  return kDone;
}

}  // namespace

void add_feed_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("feed", "predict the actual feed along a program, and its time");
  auto arguments = std::make_shared<FeedArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("--machine", arguments->machine, "machine.toml")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->options.csv, "axis positions at every period")->type_name("feed.csv");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->add_option("--report", arguments->report, "page of a machine with rotary axes as it runs the program")
      ->type_name("R.html");
  add_tool_lengths(*command, arguments->read);
  add_work_offsets(*command, arguments->read);
  add_reading_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->options.csv, arguments->json, arguments->report},
                    {arguments->program, arguments->machine});
      return run_feed(*arguments, options);
    };
  });
}

}  // namespace camber::cli
