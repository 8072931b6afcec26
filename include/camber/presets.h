#pragma once
// Machines and materials of which typical values are built in.
#include <string>
#include <vector>

#include "camber/export.h"

namespace camber {
inline namespace v0 {

/// `machine = "preset:NAME"` of a job.
struct MachinePreset {
  std::string name{};
  std::string what{};  ///< the class in words
};

/// A coefficient of the force law, and the range that the scatter of the preset gives it.
struct PresetCoefficient {
  std::string key{};  ///< key of [material]
  std::string unit{};
  double value = 0, low = 0, high = 0;
};

/// `[material] preset = "NAME"` of a job.
struct MaterialPreset {
  std::string name{};
  std::string what{};          ///< in words
  std::string source{};        ///< where the values come from
  std::string range{};         ///< what they hold for
  std::string names{};         ///< further names, separated by blanks
  double hardness_HB = 0;      ///< as supplied; 0: not a metal
  double scatter_percent = 0;  ///< scatter of the force between sources and heats
  std::vector<PresetCoefficient> coefficients{};
};

CAMBER_API std::vector<MachinePreset> machine_presets();
/// In alphabetical order.
CAMBER_API std::vector<MaterialPreset> material_presets();

}  // namespace v0
}  // namespace camber
