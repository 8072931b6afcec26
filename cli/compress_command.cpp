// camber compress: many G1 to few G1, G2 and G3 within a tolerance.
#include "camber/compress.h"

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct CompressArguments {
  std::string program;
  std::string machine;  ///< empty: no times
  std::string json;     ///< empty: none
  std::string report;   ///< the page; empty: none
  CompressOptions options{};
  ReadOptions read{};
};

/// Throws InputError. Returns kDone.
int run_compress(const CompressArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "compressing");
  const RunOptions run = run_options(progress, options);
  CompressOptions asked = arguments.options;
  asked.json = !arguments.json.empty();
  asked.page = !arguments.report.empty();
  CompressResult result;
  if (arguments.machine.empty()) {
    result = compress(read_program(arguments.program, arguments.read), asked, run);
  } else {
    const Machine machine = read_machine(arguments.machine);
    result = compress(read_program(arguments.program, arguments.read), machine, asked, run);
  }
  write_file(asked.output, result.program);
  if (asked.json) write_file(arguments.json, result.json);
  if (asked.page) write_file(arguments.report, result.page);
  if (!options.quiet) fmt::print("{}", result.printed);
  return kDone;
}

void add_feeds_by_kind(CLI::App& command, CompressOptions& options, CLI::Option* lines_only) {
  auto* line =
      command
          .add_option("--line-feed-mm-per-min", options.line_feed_mm_per_min,
                      "feed that the control reaches on lines, if it runs arcs faster: minimize time instead of blocks")
          ->check(number_from_to(0.1, 1e6))
          ->excludes(lines_only)
          ->type_name("V");
  auto* arc = command.add_option("--arc-feed-mm-per-min", options.arc_feed_mm_per_min, "feed that it reaches on arcs")
                  ->check(number_from_to(0.1, 1e6))
                  ->needs(line)
                  ->type_name("W");
  line->needs(arc);
  command.add_option("--block-s", options.block_s, "additional time per block; default 0.005")
      ->check(number_from_to(0, 10))
      ->needs(line)
      ->type_name("S");
}

}  // namespace

void add_compress_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("compress", "replace many G1 by few G1, G2 and G3 within a tolerance");
  auto arguments = std::make_shared<CompressArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  add_rewriting(*command, arguments->options.tolerance_mm, arguments->options.output, arguments->report);
  command->add_option("--machine", arguments->machine, "machine.toml: also predict the times before and after")
      ->type_name("M.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* lines_only = command->add_flag("--lines-only", arguments->options.lines_only, "no arcs");
  command
      ->add_option(
          "--tangent-deg", arguments->options.tangent_deg,
          "maximum kink between an arc and its neighbour where the program is smooth; default 1; 180: any kink")
      ->check(number_from_to(0.05, 180))
      ->type_name("A");
  command
      ->add_flag("--helices", arguments->options.helices, "also use helical arcs where the path is three-dimensional")
      ->excludes(lines_only);
  add_feeds_by_kind(*command, arguments->options, lines_only);
  command->add_flag("--switch-planes", arguments->options.switch_planes,
                    "also use arcs in other planes than the program's, with G17 G18 G19 around them");
  add_reading_options(*command, arguments->read);
  add_language_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    if (arguments->options.line_feed_mm_per_min &&
        *arguments->options.arc_feed_mm_per_min <= *arguments->options.line_feed_mm_per_min)
      throw CLI::ValidationError("--arc-feed-mm-per-min", fmt::format("{:g}: more than --line-feed-mm-per-min {:g} was "
                                                                      "expected",
                                                                      *arguments->options.arc_feed_mm_per_min,
                                                                      *arguments->options.line_feed_mm_per_min));
    chosen = [arguments, &options] {
      if (options.effective_config && !arguments->machine.empty())
        return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->options.output, arguments->json, arguments->report},
                    {arguments->program, arguments->machine});
      return run_compress(*arguments, options);
    };
  });
}

}  // namespace camber::cli
