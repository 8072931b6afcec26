// camber protocol: programs to run on a machine so that fit-feed has what it needs.
#include "camber/protocol.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "machine/machine_presets.h"

namespace camber::cli {
namespace {

struct ProtocolArguments {
  std::string machine;
  std::string folder;
  ProtocolOptions options{};
};

/// The machine file as it lies from the folder.
std::string machine_from(const std::string& folder, const std::string& machine) {
  if (machine::is_preset(machine)) return machine;
  return std::filesystem::relative(machine, folder).generic_string();
}

/// Writes the programs, a .parts.csv beside each, and prints the purpose of each; of a test piece its program, job and
/// table of measured values. Throws InputError.
int run_protocol(const ProtocolArguments& arguments, const GlobalOptions& options) {
  const Machine machine = read_machine(arguments.machine);
  settle(machine.diagnostics(), options);
  make_folder(arguments.folder);
  ProtocolOptions asked = arguments.options;
  asked.machine_name = machine_from(arguments.folder, arguments.machine);
  for (const ProtocolFile& file : protocol(machine, asked)) {
    write_file(std::filesystem::path(arguments.folder) / file.name, file.text);
    if (!options.quiet) fmt::print("{}", file.printed);
  }
  if (options.quiet) return kDone;
  if (asked.part)
    fmt::print("Cut it, measure its features, fill in measured.csv; then camber fit-parts {}/job.toml -o fitted\n",
               arguments.folder);
  else
    fmt::print(
        "Run them without a workpiece and with the origin in free space. Record commanded and actual axis positions "
        "with the line of the program.\n");
  return kDone;
}

}  // namespace

void add_protocol_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("protocol", "write programs that provide fit-feed with the data it needs");
  auto arguments = std::make_shared<ProtocolArguments>();
  command->add_option("--machine", arguments->machine, "machine.toml")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->folder, "folder for the programs")->required()->type_name("DIR");
  auto* part = command->add_flag("--part", arguments->options.part, "a test piece to cut and measure, for fit-parts");
  command->add_option("--diameter-mm", arguments->options.diameter_mm, "of its end mill")
      ->check(CLI::Range(1.0, 50.0))
      ->type_name("D")
      ->needs(part);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_output_folder(arguments->folder);
      return run_protocol(*arguments, options);
    };
  });
}

}  // namespace camber::cli
