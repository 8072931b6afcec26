#include "cli/protocol_command.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/output_file.h"
#include "calib/protocol.h"
#include "cli/console.h"

#include "machine/machine.h"

namespace camber::cli {

int run_protocol(const ProtocolArguments& arguments, const GlobalOptions& options) {
  namespace fs = std::filesystem;
  Diagnostics diagnostics;
  const machine::Machine machine = machine::read_machine(arguments.machine, diagnostics);
  settle(diagnostics, options);
  make_folder(arguments.folder);
  for (const calib::ProtocolProgram& program : calib::protocol_programs(machine)) {
    write_file(fs::path(arguments.folder) / program.name, program.text);
    if (!program.parts.empty())
      write_file(fs::path(arguments.folder) / fs::path(program.name).replace_extension(".parts.csv"),
                 calib::parts_csv(program));
    if (!options.quiet) fmt::print("{:<18} {:>4} parts: {}\n", program.name, program.parts.size(), program.tells);
  }
  if (!options.quiet)
    fmt::print(
        "Run them without a workpiece and with the origin in free space. Record commanded and actual axis positions "
        "with the line of the program.\n");
  return kDone;
}

}  // namespace camber::cli
