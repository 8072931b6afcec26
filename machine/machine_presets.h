#pragma once
// Machines by class: typical values for a machine of which no file exists yet.
#include <span>
#include <string>
#include <string_view>

#include "base/diagnostics.h"

namespace camber::machine {

/// `machine = "preset:NAME"` in a job, `--machine preset:NAME` on the command line. The dialect of the control is that
/// which the program's text shows. All values are guesses, and every result says so (assumptions.h).
struct MachinePreset {
  std::string_view name;
  std::string_view what;  ///< the class in words
  /// machine.toml, see machine_preset_text(); each value is followed by "# LOW to HIGH: source", the range over
  /// machines of the class.
  std::string_view toml;
};

inline constexpr std::string_view kPresetPrefix = "preset:";

std::span<const MachinePreset> machine_presets();

/// True for "preset:...", which names no file.
bool is_preset(std::string_view machine_path);

/// The preset that "preset:NAME" names; null: there is none of that name.
const MachinePreset* find_machine_preset(std::string_view machine_path);

/// Message about an unknown "preset:NAME", with the names that were expected.
std::string unknown_machine_preset(std::string_view machine_path);

/// A machine file to start from: the preset's text with a head that says what it is.
std::string machine_preset_text(const MachinePreset& preset);

}  // namespace camber::machine
