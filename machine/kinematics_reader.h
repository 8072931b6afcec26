#pragma once
// [kinematics], the tables of the rotary axes and [[body]]. Internal to machine/.
#include <string>

#include "machine/machine_model.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// [axis.a], [axis.b], [axis.c]; `axes` is [axis].
void read_rotary_axes(TomlTable& axes, Machine& machine);
/// [kinematics]; after the axes.
void read_kinematics(TomlTable table, Machine& machine);
/// Errors at the tables of rotary axes that are not in the chain, and at [index] where the chain has B.
void check_kinematics(TomlTable& top, const Machine& machine);

/// Both as machine.toml text, each beginning with an empty line; empty where there is nothing to write.
std::string kinematics_text(const Kinematics& kinematics);
std::string rotary_axis_text(std::string_view name, const RotaryAxis& axis);

/// After [kinematics].
void read_bodies(TomlTable& top, Machine& machine);

/// The body as machine.toml text that begins with an empty line.
std::string body_text(const Body& body);

}  // namespace camber::machine
