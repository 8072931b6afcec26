#pragma once
// A job that cuts a plate with a ball on a machine of samples/kinematics whose axes have no inertia and no end of
// travel: what differs between two programs is then their geometry.
#include <string>

#include "machine/job_file.h"
#include "tests/kinematics/machines.h"
#include "tests/support/cutting.h"

namespace camber::testing {

/// Rigid coupling, voxels of 0.1 mm, ball D6, the program "p.nc"; `plate` in mm on the part.
inline machine::Job job_without_inertia(const std::string& machine, const machine::Box& plate) {
  machine::Job job;
  job.program = "p.nc";
  job.machine = kinematics::tests::sample(machine);
  job.machine.control = machine::Control{};
  for (machine::Axis& axis : job.machine.axis) {
    axis = machine::Axis{};
    axis.given = true;
  }
  for (machine::RotaryAxis& axis : job.machine.rotary) {
    axis.max_velocity_rad_per_s = axis.acceleration_rad_per_s2 = machine::kNoLimit;
    axis.travel_rad = {-machine::kNoLimit, machine::kNoLimit};
  }
  job.tools[1] = make_tool(machine::ToolType::ball, 6, 2, 30);
  job.tools[1].number = 1;
  job.material = {2000, 700, 0, 15, 15, 0};
  job.stock.box = plate;
  job.simulation.voxel_mm = 0.1;
  job.simulation.coupling = machine::Coupling::rigid;
  return job;
}

}  // namespace camber::testing
