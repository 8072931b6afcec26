#include "feedmodel/modes.h"

#include <algorithm>

namespace camber::feedmodel {
namespace {

constexpr std::string_view kContouring = "high_speed_contouring";

}  // namespace

bool selects(const nc::ModalState& state, std::string_view name) {
  if (name == kContouring) return state.high_speed_contouring;
  if (name == "g61") return state.path_control == nc::PathControl::exact_path;
  return name == "g61_1" && state.path_control == nc::PathControl::exact_stop;
}

const machine::Control& settings_of(const machine::Machine& machine, const nc::ModalState& state) {
  for (const auto& [name, settings] : machine.modes)
    if (selects(state, name)) return settings;
  return machine.control;
}

nc::PathControl path_control_of(const machine::Machine& machine, const nc::ModalState& state) {
  for (const auto& [name, settings] : machine.modes)
    if (name != kContouring && selects(state, name)) return nc::PathControl::blend;
  const bool stops = state.path_control == nc::PathControl::exact_path && machine.control.kind.g61_stops;
  return stops ? nc::PathControl::exact_stop : state.path_control;
}

void check_modes(const nc::Interpretation& program, const std::string& program_path, const machine::Machine& machine,
                 Diagnostics& diagnostics) {
  const bool known = std::ranges::any_of(machine.modes, [](const auto& mode) { return mode.first == kContouring; });
  if (known) return;
  const auto first = std::ranges::find_if(program.moves, [&](const nc::Move& move) {
    const bool cuts = move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc;
    return cuts && program.state_of(move).high_speed_contouring;
  });
  if (first == program.moves.end()) return;
  diagnostics.add({.severity = Severity::warning,
                   .location = {program_path, std::size_t{first->block} + 1, 1},
                   .message = "high-speed contouring (G05.1 Q1, G05 P10000, G08 P1) is on, and the machine file has no "
                              "[control.mode.high_speed_contouring]: [control] counts",
                   .check = "mode-unknown",
                   .source_line = {}});
}

}  // namespace camber::feedmodel
