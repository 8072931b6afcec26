#pragma once
// Tables of a job that other readers share.
#include <filesystem>
#include <map>

#include "machine/job.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// [tool.N] tables of a file into `tools`, those with `from` by the file that its key `tools` names
/// (machine/tool_shelf.h), which counts from `folder`. Problems go to `diagnostics`. inch: unit of a tool table of
/// LinuxCNC.
void read_tools(TomlTable& top, const std::filesystem::path& folder, bool inch, std::map<int, Tool>& tools,
                Diagnostics& diagnostics);

/// A [stock] table; its paths count from `folder`. Problems go to the table's diagnostics.
void read_stock(TomlTable table, const std::filesystem::path& folder, StockDescription& stock);

/// The path at `machine`, against the folder, or the name of a preset, "preset:vmc-40".
std::string machine_path_at(TomlTable& top, const std::filesystem::path& folder);

}  // namespace camber::machine
