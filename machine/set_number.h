#pragma once
// A number of a machine by its name in machine.toml, for what-if: "axis.x.acceleration_mm_per_s2".
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "machine/machine_model.h"

namespace camber::machine {

/// Sets `key` to `value`, in the file's unit. "axis.all.KEY" sets the three axes.
/// Returns what is wrong, and what was expected (unknown key, value out of range); empty when it is done.
std::string set_number(Machine& machine, std::string_view key, double value);

/// The number of `key`, in the file's unit; nothing for an unknown key.
std::optional<double> number_of(const Machine& machine, std::string_view key);

/// Every key that set_number takes, in the order of the file.
std::vector<std::string> number_keys();

}  // namespace camber::machine
