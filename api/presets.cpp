#include "camber/presets.h"

#include "machine/force_law.h"
#include "machine/machine_presets.h"
#include "machine/material_presets.h"

namespace camber {
inline namespace v0 {

std::vector<MachinePreset> machine_presets() {
  std::vector<MachinePreset> out;
  for (const machine::MachinePreset& preset : machine::machine_presets())
    out.push_back({std::string(preset.name), std::string(preset.what)});
  return out;
}

namespace {

/// Forces scatter, exponents and ratios stand.
PresetCoefficient coefficient_of(const machine::Coefficient& c, const machine::MaterialPreset& preset) {
  const double value = preset.material.*c.field;
  const bool is_force = c.unit == "MPa" || c.unit == "N/mm";
  const double scatter = is_force ? preset.scatter_percent / 100 : 0;
  return {std::string(c.key), std::string(c.unit), value, value * (1 - scatter), value * (1 + scatter)};
}

}  // namespace

std::vector<MaterialPreset> material_presets() {
  std::vector<MaterialPreset> out;
  for (const machine::MaterialPreset& preset : machine::material_presets()) {
    MaterialPreset one{std::string(preset.name),  std::string(preset.what),  std::string(preset.source),
                       std::string(preset.range), std::string(preset.names), preset.hardness_HB,
                       preset.scatter_percent};
    for (const machine::Coefficient& c : machine::description(preset.material.law).coefficients)
      one.coefficients.push_back(coefficient_of(c, preset));
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace v0
}  // namespace camber
