#pragma once
// Modes: parameter sets of a control ([control.mode.NAME]) and the codes of a program that select them.
#include <cstddef>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Returns whether a modal state selects the parameter set of this name: "g05_1_q1", "g05_p10000", "g08_p1" (any of
/// these: "high_speed_contouring"), "cycle832", "g61", "g61_1", "g62", "g63", "g64", and the words of
/// nc/mode_words.h.
bool selects(const nc::ModalState& state, std::string_view name);

/// Returns the index into Machine::modes of the first of its parameter sets that the state selects, plus 1; 0: none,
/// [control].
std::size_t mode_of(const machine::Machine& machine, const nc::ModalState& state);

/// The settings of a mode (mode_of).
const machine::Control& settings_of(const machine::Machine& machine, std::size_t mode);
const machine::Control& settings_of(const machine::Machine& machine, const nc::ModalState& state);

/// The acceleration law of a mode: that of its parameter set, or [cycle]'s.
machine::AccelerationTimes acceleration_law_of(const machine::Machine& machine, std::size_t mode);

/// Returns how corners are passed in a modal state. A parameter set that G61, G61.1, G62 or G63 selects replaces what
/// these mean otherwise; without one LinuxCNC's G61 keeps the path, Mazak's G61.1 is as [control], and both stop
/// exactly on other controls.
nc::PathControl path_control_of(const machine::Machine& machine, const nc::ModalState& state);

/// A warning [mode-unknown] for each mode, at the first block that cuts in it, where the machine file has no parameter
/// set for it: high-speed contouring, CYCLE832, G62, G63, and Mazak's G61.1. (G64 is what [control] describes; G61, and
/// G61.1 elsewhere, have a meaning without one.)
void check_modes(const nc::Interpretation& program, const std::string& program_path, const machine::Machine& machine,
                 Diagnostics& diagnostics);

}  // namespace camber::feedmodel
