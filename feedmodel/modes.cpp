#include "feedmodel/modes.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

#include "nc/mode_words.h"

namespace camber::feedmodel {
namespace {

using nc::Contouring;

struct ContouringCode {
  std::string_view set;   ///< name of its parameter set
  std::string_view text;  ///< code as programs have it
};

/// One row per value of nc::Contouring, in its order.
constexpr std::array<ContouringCode, 6> kContouring{{{"", ""},
                                                     {"g08_p1", "G08 P1"},
                                                     {"g05_p10000", "G05 P10000"},
                                                     {"g05_1_q1", "G05.1 Q1"},
                                                     {"cycle832", "CYCLE832"},
                                                     {"cycle32", "CYCL DEF 32"}}};
constexpr std::string_view kAnyContouring = "high_speed_contouring";

/// Sets that say how corners are passed, instead of the code's own meaning.
constexpr std::array<std::string_view, 5> kPathCodes{"g61", "g61_1", "g62", "g63", "g64"};

/// Sets of a code that says more than the contouring it switches on: CYCLE832 for finishing, HSC-MODE of cycle 32.
bool has_finer_set(const nc::ModalState& state, const machine::Machine& machine) {
  return std::ranges::any_of(machine.modes, [&](const auto& mode) {
    return mode.first.starts_with(kContouring[static_cast<std::size_t>(state.contouring)].set) &&
           (state.mode_words & nc::mode_word_bit(mode.first)) != 0;
  });
}

const ContouringCode& contouring_of(const nc::ModalState& state) {
  return kContouring[static_cast<std::size_t>(state.contouring)];
}

bool has_set(const machine::Machine& machine, std::string_view name) {
  return std::ranges::any_of(machine.modes, [&](const auto& mode) { return mode.first == name; });
}

/// Returns the modes of a state that the machine file does not describe.
void unknown_modes(const nc::ModalState& state, const machine::Machine& machine, std::set<std::string>& messages) {
  const auto add = [&](std::string_view code, std::string_view means, std::string_view sets) {
    messages.insert(fmt::format("{} ({}) is on, and the machine file has no {}; [control] is used", code, means, sets));
  };
  const ContouringCode& contouring = contouring_of(state);
  const bool any = state.high_speed_contouring && has_set(machine, kAnyContouring);
  if (state.contouring != Contouring::none && !any && !has_set(machine, contouring.set) &&
      !has_finer_set(state, machine))
    add(contouring.text, "high-speed contouring",
        fmt::format("[control.mode.{}]{}", contouring.set,
                    state.high_speed_contouring ? fmt::format(" or [control.mode.{}]", kAnyContouring) : ""));
  if (state.path_g == 62 && !has_set(machine, "g62")) add("G62", "automatic corner override", "[control.mode.g62]");
  if (state.path_g == 63 && !has_set(machine, "g63")) add("G63", "tapping mode", "[control.mode.g63]");
  const bool g61_1 = state.path_control == nc::PathControl::exact_stop && !machine.control.kind.g61_1_stops;
  if (g61_1 && !has_set(machine, "g61_1")) add("G61.1", "high-accuracy mode", "[control.mode.g61_1]");
}

}  // namespace

bool selects(const nc::ModalState& state, std::string_view name) {
  if (name == kAnyContouring) return state.high_speed_contouring;
  if (name == "g61") return state.path_control == nc::PathControl::exact_path;
  if (name == "g61_1") return state.path_control == nc::PathControl::exact_stop;
  if (name == "g62") return state.path_g == 62;
  if (name == "g63") return state.path_g == 63;
  if (name == "g64") return state.path_g == 64;
  if ((state.mode_words & nc::mode_word_bit(name)) != 0) return true;
  return state.contouring != Contouring::none && contouring_of(state).set == name;
}

std::size_t mode_of(const machine::Machine& machine, const nc::ModalState& state) {
  for (std::size_t i = 0; i < machine.modes.size(); ++i)
    if (selects(state, machine.modes[i].first)) return i + 1;
  return 0;
}

const machine::Control& settings_of(const machine::Machine& machine, std::size_t mode) {
  return mode == 0 ? machine.control : machine.modes[mode - 1].second;
}

const machine::Control& settings_of(const machine::Machine& machine, const nc::ModalState& state) {
  return settings_of(machine, mode_of(machine, state));
}

machine::AccelerationTimes acceleration_law_of(const machine::Machine& machine, std::size_t mode) {
  const auto& law = settings_of(machine, mode).acceleration_law;
  const machine::Cycle& c = machine.cycle;
  return law ? *law
             : machine::AccelerationTimes{c.acceleration_law, c.time_constant_1_s, c.time_constant_2_s, c.bell_time_s};
}

nc::PathControl path_control_of(const machine::Machine& machine, const nc::ModalState& state) {
  for (const auto& [name, settings] : machine.modes)
    if (std::ranges::find(kPathCodes, name) != kPathCodes.end() && selects(state, name)) return nc::PathControl::blend;
  const machine::ControlKind& kind = machine.control.kind;
  if (state.path_control == nc::PathControl::exact_path && kind.g61_stops) return nc::PathControl::exact_stop;
  const bool mode_only = state.path_control == nc::PathControl::exact_stop && !kind.g61_1_stops;
  return mode_only ? nc::PathControl::blend : state.path_control;
}

void check_modes(const nc::Interpretation& program, const std::string& program_path, const machine::Machine& machine,
                 Diagnostics& diagnostics) {
  std::set<std::string> reported;
  std::uint32_t last = nc::Move::kNoArc;
  for (const nc::Move& move : program.moves) {
    if ((move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc) || move.state == last) continue;
    last = move.state;
    std::set<std::string> messages;
    unknown_modes(program.state_of(move), machine, messages);
    for (const std::string& message : messages)
      if (reported.insert(message).second)
        diagnostics.add({.severity = Severity::warning,
                         .location = {program_path, std::size_t{move.block} + 1, 1},
                         .message = message,
                         .check = "mode-unknown",
                         .source_line = {}});
  }
}

}  // namespace camber::feedmodel
