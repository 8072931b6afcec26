#pragma once
// Tables of a job that other readers share.
#include <filesystem>
#include <map>

#include "machine/job.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// [tool.N] tables into `tools`. Problems go to the table's diagnostics.
void read_tools(TomlTable table, std::map<int, Tool>& tools);

/// A [stock] table; its paths count from `folder`. Problems go to the table's diagnostics.
void read_stock(TomlTable table, const std::filesystem::path& folder, StockDescription& stock);

/// The path at `machine`, against the folder, or the name of a preset, "preset:vmc-40".
std::string machine_path_at(TomlTable& top, const std::filesystem::path& folder);

}  // namespace camber::machine
