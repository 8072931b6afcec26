// camber post: programs with rotary axes between tool-centre-point control and joint coordinates.
#include "camber/post.h"

#include <cstdint>
#include <map>
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

struct PostArguments {
  std::string program;
  std::string machine, job;  ///< one of them
  std::string json;          ///< empty: none
  PostOptions options{};
  ReadOptions read{};
};

/// Throws InputError. Returns kDone.
int run_post(const PostArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  const RunOptions run = run_options(progress, options);
  PostResult result;
  if (arguments.job.empty()) {
    const Machine machine = read_machine(arguments.machine);
    result = post(read_program(arguments.program, arguments.read), machine, arguments.options, run);
  } else {
    const Job job = read_job(arguments.job);
    result = post(read_program(arguments.program, arguments.read), job, arguments.options, run);
  }
  write_file(arguments.options.output, result.text);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (!options.quiet) fmt::print("{}", result.printed);
  return kDone;
}

enum class To : std::uint8_t { joints, tcp };

void add_post_rules(CLI::App& command, PostOptions& options) {
  command
      .add_option_function<To>(
          "--to", [&options](const To& to) { options.to_tip = to == To::tcp; },
          "joints: X Y Z of the linear axes (default); tcp: the tip")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, To>{{"joints", To::joints}, {"tcp", To::tcp}}).description(""))
      ->type_name("joints|tcp");
  command
      .add_option("--tolerance-mm", options.tolerance_mm,
                  "maximum deviation of the tip in feed moves, rounding included; default 0.005")
      ->check(number_from_to(1e-5, 10))
      ->type_name("X");
  command
      .add_option("--rapid-tolerance-mm", options.rapid_tolerance_mm,
                  "the same in rapids and where axes turn back; default 0.1")
      ->check(number_from_to(1e-5, 1000))
      ->type_name("X");
  command
      .add_option_function<std::string>(
          "--rule", [&options](const std::string& rule) { options.one_degree = rule == "one-degree"; },
          "divide blocks by the tolerance (default), or so that no axis turns by a degree or more")
      ->check(CLI::IsMember({"tolerance", "one-degree"}).description(""))
      ->type_name("tolerance|one-degree");
  command.add_flag("--inverse-time", options.inverse_time,
                   "G93: F of each rewritten feed block is 1/min; not in Klartext");
  command
      .add_option("--retract-mm", options.retract_mm,
                  "how far the tool goes off along its axis where axes turn back; default 50")
      ->check(number_from_to(0, 1000))
      ->type_name("L");
  command
      .add_option_function<int>(
          "--decimals", [&options](const int& n) { options.decimals = n; },
          "of lengths and angles in rewritten blocks; default: as the program's coordinates, at least 4")
      ->check(CLI::Range(1, 8).description(""))
      ->type_name("N");
}

}  // namespace

void add_post_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command =
      app.add_subcommand("post", "rewrite a program with rotary axes in joint coordinates, or back to the tool's tip");
  auto arguments = std::make_shared<PostArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("-o,--output", arguments->options.output, "the new program")->required()->type_name("OUT.nc");
  auto* machine = command->add_option("--machine", arguments->machine, "machine.toml with [kinematics]");
  machine->type_name("M.toml");
  command->add_option("--job", arguments->job, "job.toml: its machine, and collisions of its tools with [[body]]")
      ->type_name("J.toml")
      ->excludes(machine);
  add_post_rules(*command, arguments->options);
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  add_tool_lengths(*command, arguments->read);
  add_work_offsets(*command, arguments->read);
  add_reading_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    if (arguments->machine.empty() && arguments->job.empty()) throw CLI::RequiredError("--machine or --job");
    chosen = [arguments, &options] {
      if (options.effective_config && !arguments->machine.empty())
        return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->options.output, arguments->json},
                    {arguments->program, arguments->machine, arguments->job});
      return run_post(*arguments, options);
    };
  });
}

}  // namespace camber::cli
