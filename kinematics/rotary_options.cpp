#include "kinematics/rotary_options.h"

#include <cctype>

namespace camber::kinematics {

std::vector<nc::RotaryOption> rotary_options(const machine::Machine& machine) {
  std::vector<nc::RotaryOption> out;
  for (const char letter : {'a', 'b', 'c'}) {
    if (machine.kinematics.chain.find(letter) == std::string::npos) continue;
    const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(letter - 'a')];
    out.push_back({static_cast<char>(std::toupper(letter)), axis.shortest_way, axis.clamp_m, axis.unclamp_m});
  }
  return out;
}

}  // namespace camber::kinematics
