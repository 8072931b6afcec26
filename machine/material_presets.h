#pragma once
// The library of materials: each set of values with its source, range and scatter, and the names that it is known by.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "machine/material.h"

namespace camber::machine {

struct MaterialPreset {
  std::string_view name;    ///< as in `[material] preset = "S55C"`
  std::string_view what;    ///< in words
  std::string_view source;  ///< where the values come from
  std::string_view range;   ///< what they hold for, as far as the source says
  Material material;
  bool radial_known = true;               ///< the source gives the radial (and axial) force as well
  std::vector<CatalogueRow> catalogue{};  ///< the source's table, where it is one
  std::string_view names{};               ///< further names, separated by blanks: W.-Nr., EN, AISI, JIS, trade names
  double hardness_HB = 0;                 ///< as supplied; 0: not a metal
  double scatter_percent = 30;            ///< scatter of the force between sources and heats of the material
};

/// In alphabetical order.
std::span<const MaterialPreset> material_presets();
/// By its own name alone. Null: no such name.
const MaterialPreset* find_preset(std::string_view name);

/// Preset that a name was taken for.
struct MaterialMatch {
  const MaterialPreset* preset = nullptr;  ///< null: nothing is known of the name
  std::string note;                        ///< what had to be assumed; empty: the name is in the library
};

/// The preset for a material by any of its names (1.2343, AISI H11, SKD6, X37CrMoV5-1), however it is spaced. A
/// hardness in the name ("1.2379 60 HRC", "Toolox 44 45 HRC", "42CrMo4 300 HB") selects the hardness class of steel. A
/// name that is not in the library is taken for the material of the same standard's group (1.2xxx: tool steel, 3xx:
/// austenitic stainless steel ...), else, where it has a hardness, for the steel of the nearest hardness; `note` says
/// so.
MaterialMatch find_material(std::string_view name);

/// Message about an unknown name: the nearest known one, and what was expected.
std::string unknown_material(std::string_view name);

}  // namespace camber::machine
