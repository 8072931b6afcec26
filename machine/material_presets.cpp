#include "machine/material_presets.h"

#include <algorithm>

namespace camber::machine {

KienzlePair kienzle_from_catalogue(std::span<const CatalogueRow> rows) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& r : rows) {
    const double x = std::log(r.feed_per_tooth_mm), y = std::log(r.kc_MPa);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  const double at_one = std::exp((sy - slope * sx) / n);
  KienzlePair out;
  out.m = -slope;
  for (const auto& r : rows)
    out.worst_fraction =
        std::max(out.worst_fraction, std::abs(at_one * std::pow(r.feed_per_tooth_mm, slope) / r.kc_MPa - 1));
  const double half_sqrt_pi = 0.88622692545275801;
  out.k1_1_MPa = at_one / (half_sqrt_pi * std::tgamma(1 - out.m / 2) / std::tgamma(1.5 - out.m / 2));
  return out;
}

namespace {

constexpr std::string_view kHandbook =
    "handbook table of Kienzle values for milling, the milling factor already in (the project's issue 5)";
constexpr std::string_view kHandbookRange =
    "the table names none; tangential force only; Kienzle's law is a fit to chips of 0.05 mm and more";
constexpr std::string_view kCatalogue = "cutter maker's catalogue, k_c by feed per tooth (the project's issue 5)";
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

MaterialPreset handbook(std::string_view name, std::string_view what, double kc1_1, double mc) {
  return {name, what, kHandbook, kHandbookRange, kienzle(kc1_1, mc), false};
}

MaterialPreset catalogue(std::string_view name, std::string_view what, std::vector<CatalogueRow> rows) {
  const KienzlePair pair = kienzle_from_catalogue(rows);
  return {name, what, kCatalogue, kCatalogueRange, kienzle(pair.k1_1_MPa, pair.m), false, std::move(rows)};
}

std::vector<MaterialPreset> make_presets() {
  std::vector<MaterialPreset> out{
      {"Al6082-T6", "wrought aluminium alloy, cemented carbide, dry", kReview, "the table names none",
       linear(631, 99, 273, 13, 10, 2.8)},
      {"Al7075", "wrought aluminium alloy",
       "identified on end mills (the project's issue 5); kae, which the issue leaves out, as a public end-milling "
       "simulation carries the same set",
       "not stated", linear(951.8, 608.6, 288.5, 14.0, 16.5, -1.25)},
      {"Al7075-T6", "wrought aluminium alloy, cemented carbide, dry", kReview, "the table names none",
       linear(767.01, 168.8, 222, 27.7, 26.6, 0.7)},
      catalogue("FC250", "grey cast iron, JIS G 5501 (EN-GJL-250)",
                {{0.1, 1660}, {0.15, 1450}, {0.2, 1320}, {0.3, 1150}, {0.4, 1030}}),
      catalogue("S55C", "carbon steel, JIS G 4051 (C55)",
                {{0.1, 1970}, {0.15, 1860}, {0.2, 1800}, {0.3, 1760}, {0.4, 1620}}),
      {"C45", "carbon steel C45 (1.0503)", "Kienzle values kc1.1 and mc of the literature (the project's issue 5)",
       kHandbookRange, kienzle(2220, 0.14), false},
      handbook("mild-steel", "mild steel", 2298, 0.20),
      handbook("low-alloy-steel", "low-alloy steel", 2809, 0.24),
      handbook("tool-steel", "tool steel", 3191, 0.27),
      handbook("grey-iron", "grey cast iron", 1286, 0.23),
      handbook("soft-aluminium", "soft wrought aluminium", 641, 0.27),
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
