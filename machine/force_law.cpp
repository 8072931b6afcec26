#include "machine/force_law.h"

#include <algorithm>

#include "machine/toml_table.h"

namespace camber::machine {
namespace {

template <class Fields>
Coefficient of_material(const CoefficientOf<Fields>& c) {
  return {c.key, c.symbol, c.unit, c.meaning, c.field, c.component, c.role, c.range, c.required};
}

template <class Law>
void read_as(TomlTable& table, const MaterialPreset* preset, Material& material) {
  typename Law::Coefficients& into = material;
  if constexpr (requires { Law::read(table, preset, into); }) {
    Law::read(table, preset, into);
  } else {
    for (const auto& c : Law::coefficients)
      if (c.required && !preset && !table.has(c.key)) table.missing(c.key, c.range.wanted());
    for (const auto& c : Law::coefficients)
      if (const auto value = table.optional_number(c.key, c.range)) into.*c.field = *value;
  }
}

template <class Law>
Material start_of(const LinearForce& force, double h_mm) {
  Material out;
  out.law = static_cast<ForceLaw>(ForceLaws::index<Law>);
  Law::start(force, h_mm, out, out);
  return out;
}

template <class Law>
ForceLawDescription describe() {
  ForceLawDescription out{Law::word, Law::title, {}, {}, {}, {}, {}, read_as<Law>, start_of<Law>};
  for (const auto& c : Law::coefficients) {
    out.coefficients.push_back(of_material(c));
    out.keys.push_back(c.key);
    if (c.required) out.shown_by.push_back(c.key);
  }
  out.fitted = out.coefficients;
  for (const auto& c : kEdgeTerms) {
    out.coefficients.push_back(of_material(c));
    if (Law::fits_edge_terms) out.fitted.push_back(of_material(c));
  }
  std::ranges::stable_sort(out.fitted, {}, &Coefficient::component);
  for (const auto& c : out.coefficients) out.header_keys.push_back(c.key);
  if constexpr (requires { Law::further_keys; })
    out.keys.insert(out.keys.end(), Law::further_keys.begin(), Law::further_keys.end());
  if constexpr (requires { Law::shown_by; }) out.shown_by.assign(Law::shown_by.begin(), Law::shown_by.end());
  if constexpr (requires { Law::header_keys; })
    out.header_keys.assign(Law::header_keys.begin(), Law::header_keys.end());
  return out;
}

template <class... Laws>
std::vector<ForceLawDescription> describe_all(LawList<Laws...> /*laws*/) {
  return {describe<Laws>()...};
}

}  // namespace

std::span<const ForceLawDescription> force_laws() {
  static const std::vector<ForceLawDescription> all = describe_all(ForceLaws{});
  return all;
}

const ForceLawDescription& description(ForceLaw law) { return force_laws()[static_cast<std::size_t>(law)]; }

const Coefficient* find_coefficient(std::string_view key) {
  for (const auto& law : force_laws())
    if (const auto at = std::ranges::find(law.coefficients, key, &Coefficient::key); at != law.coefficients.end())
      return &*at;
  return nullptr;
}

}  // namespace camber::machine
