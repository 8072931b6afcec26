#include "kinematics/rotary_options.h"

#include <cctype>

namespace camber::kinematics {

std::vector<nc::RotaryOption> rotary_options(const machine::Machine& machine) {
  std::vector<nc::RotaryOption> out;
  for (const char letter : {'a', 'b', 'c'}) {
    if (machine.kinematics.chain.find(letter) == std::string::npos) continue;
    const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(letter - 'a')];
    out.push_back({.letter = static_cast<char>(std::toupper(letter)),
                   .on_table = machine.kinematics.chain.find(letter) < machine.kinematics.table_axes,
                   .shortest_way = axis.shortest_way,
                   .clamp_m = axis.clamp_m,
                   .unclamp_m = axis.unclamp_m});
  }
  return out;
}

}  // namespace camber::kinematics
