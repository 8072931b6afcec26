#pragma once
// Comparison of cutting power and spindle power.
#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// What the motor gives at a speed: power_W from constant_torque_rpm to constant_power_rpm, in proportion to the speed
/// below and to its inverse above; where these speeds are not given, power_W at every speed. Infinite: no limit.
double spindle_power_at(const machine::Spindle& spindle, double speed_rpm);

/// Warning [spindle-power] for each tool that takes more, at the line where it is most beyond it; the power is the mean
/// over a tooth passing. `loads`: one per stamp of the program's path.
void check_spindle_power(const machine::Machine& machine, const SimulatedProgram& program,
                         std::span<const StampLoad> loads, Diagnostics& diagnostics);

}  // namespace camber::simulate
