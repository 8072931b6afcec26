#pragma once
// A job whose program is still to be made.
#include "machine/job.h"

namespace camber::machine {

/// Reads a job as read_job does, but the program may be missing, in its folder and in the job.
Job read_unprogrammed_job(const std::string& path, Diagnostics& diagnostics);

}  // namespace camber::machine
