#pragma once
// [[body]] of machine.toml. Internal to machine/.
#include <string>

#include "machine/machine.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// After [kinematics].
void read_bodies(TomlTable& top, Machine& machine);

/// The body as machine.toml text that begins with an empty line.
std::string body_text(const Body& body);

}  // namespace camber::machine
