#pragma once
// Rests: places at which the path stops because the control waits for something that is not motion, and the time that
// a spindle takes.
#include <cstdint>
#include <vector>

#include "machine/cycle.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Moves (ascending) before which the path rests: tool changes, M3 M4 M5 M19, index and pallet, and every code that
/// takes time.
std::vector<std::uint32_t> rests_of(const nc::Interpretation& program, const machine::Cycle& cycle);

/// Time from rest to `speed_rpm` with constant torque up to N1, constant power up to N2 and falling power above:
///   t1 = 1.03 GD2 N1^2 / (375 P0),  t2 = 1.03 GD2 (N2^2 - N1^2) / (750 P0),
///   t3 = 1.03 GD2 (N3^3 - N2^3) / (1125 P0 N2).            [s], GD2 in kgf m2, N in rpm, P0 in W
/// Within the first zone the time is proportional to the speed. 0 where the spindle has no GD2. Where the time to
/// max_rpm is given instead (start_time_s), the time is proportional to the speed throughout.
/// Source: Takata 1999, eqs. 2.13-2.16, t3 as corrected (docs/errata.md).
double spindle_start_s(const machine::Spindle& spindle, double speed_rpm);

/// Between two speeds of one direction of rotation; braking takes as long as starting.
double spindle_change_s(const machine::Spindle& spindle, double from_rpm, double to_rpm);

}  // namespace camber::feedmodel
