#pragma once
// The work of camber compensate --verify: an emitted program judged again from its text.
#include <string>

#include "base/diagnostics.h"
#include "compensate/verify.h"
#include "machine/job_file.h"

namespace camber::api {

/// An emitted program, its record, and where the job that judges it is written.
struct EmittedProgram {
  std::string program, record_file, job_file;
  compensate::Record record;
};

/// `place`: an emitted program or its folder. Throws InputError: see find_record, read_record and check_record.
EmittedProgram find_emitted(const std::string& place);

struct VerifiedProgram {
  machine::Job job;
  compensate::Verification result;
};

/// Writes the job and judges by it. Throws InputError and BeyondModel.
VerifiedProgram verify_emitted(const EmittedProgram& emitted, Diagnostics& diagnostics,
                               const simulate::Progress& progress);

}  // namespace camber::api
