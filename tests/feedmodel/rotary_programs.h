#pragma once
// Programs with rotary axes and machines that time them.
#include <string>

#include "base/units.h"
#include "feedmodel/motion_plan.h"
#include "kinematics/control_options.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "nc/interpreter.h"
#include "test_paths.h"
#include "tests/kinematics/machines.h"

namespace camber::feedmodel::rotary_tests {

constexpr double kToolMm = 80;
constexpr double kPeriodS = 0.001;
inline const std::string kProlog = "G21 G90 G94 G10 L2 P1 X0 Y0 Z0\nG54\n";

inline machine::Machine read_machine(const std::string& file) {
  Diagnostics diagnostics;
  return machine::read_machine(file, diagnostics);
}

inline machine::Machine traced_machine() {
  return read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml");
}

inline nc::Interpretation moves_of(const SourceText& source, const machine::Machine& machine) {
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(source, diagnostics);
  nc::InterpreterOptions options;
  options.rotary_axes = kinematics::rotary_options(machine);
  options.tool_offsets[1].length_mm = kToolMm;
  nc::Interpretation moves = nc::interpret(program, kinematics::interpreter_options(machine, options), diagnostics);
  diagnostics.throw_if_errors();
  if (kinematics::has_rotary_motion(moves, machine)) kinematics::place_moves(moves, machine);
  return moves;
}

inline nc::Interpretation moves_of(const std::string& text, const machine::Machine& machine) {
  return moves_of(SourceText("test.nc", text), machine);
}

/// A machine of samples/kinematics with a Fanuc control that stops at corners, axes without inertia, and these speeds.
inline machine::Machine fast_machine(const std::string& name, double rotary_deg_per_s) {
  machine::Machine m = kinematics::tests::sample(name);
  m.control = machine::Control{};
  m.control.period_s = kPeriodS;
  for (machine::Axis& axis : m.axis) axis = machine::Axis{};
  for (machine::RotaryAxis& axis : m.rotary) {
    axis.max_velocity_rad_per_s = rad_from_deg(rotary_deg_per_s);
    axis.acceleration_rad_per_s2 = machine::kNoLimit;
    axis.travel_rad = {-machine::kNoLimit, machine::kNoLimit};
  }
  return m;
}

inline double cutting_time_s(const nc::Interpretation& moves, const machine::Machine& machine) {
  const MotionPlan plan = plan_motion(moves, machine);
  double sum = 0;
  for (const SegmentTime& t : plan.times)
    if (t.cutting && !t.rest) sum += t.duration_s;
  return sum;
}

/// Time of all motion.
inline double motion_time_s(const nc::Interpretation& moves, const machine::Machine& machine) {
  return plan_motion(moves, machine).time_s();
}

}  // namespace camber::feedmodel::rotary_tests
