#include "cli/protocol_command.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/output_file.h"
#include "calib/protocol.h"
#include "calib/test_piece.h"
#include "cli/console.h"

#include "machine/machine.h"
#include "machine/machine_presets.h"

namespace camber::cli {

namespace {

/// The machine file as it lies from the folder.
std::string machine_from(const std::string& folder, const std::string& machine) {
  if (machine::is_preset(machine)) return machine;
  return std::filesystem::relative(machine, folder).generic_string();
}

int write_test_piece(const ProtocolArguments& arguments, const GlobalOptions& options) {
  for (const calib::TestPieceFile& file :
       calib::test_piece(machine_from(arguments.folder, arguments.machine), {.diameter_mm = arguments.diameter_mm})) {
    write_file(std::filesystem::path(arguments.folder) / file.name, file.text);
    if (!options.quiet) fmt::print("{:<18} {}\n", file.name, file.tells);
  }
  if (!options.quiet)
    fmt::print("Cut it, measure its features, fill in measured.csv; then camber fit-parts {}/job.toml -o fitted\n",
               arguments.folder);
  return kDone;
}

}  // namespace

int run_protocol(const ProtocolArguments& arguments, const GlobalOptions& options) {
  namespace fs = std::filesystem;
  Diagnostics diagnostics;
  const machine::Machine machine = machine::read_machine(arguments.machine, diagnostics);
  settle(diagnostics, options);
  make_folder(arguments.folder);
  if (arguments.part) return write_test_piece(arguments, options);
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
