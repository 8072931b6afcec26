#pragma once
// Tables of a job that other readers share.
#include <map>

#include "machine/job.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// [tool.N] tables into `tools`. Problems go to the table's diagnostics.
void read_tools(TomlTable table, std::map<int, Tool>& tools);

}  // namespace camber::machine
