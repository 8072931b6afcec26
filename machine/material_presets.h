#pragma once
// The library of materials: each set of values with its source and range.
#include <span>
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
};

/// In alphabetical order.
std::span<const MaterialPreset> material_presets();
/// Null: no such name.
const MaterialPreset* find_preset(std::string_view name);

}  // namespace camber::machine
