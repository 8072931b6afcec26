#pragma once
// Parameters as a control's own list has them, under [source] in machine.toml.
#include "machine/machine_model.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// Puts native parameters into the machine, and a line for each into machine.translation. What [control], [axis] say
/// beside them wins, since it is read later.
///   [source.fanuc]      1825 = 3000            position gain, 0.01/s; one number or three (x, y, z)
///                       1783 = 400             permitted speed difference at a corner, mm/min: corner law
///                       1420 = [24000, ...]    rapid traverse rate, mm/min
///   [source.sinumerik]  MD32000 max. velocity mm/min, MD32200 position gain (m/min)/mm, MD32300 acceleration m/s2,
///                       MD32431 jerk m/s3; one number or three
///   [source.linuxcnc]   ini = "machine.ini"    beside machine.toml: [TRAJ] LINEAR_UNITS, [EMCMOT] SERVO_PERIOD,
///                       [AXIS_X] ... (else [JOINT_0] ...) MAX_VELOCITY, MAX_ACCELERATION,
///                       [TRAJ] ARC_BLEND_OPTIMIZATION_DEPTH, ARC_BLEND_KINK_RATIO
/// Errors: [value-type], [value-range], [source-ini] for a file that is not there or holds none of these.
void read_source(TomlTable table, Machine& machine);

}  // namespace camber::machine
