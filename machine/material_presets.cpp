#include "machine/material_presets.h"

#include <algorithm>

namespace camber::machine {

namespace {

constexpr std::string_view kTypical = "typical value for the group of materials, including the factor for milling";
constexpr std::string_view kTypicalRange =
    "not stated; tangential force only; Kienzle's law is a fit to chips of 0.05 mm and more";
constexpr std::string_view kCatalogue =
    "Tungaloy General Catalogue 2020-2021, Technical Reference, milling tools: specific cutting force by feed per "
    "tooth";
constexpr std::string_view kCatalogueRange = "feed per tooth 0.1 to 0.4 mm; tangential force only";
constexpr std::string_view kReview =
    "Milling Force Model for Aviation Aluminum Alloy, Chin. J. Mech. Eng. 34 (2021), doi:10.1186/s10033-021-00536-9, "
    "table 5";

Material linear(double ktc, double krc, double kac, double kte, double kre, double kae) {
  return {ktc, krc, kac, kte, kre, kae};
}

Material kienzle(double kc1_1, double mc) {
  Material m;
  m.law = ForceLaw::kienzle;
  m.kc1_1_MPa = kc1_1;
  m.mc = mc;
  return m;
}

MaterialPreset typical(std::string_view name, std::string_view what, double kc1_1, double mc) {
  return {name, what, kTypical, kTypicalRange, kienzle(kc1_1, mc), false};
}

MaterialPreset catalogue(std::string_view name, std::string_view what, std::vector<CatalogueRow> rows) {
  const KienzlePair pair = kienzle_from_catalogue(rows);
  return {name, what, kCatalogue, kCatalogueRange, kienzle(pair.k1_1_MPa, pair.m), false, std::move(rows)};
}

std::vector<MaterialPreset> make_presets() {
  std::vector<MaterialPreset> out{
      {"Al6082-T6", "wrought aluminium alloy, cemented carbide, dry", kReview, "the table names none",
       linear(631, 99, 273, 13, 10, 2.8)},
      {"Al7075", "wrought aluminium alloy", "typical value for end mills", "not stated",
       linear(951.8, 608.6, 288.5, 14.0, 16.5, -1.25)},
      {"Al7075-T6", "wrought aluminium alloy, cemented carbide, dry", kReview, "the table names none",
       linear(767.01, 168.8, 222, 27.7, 26.6, 0.7)},
      catalogue("FC250", "grey cast iron, JIS G 5501 (EN-GJL-250)",
                {{0.1, 1660}, {0.15, 1450}, {0.2, 1320}, {0.3, 1150}, {0.4, 1030}}),
      catalogue("S55C", "carbon steel, JIS G 4051 (C55)",
                {{0.1, 1970}, {0.15, 1860}, {0.2, 1800}, {0.3, 1760}, {0.4, 1620}}),
      {"C45", "carbon steel C45 (1.0503)", "typical value", kTypicalRange, kienzle(2220, 0.14), false},
      typical("mild-steel", "mild steel", 2298, 0.20),
      typical("low-alloy-steel", "low-alloy steel", 2809, 0.24),
      typical("tool-steel", "tool steel", 3191, 0.27),
      typical("grey-iron", "grey cast iron", 1286, 0.23),
      typical("soft-aluminium", "soft wrought aluminium", 641, 0.27),
  };
  for (auto& p : out) p.material.preset = p.name;
  std::ranges::sort(out, {}, &MaterialPreset::name);
  return out;
}

}  // namespace

std::span<const MaterialPreset> material_presets() {
  static const std::vector<MaterialPreset> presets = make_presets();
  return presets;
}

const MaterialPreset* find_preset(std::string_view name) {
  const auto all = material_presets();
  const auto at = std::ranges::find(all, name, &MaterialPreset::name);
  return at == all.end() ? nullptr : &*at;
}

}  // namespace camber::machine
