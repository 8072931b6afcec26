#include "api/rotary_program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "kinematics/joint_map.h"
#include "kinematics/offset_check.h"
#include "kinematics/program_joints.h"
#include "kinematics/reference_check.h"
#include "kinematics/travel_check.h"

namespace camber::api {
namespace {

class RotaryLimits {
 public:
  RotaryLimits(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
               Diagnostics& diagnostics)
      : machine_(machine), program_(program), moves_(moves), diagnostics_(diagnostics) {}

  void check() {
    kinematics::ProgramJoints joints(machine_, moves_);
    std::array<bool, 3> said{};
    while (!joints.done()) {
      const kinematics::MoveJoints& now = joints.next();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        if (said[i] || now.start_rad[index] == now.end_rad[index]) continue;
        said[i] = true;
        check_axis(i, moves_.moves[joints.index()]);
      }
    }
  }

 private:
  void say(Severity severity, const nc::Move& m, const char* check, std::string message) {
    diagnostics_.add(program_.source.diagnostic(severity, program_.blocks[m.block].offset, std::move(message), check));
  }

  void check_axis(std::size_t i, const nc::Move& move) {
    const machine::RotaryAxis& axis = machine_.rotary[i];
    const bool speed = std::isinf(std::min(axis.max_velocity_rad_per_s, axis.max_feed_rad_per_s)),
               acceleration = std::isinf(axis.acceleration_rad_per_s2);
    if (!speed && !acceleration) return;
    const char letter = static_cast<char>('a' + i);
    say(Severity::warning, move, "rotary-limits",
        fmt::format("{} turns here, but [axis.{}] of {} has no {}{}{}; the axis is taken to turn without that limit",
                    static_cast<char>('A' + i), letter, machine_.path, speed ? "max_velocity_deg_per_min" : "",
                    speed && acceleration ? " and no " : "", acceleration ? "acceleration_deg_per_s2" : ""));
  }

  const machine::Machine& machine_;
  const nc::Program& program_;
  const nc::Interpretation& moves_;
  Diagnostics& diagnostics_;
};

}  // namespace

void check_rotary_motion(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                         bool poses, Diagnostics& diagnostics) {
  if (!kinematics::has_rotary_motion(moves, machine)) return;
  const kinematics::Asked joints = machine.control.joint_limits ? kinematics::Asked::joints : kinematics::Asked::times;
  kinematics::check_offsets(program, moves, poses ? kinematics::Asked::poses : joints, diagnostics);
  RotaryLimits(machine, program, moves, diagnostics).check();
  kinematics::check_travel(machine, program, moves, diagnostics);
  kinematics::check_reference_points(machine, program, moves, diagnostics);
}

}  // namespace camber::api
