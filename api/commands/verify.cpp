#include "api/commands/verify.h"

#include <filesystem>

#include "base/output_file.h"

namespace camber::api {

namespace fs = std::filesystem;

EmittedProgram find_emitted(const std::string& place) {
  EmittedProgram out;
  out.record_file = compensate::find_record(place);
  out.record = compensate::read_record(out.record_file);
  compensate::check_record(out.record, out.record_file);
  const fs::path program = fs::path(out.record_file).parent_path() / out.record.program;
  out.program = program.string();
  out.job_file = fs::path(program).replace_extension(".verify.toml").string();
  return out;
}

VerifiedProgram verify_emitted(const EmittedProgram& emitted, Diagnostics& diagnostics,
                               const simulate::Progress& progress) {
  write_file(emitted.job_file, emitted.record.job);
  VerifiedProgram out{machine::read_job(emitted.job_file, diagnostics), {}};
  out.result = compensate::verify(out.job, emitted.record, diagnostics, progress);
  return out;
}

}  // namespace camber::api
