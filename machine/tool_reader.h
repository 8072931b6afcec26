#pragma once
// One [tool.N] table of a job.
#include <string>

#include "machine/job.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// Problems go to the table's diagnostics; the tool is then not fit for use.
Tool read_tool(TomlTable table, int number);

/// The tool as such a table, with its heading.
std::string tool_toml(const Tool& tool);

}  // namespace camber::machine
