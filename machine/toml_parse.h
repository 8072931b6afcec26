#pragma once
// TOML from memory.
#include <memory>
#include <string>

#include "machine/toml_table.h"

namespace camber::machine {

/// As read_toml, of a text that is in memory; diagnostics name it by the text's name.
std::unique_ptr<TomlFile> parse_toml(SourceText text, const std::string& contents, Diagnostics& diagnostics);

}  // namespace camber::machine
