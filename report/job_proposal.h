#pragma once
// The beginning of a job file, made from what an NC program and tool tables tell.
#include <optional>
#include <string>
#include <vector>

#include "machine/tool_proposal.h"
#include "nc/move.h"
#include "nc/program.h"
#include "nc/summary.h"

namespace camber::report {

struct JobProposal {
  std::string program;  ///< as the job is to name it
  std::string machine;  ///< the same, or "preset:NAME"; empty: the preset of a class that can run the program
  const nc::Summary& summary;
  std::vector<machine::ToolProposal> tools;  ///< by number; those that the program does not cut with are left out
  const nc::Program& text;
  const nc::Interpretation& moves;
  std::string material{};      ///< a name that machine::find_material knows; empty: the commonest
  std::optional<bool> inch{};  ///< unit of a program that does not say it
};

/// job.toml text with comments; a job that runs as it stands. What a file says is a value with its source. What no file
/// says is a typical value, marked "typical" or CHECK and named in the `assumed` of its table, with which every result
/// begins (machine/assumptions.h): machine, material, what is open of the tools (tool_guess.h), the blank
/// (stock_proposal.h) where no comment gives it.
std::string job_text(const JobProposal& proposal);

}  // namespace camber::report
