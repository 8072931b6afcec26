#pragma once
// The work of camber copy.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "copymill/copy_milling.h"
#include "machine/copy_operations.h"
#include "machine/job_file.h"

namespace camber::api {

struct CopyJob {
  machine::Job job;
  std::vector<machine::CopyOperation> operations;
};
/// A job with [[copy]]; a program is not needed. Throws InputError.
CopyJob read_copy_job(const std::string& path, Diagnostics& diagnostics);

/// Throws InputError. Writes nothing. The emitted text is read again, as `program`, the file that it goes to: rapids
/// through material, shank and holder in stock, and material above the flutes are diagnostics at its blocks.
copymill::CopyResult copy_job(const CopyJob& job, const std::string& program, const copymill::CopyOptions& options,
                              Diagnostics& diagnostics);

}  // namespace camber::api
