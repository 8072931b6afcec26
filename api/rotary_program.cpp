#include "api/rotary_program.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "feedmodel/control_options.h"
#include "feedmodel/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/program_joints.h"
#include "kinematics/reference_check.h"
#include "kinematics/rotary_options.h"
#include "kinematics/travel_check.h"

namespace camber::api {
namespace {

class RotaryCheck {
 public:
  RotaryCheck(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
              Diagnostics& diagnostics)
      : machine_(machine), program_(program), moves_(moves), diagnostics_(diagnostics) {}

  /// joints_count: those under tool-centre-point control, too; poses: poses of the tool as well.
  void check_known(bool joints_count, bool poses) {
    const nc::Move* unknown = nullptr;
    for (const nc::Move& move : moves_.moves) {
      if (move.kind == nc::MoveKind::dwell || move.reference) continue;
      const nc::ModalState& state = moves_.state_of(move);
      if (moves_.machine_origin_mm && state.tool_length_mm) continue;
      if (!unknown) unknown = &move;
      const bool in_frame = state.work_frame != nc::WorkFrame::machine;
      if (!in_frame && (!joints_count || state.tip_control == nc::TipControl::off)) continue;
      report_unknown(move, state);
      return;
    }
    if (poses && unknown)
      say(Severity::warning, *unknown, "pose-unknown",
          fmt::format("{} is not known and taken as 0 for the pose of the tool", missing(moves_.state_of(*unknown))));
  }

  /// The first move under tool-centre-point control whose tool length is not known.
  void check_tip_lengths() {
    const auto at = std::ranges::find_if(moves_.moves, [&](const nc::Move& move) {
      const nc::ModalState& state = moves_.state_of(move);
      return move.kind != nc::MoveKind::dwell && !move.reference && state.tip_control != nc::TipControl::off &&
             !state.tool_length_mm;
    });
    if (at != moves_.moves.end()) report_unknown(*at, moves_.state_of(*at));
  }

  void check_limits() {
    kinematics::ProgramJoints joints(machine_, moves_);
    std::array<bool, 3> said{};
    while (!joints.done()) {
      const kinematics::MoveJoints& now = joints.next();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        if (said[i] || now.start_rad[index] == now.end_rad[index]) continue;
        said[i] = true;
        check_limits(i, moves_.moves[joints.index()]);
      }
    }
  }

 private:
  void say(Severity severity, const nc::Move& m, const char* check, std::string message) {
    diagnostics_.add(program_.source.diagnostic(severity, program_.blocks[m.block].offset, std::move(message), check));
  }

  std::string missing(const nc::ModalState& state) const {
    if (!moves_.machine_origin_mm && !state.tool_length_mm) return "the work offset, like the tool length,";
    return moves_.machine_origin_mm ? "the tool length" : "the work offset";
  }

  static const char* where(const nc::ModalState& state) {
    if (state.work_frame == nc::WorkFrame::tilted) return "in a tilted frame (G68.2)";
    return state.work_frame == nc::WorkFrame::dynamic ? "under G254" : "under tool-centre-point control";
  }

  void report_unknown(const nc::Move& move, const nc::ModalState& state) {
    if (state.tool_length_mm)
      say(Severity::error, move, "work-offset",
          fmt::format("the joints of this move {} depend on the work offset, which is not known; its value (G10 L2, or "
                      "--work-offset) was expected",
                      where(state)));
    else
      say(Severity::error, move, "tool-length",
          fmt::format("the joints of this move {} depend on the length of tool T{}, which is not known; --tool-length "
                      "H=MM, or its value (G10 L1) in the program, was expected",
                      where(state), state.tool));
  }

  void check_limits(std::size_t i, const nc::Move& move) {
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

nc::InterpreterOptions rotary_interpreter_options(const machine::Machine& machine, nc::InterpreterOptions given) {
  given.rotary_axes = kinematics::rotary_options(machine);
  return feedmodel::interpreter_options(machine, std::move(given));
}

void check_rotary_motion(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                         bool poses, Diagnostics& diagnostics) {
  if (!feedmodel::has_rotary_motion(moves, machine)) return;
  RotaryCheck check(machine, program, moves, diagnostics);
  check.check_known(poses || machine.control.joint_limits, poses);
  check.check_limits();
  kinematics::check_travel(machine, program, moves, diagnostics);
  kinematics::check_reference_points(machine, program, moves, diagnostics);
}

void place_rotary_lines(const machine::Machine& machine, nc::Interpretation& moves) {
  if (feedmodel::has_rotary_motion(moves, machine)) kinematics::place_lines(moves, machine);
}

void place_rotary_moves(const machine::Machine& machine, nc::Interpretation& moves) {
  if (feedmodel::has_rotary_motion(moves, machine)) kinematics::place_moves(moves, machine);
}

bool joints_known(const nc::Interpretation& moves) {
  return moves.machine_origin_mm && std::ranges::all_of(moves.moves, [&](const nc::Move& move) {
           return move.kind == nc::MoveKind::dwell || move.reference || moves.state_of(move).tool_length_mm;
         });
}

void check_tip_lengths(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                       Diagnostics& diagnostics) {
  if (feedmodel::has_rotary_motion(moves, machine))
    RotaryCheck(machine, program, moves, diagnostics).check_tip_lengths();
}

void check_tip_control(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                       Diagnostics& diagnostics) {
  if (!feedmodel::has_rotary_motion(moves, machine)) return;
  RotaryCheck check(machine, program, moves, diagnostics);
  check.check_known(true, false);
}

}  // namespace camber::api
