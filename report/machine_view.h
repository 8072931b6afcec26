#pragma once
// What pages of programs with rotary motion draw of the machine: its chain and the tools.
#include <map>
#include <vector>

#include "base/json.h"
#include "checks/tool_outline.h"
#include "machine/job_file.h"
#include "report/path_rows.h"

namespace camber::report {

struct MachineView {
  machine::Machine machine;  ///< with [kinematics]
  std::map<std::uint32_t, std::vector<checks::OutlineRing>> tools;
};

/// True if the tool leaves +Z or a rotary axis turns.
bool turns(const std::vector<PathRow>& rows);
/// The view for the tools that the rows use.
MachineView machine_view(const machine::Job& job, const std::vector<PathRow>& rows);

/// The kinematic chain in the form that report/web/src/chain.js reads.
Json chain_json(const machine::Machine& machine);
/// {chain, tools: {number: [[part, radius, height], ...]}}, parts as of OutlineRing::Part.
Json machine_json(const MachineView& view);

}  // namespace camber::report
