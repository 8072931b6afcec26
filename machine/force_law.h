#pragma once
// The force laws as data, for what reads, writes, fits and reports them, and as code, for what works out forces.
// What a law is: force_laws/law.h.
#include <span>
#include <vector>

#include "machine/material.h"

namespace camber::machine {

using Coefficient = CoefficientOf<Material>;

struct ForceLawDescription {
  std::string_view word, title;
  std::vector<Coefficient> coefficients;  ///< its own, then the edge terms, as they are written
  std::vector<Coefficient> fitted;        ///< those that fit-force fits: tangential, radial, axial
  std::vector<std::string_view> keys;     ///< keys of [material] that belong to this law alone
  std::vector<std::string_view> shown_by;
  std::vector<std::string_view> header_keys;
  /// Reads the law's coefficients but for the edge terms; a preset, or null, has filled them in.
  void (*read)(TomlTable&, const MaterialPreset*, Material&);
  /// A material of this law with the force and, as near as the law can, the slope of a linear one at h.
  Material (*start)(const LinearForce&, double h_mm);
};

/// In the order of ForceLaws.
std::span<const ForceLawDescription> force_laws();
const ForceLawDescription& description(ForceLaw law);
/// Coefficient of any law by its key. Null: no such key.
const Coefficient* find_coefficient(std::string_view key);

/// Calls f with the law's type, as a value without data. A few comparisons; f is inlined.
template <std::size_t I = 0, class Function>
constexpr decltype(auto) with_law(ForceLaw law, const Function& f) {
  if constexpr (I + 1 < ForceLaws::size)
    if (law != static_cast<ForceLaw>(I)) return with_law<I + 1>(law, f);
  return f(ForceLaws::At<I>{});
}

/// Whether the specific cutting force is the same at every chip thickness.
inline bool is_affine(ForceLaw law) {
  return with_law(law, [](auto l) { return decltype(l)::affine; });
}

}  // namespace camber::machine
