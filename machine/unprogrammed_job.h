#pragma once
// A job whose program is still to be made.
#include "machine/job.h"

namespace camber::machine {

/// As read_job, but the program may be missing, in its folder and in the job.
Job read_unprogrammed_job(const std::string& path, Diagnostics& diagnostics);

}  // namespace camber::machine
