#include "simulate/spindle_power.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

namespace camber::simulate {
namespace {

/// The tooth passing of one tool that is most beyond the spindle's power, and the lines that are beyond it.
struct Overload {
  double factor = 0, taken_W = 0, available_W = 0, speed_rpm = 0;
  std::uint32_t block = 0;
  std::set<std::uint32_t> blocks;
};

std::string message_of(int tool, const Overload& o) {
  std::string out = fmt::format("T{} takes {:.0f} W at {:g} rpm, where the spindle provides {:.0f} W", tool, o.taken_W,
                                o.speed_rpm, o.available_W);
  if (o.blocks.size() > 1) out += fmt::format("; {} lines need more than that", o.blocks.size());
  return out + "; at most power_W of the machine file was expected";
}

}  // namespace

double spindle_power_at(const machine::Spindle& spindle, double speed_rpm) {
  double factor = 1;
  if (std::isfinite(spindle.constant_torque_rpm)) factor = std::min(factor, speed_rpm / spindle.constant_torque_rpm);
  if (std::isfinite(spindle.constant_power_rpm)) factor = std::min(factor, spindle.constant_power_rpm / speed_rpm);
  return factor * spindle.power_W;
}

void check_spindle_power(const machine::Machine& machine, const SimulatedProgram& program,
                         std::span<const StampLoad> loads, Diagnostics& diagnostics) {
  if (std::isinf(machine.spindle.power_W)) return;
  std::map<int, Overload> overloads;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const nc::Move& move = program.moves_in_part().moves[program.path.stamps[k].move];
    const nc::ModalState& state = program.moves_in_part().state_of(move);
    if (state.spindle_speed_rpm <= 0) continue;
    const double taken_W = power_W(loads[k].torque_mean_Nmm, state.spindle_speed_rpm);
    const double available_W = spindle_power_at(machine.spindle, state.spindle_speed_rpm);
    if (taken_W <= available_W) continue;
    Overload& worst = overloads[state.tool];
    worst.blocks.insert(move.block);
    if (taken_W / available_W <= worst.factor) continue;
    worst.factor = taken_W / available_W;
    worst.taken_W = taken_W;
    worst.available_W = available_W;
    worst.speed_rpm = state.spindle_speed_rpm;
    worst.block = move.block;
  }
  for (const auto& [tool, overload] : overloads)
    diagnostics.add(program.text().source.diagnostic(Severity::warning, program.text().blocks[overload.block].offset,
                                                     message_of(tool, overload), "spindle-power"));
}

}  // namespace camber::simulate
