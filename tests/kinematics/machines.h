#pragma once
// The machines of samples/kinematics.
#include <array>
#include <string>

#include "machine/machine_model.h"
#include "test_paths.h"

namespace camber::kinematics::tests {

inline constexpr std::array kMachines{"table_ac_linuxcnc", "table_bc",  "table_ab",
                                      "head_table",        "head_head", "nutating_head"};

inline machine::Machine sample(const std::string& name) {
  Diagnostics diagnostics;
  return machine::read_machine(std::string(CAMBER_SOURCE_DIR "/samples/kinematics/") + name + ".toml", diagnostics);
}

}  // namespace camber::kinematics::tests
