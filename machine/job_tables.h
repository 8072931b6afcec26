#pragma once
// Tables of a job that other readers share: tools, modes, stock.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "machine/toml_table.h"
#include "machine/tool.h"
#include "machine/workpiece.h"

namespace camber::machine {

/// Problems go to the table's diagnostics; the tool is then not fit for use.
Tool read_tool(TomlTable table, int number);

/// The tool as such a table, with its heading.
std::string tool_toml(const Tool& tool);

/// [tool.N] tables of a file into `tools`, those with `from` by the file that its key `tools` names
/// (machine/tool_shelf), which counts from `folder`. Problems go to `diagnostics`. inch: unit of a tool table of
/// LinuxCNC.
void read_tools(TomlTable& top, const std::filesystem::path& folder, bool inch, std::map<int, Tool>& tools,
                Diagnostics& diagnostics);

/// A [stock] table; its paths count from `folder`. Problems go to the table's diagnostics.
void read_stock(TomlTable table, const std::filesystem::path& folder, StockDescription& stock);

/// The path at `machine`, against the folder, or the name of a preset, "preset:vmc-40".
std::string machine_path_at(TomlTable& top, const std::filesystem::path& folder);

/// The list `mode` of a table. Problems go to the table's diagnostics.
std::vector<Mode> read_modes(TomlTable& owner);

/// The same tables as text; `owner` as in their brackets: "tool.1".
std::string modes_text(const std::vector<Mode>& modes, std::string_view owner);

}  // namespace camber::machine
