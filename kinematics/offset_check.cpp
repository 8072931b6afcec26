#include "kinematics/offset_check.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace camber::kinematics {
namespace {

bool has_place(const nc::Move& move) { return move.kind != nc::MoveKind::dwell && !move.reference; }

bool needs_offsets(const nc::ModalState& state, Asked asked) {
  const bool tip_control = state.tip_control != nc::TipControl::off;
  switch (asked) {
    case Asked::part:
      return true;
    case Asked::tip_control:
      return tip_control;
    case Asked::times:
      return state.work_frame != nc::WorkFrame::machine;
    default:
      return tip_control || state.work_frame != nc::WorkFrame::machine;
  }
}

const char* where(const nc::ModalState& state) {
  if (state.work_frame == nc::WorkFrame::tilted) return "in a tilted frame (G68.2)";
  return state.work_frame == nc::WorkFrame::dynamic ? "under G254" : "under tool-centre-point control";
}

std::string length_message(const nc::ModalState& state, Asked asked) {
  if (asked == Asked::part)
    return fmt::format(
        "where the tool is on the part depends on the length of tool T{}, which is not known; its value (G10 L1) in "
        "the program was expected",
        state.tool);
  return fmt::format(
      "the joints of this move {} depend on the length of tool T{}, which is not known; --tool-length H=MM, or its "
      "value (G10 L1) in the program, was expected",
      where(state), state.tool);
}

std::string offset_message(const nc::ModalState& state, Asked asked) {
  if (asked == Asked::part)
    return "where the tool is on the part depends on the work offset, which is not known; G10 L2 in the program or "
           "[compensation] work_offset_mm (of G54) in the job was expected";
  return fmt::format(
      "the joints of this move {} depend on the work offset, which is not known; its value (G10 L2, or --work-offset) "
      "was expected",
      where(state));
}

std::string unknown_message(bool origin_known, const nc::ModalState& state) {
  const std::string what = origin_known            ? "the tool length"
                           : !state.tool_length_mm ? "the work offset, like the tool length,"
                                                   : "the work offset";
  return what + " is not known and taken as 0 for the pose of the tool";
}

}  // namespace

void check_offsets(const nc::Program& program, const nc::Interpretation& moves, Asked asked, Diagnostics& diagnostics) {
  const bool origin_known = asked == Asked::tip_control || moves.machine_origin_mm;
  const auto say = [&](Severity severity, const nc::Move& move, const char* check, std::string message) {
    diagnostics.add(program.source.diagnostic(severity, program.blocks[move.block].offset, std::move(message), check));
  };
  const nc::Move* unknown = nullptr;
  for (const nc::Move& move : moves.moves) {
    const nc::ModalState& state = moves.state_of(move);
    if (!has_place(move) || (origin_known && state.tool_length_mm)) continue;
    if (!unknown) unknown = &move;
    if (!needs_offsets(state, asked)) continue;
    // On the part the offset is named first, which all tools need.
    const bool offset = asked == Asked::part ? !origin_known : state.tool_length_mm.has_value();
    return say(Severity::error, move, offset ? "work-offset" : "tool-length",
               offset ? offset_message(state, asked) : length_message(state, asked));
  }
  if (asked == Asked::poses && unknown)
    say(Severity::warning, *unknown, "pose-unknown", unknown_message(origin_known, moves.state_of(*unknown)));
}

bool offsets_known(const nc::Interpretation& moves) {
  return moves.machine_origin_mm && std::ranges::all_of(moves.moves, [&](const nc::Move& move) {
           return !has_place(move) || moves.state_of(move).tool_length_mm;
         });
}

}  // namespace camber::kinematics
