#pragma once
// Parameter sets of a control ([control.mode.NAME]) and the codes that select them.
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Whether a modal state selects the parameter set of this name: "high_speed_contouring" (G05.1 Q1, G05 P10000, G08
/// P1), "g61", "g61_1".
bool selects(const nc::ModalState& state, std::string_view name);

/// The settings of the control in a modal state: the first of its parameter sets that the state selects, else its own.
const machine::Control& settings_of(const machine::Machine& machine, const nc::ModalState& state);

/// How corners are passed in a modal state. A parameter set that G61 or G61.1 selects replaces what these mean
/// otherwise; without one LinuxCNC's G61 keeps the path, and that of other controls stops exactly.
nc::PathControl path_control_of(const machine::Machine& machine, const nc::ModalState& state);

/// A warning [mode-unknown] at the first block that cuts in high-speed contouring where the machine file has no
/// parameter set for it.
void check_modes(const nc::Interpretation& program, const std::string& program_path, const machine::Machine& machine,
                 Diagnostics& diagnostics);

}  // namespace camber::feedmodel
