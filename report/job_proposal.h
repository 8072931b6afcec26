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
  std::string machine;  ///< the same; empty: to be filled in
  const nc::Summary& summary;
  std::vector<machine::ToolProposal> tools;  ///< by number; those that the program does not cut with are left out
  const nc::Program& text;
  const nc::Interpretation& moves;
  std::string preset{};        ///< of the material; empty: to be filled in
  std::optional<bool> inch{};  ///< unit of a program that does not say it
};

/// job.toml text with comments. What a file says is a value with its source. What no file says is a typical value,
/// marked "typical" (flutes, helix, overhang, root stiffness, the ratio of radial to tangential force), or, where
/// nothing is typical (machine, material, a tool's type and diameter), "# key =", to be filled in before the job is
/// accepted. The blank is that of propose_stock.
std::string job_text(const JobProposal& proposal);

}  // namespace camber::report
