#include "api/commands/copy.h"

#include "machine/unprogrammed_job.h"

namespace camber::api {

CopyJob read_copy_job(const std::string& path, Diagnostics& diagnostics) {
  CopyJob out{machine::read_unprogrammed_job(path, diagnostics), {}};
  out.operations = machine::read_copy_operations(path, out.job, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

copymill::CopyResult copy_job(const CopyJob& job, const copymill::CopyOptions& options, Diagnostics& diagnostics) {
  return copymill::copy(job.job, job.operations, options, diagnostics);
}

}  // namespace camber::api
