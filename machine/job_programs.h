#pragma once
// Jobs with several programs, which run one after the other on one blank: `program = ["rough.nc", "finish.nc"]`.
#include <string>
#include <vector>

#include "machine/job.h"

namespace camber::machine {

/// A job, and its programs in their order, one or more; `job.program` is the first. read_job refuses jobs of several
/// programs [several-programs].
struct JobOfPrograms {
  Job job;
  std::vector<std::string> programs;
};

/// Reads a job as read_job does, with one or several programs. Also [program-list], and [several-programs] for keys
/// that belong to one program alone (lines of operations, a target program).
JobOfPrograms read_job_of_programs(const std::string& path, Diagnostics& diagnostics);

}  // namespace camber::machine
