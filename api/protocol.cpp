#include "camber/protocol.h"

#include <filesystem>

#include <fmt/format.h>

#include "api/job.h"
#include "calib/protocol_programs.h"
#include "calib/test_piece.h"

namespace camber {

std::vector<ProtocolFile> v0::protocol(const Machine& machine, const ProtocolOptions& options) {
  std::vector<ProtocolFile> out;
  if (options.part) {
    const std::string name = options.machine_name.empty() ? machine.path() : options.machine_name;
    for (const calib::TestPieceFile& file : calib::test_piece(name, {.diameter_mm = options.diameter_mm}))
      out.push_back({file.name, file.text, fmt::format("{:<18} {}\n", file.name, file.tells)});
    return out;
  }
  for (const calib::ProtocolProgram& program : calib::protocol_programs(machine.impl().machine)) {
    out.push_back({program.name, program.text,
                   fmt::format("{:<18} {:>4} parts: {}\n", program.name, program.parts.size(), program.tells)});
    if (!program.parts.empty())
      out.push_back(
          {std::filesystem::path(program.name).replace_extension(".parts.csv").string(), calib::parts_csv(program)});
  }
  return out;
}

}  // namespace camber
