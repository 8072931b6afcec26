#pragma once
// The beginning of a job file, made from what an NC program and tool tables tell.
#include <string>
#include <vector>

#include "machine/tool_proposal.h"
#include "nc/summary.h"

namespace camber::report {

struct JobProposal {
  std::string program;  ///< as the job is to name it
  std::string machine;  ///< the same; empty: to be filled in
  const nc::Summary& summary;
  std::vector<machine::ToolProposal> tools;  ///< by number; those that the program does not cut with are left out
};

/// job.toml text with comments. What a file says stands there as a value with its source; what nobody has said
/// (overhang, coefficients, the blank) stands in a comment, to be filled in: the job is not accepted before it is.
std::string job_text(const JobProposal& proposal);

}  // namespace camber::report
