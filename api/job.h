#pragma once
// What stands behind camber::Machine and camber::Job.
#include "base/diagnostics.h"
#include "camber/job.h"
#include "machine/job_file.h"

namespace camber {

struct Machine::Impl {
  machine::Machine machine;
  Diagnostics found;  ///< in its file
};

struct Job::Impl {
  machine::Job job;
  Diagnostics found;  ///< in its files
};

namespace api {

/// The job, which must have a program: else an error, [job-program].
const machine::Job& programmed(const Job& job);

}  // namespace api
}  // namespace camber
