#pragma once
// Parsed TOML as text again, and keys of it set by their dotted path.
#include <span>
#include <string>

#include "machine/toml_table.h"

namespace camber::machine {

/// One value in a line. Tables come as { a = 1 }, numbers with the digits that give them back.
std::string toml_value(const TomlNode& value);
/// A table with its subtables under headings of their own, keys in the order of their places.
std::string toml_text(const TomlNode& table);

/// "tool.1.overhang_mm" in its parts. An empty part stays empty.
std::vector<std::string> key_parts(std::string_view dotted);
/// The value at a dotted path; null where there is none.
const TomlNode* value_at(const TomlNode& table, std::span<const std::string> path);
/// Sets a value, and makes the tables on the way to it. A table is merged: keys that it does not name stay. False where
/// the way leads through something that is no table.
bool set_value(TomlNode& table, std::span<const std::string> path, const TomlNode& value);

}  // namespace camber::machine
