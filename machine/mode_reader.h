#pragma once
// [[tool.N.mode]] and [[workpiece.mode]] of a job.
#include <vector>

#include "machine/mode.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// The list `mode` of a table. Problems go to the table's diagnostics.
std::vector<Mode> read_modes(TomlTable& owner);

/// The same tables as text; `owner` as in their brackets: "tool.1".
std::string modes_text(const std::vector<Mode>& modes, std::string_view owner);

}  // namespace camber::machine
