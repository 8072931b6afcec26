#include "machine/force_laws/kienzle.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include <fmt/format.h>

#include "machine/material_presets.h"
#include "machine/toml_table.h"

namespace camber::machine {
namespace {

using Coefficients = KienzleLaw::Coefficients;

constexpr NumberRange kExponent = KienzleLaw::exponent_range;

void read_catalogue(TomlTable& table, Coefficients& c) {
  const auto rows =
      table.number_rows("kc_by_feed", 0, 2, kPositive, "rows [feed per tooth in mm, kc in MPa], as in [[0.1, 1970]],");
  if (!rows) return;
  for (const auto key : {"kc1_1_MPa", "mc"})
    if (table.has(key))
      table.error_at_name(key, fmt::format("the material has kc_by_feed and {}; one of them was expected", key),
                          "key-unused");
  std::vector<CatalogueRow> catalogue;
  for (const auto& row : *rows) catalogue.push_back({row[0], row[1]});
  const auto [least, most] = std::ranges::minmax_element(catalogue, {}, &CatalogueRow::feed_per_tooth_mm);
  if (catalogue.empty() || least->feed_per_tooth_mm == most->feed_per_tooth_mm) {
    table.error_at("kc_by_feed", "kc_by_feed has a single feed per tooth; at least two different ones were expected",
                   "value-range");
    return;
  }
  const KienzlePair pair = kienzle_from_catalogue(catalogue);
  if (!kExponent.holds(pair.m))
    table.error_at("kc_by_feed",
                   fmt::format("kc_by_feed gives the exponent mc = {:.3f}; {} was expected (kc falls with the feed)",
                               pair.m, kExponent.wanted()),
                   "value-range");
  c.kc1_1_MPa = pair.k1_1_MPa;
  c.mc = pair.m;
}

/// One of the pairs beside the tangential one. Returns whether anything gave it.
bool read_pair(TomlTable& table, const char* k_key, const char* m_key, const char* ratio_key, const Coefficients& c,
               double& k, double& m) {
  const auto given = table.optional_number(k_key, kAnyNumber), exponent = table.optional_number(m_key, kExponent);
  const auto ratio = table.optional_number(ratio_key, kAnyNumber);
  if (table.has(ratio_key) && (table.has(k_key) || table.has(m_key)))
    table.error_at_name(ratio_key,
                        fmt::format("the material has {} and {}; one of them was expected", ratio_key,
                                    table.has(k_key) ? k_key : m_key),
                        "key-unused");
  if (ratio) {
    k = *ratio * c.kc1_1_MPa;
    m = c.mc;
  }
  if (given) k = *given;
  if (given && !exponent) m = c.mc;
  if (exponent) m = *exponent;
  return table.has(k_key) || table.has(ratio_key);
}

void start_pair(double cutting_MPa, double edge_N_per_mm, double h, double& k, double& m) {
  const double force = cutting_MPa * h + edge_N_per_mm;
  m = force != 0 ? std::clamp(edge_N_per_mm / force, 0.05, 0.7) : 0.25;
  k = force / std::pow(h, 1 - m);
}

}  // namespace

void KienzleLaw::start(const LinearForce& f, double h, Coefficients& c, EdgeTerms& e) {
  start_pair(f.cutting_MPa.tangential, f.edge_N_per_mm.tangential, h, c.kc1_1_MPa, c.mc);
  start_pair(f.cutting_MPa.radial, f.edge_N_per_mm.radial, h, c.kr1_1_MPa, c.mr);
  start_pair(f.cutting_MPa.axial, f.edge_N_per_mm.axial, h, c.ka1_1_MPa, c.ma);
  e = {};
}

void KienzleLaw::read(TomlTable& table, const MaterialPreset* preset, Coefficients& c) {
  if (!preset && !table.has("kc1_1_MPa") && !table.has("kc_by_feed"))
    table.missing("kc1_1_MPa", "kc1_1_MPa and mc, or kc_by_feed,");
  if (!preset && table.has("kc1_1_MPa") && !table.has("mc")) table.missing("mc", kExponent.wanted());
  if (const auto given = table.optional_number("kc1_1_MPa", kPositive)) c.kc1_1_MPa = *given;
  if (const auto given = table.optional_number("mc", kExponent)) c.mc = *given;
  read_catalogue(table, c);
  const bool radial = read_pair(table, "kr1_1_MPa", "mr", "krc_ratio", c, c.kr1_1_MPa, c.mr);
  read_pair(table, "ka1_1_MPa", "ma", "kac_ratio", c, c.ka1_1_MPa, c.ma);
  if (radial || (preset && preset->radial_known)) return;
  table.missing("krc_ratio", preset ? fmt::format("krc_ratio or kr1_1_MPa, for preset \"{}\" gives the tangential "
                                                  "force only,",
                                                  preset->name)
                                    : std::string("krc_ratio or kr1_1_MPa (radial force)"));
}

KienzlePair kienzle_from_catalogue(std::span<const CatalogueRow> rows) {
  assert(std::ranges::all_of(rows, [](const CatalogueRow& r) { return r.feed_per_tooth_mm > 0 && r.kc_MPa > 0; }));
  assert(std::ranges::any_of(
      rows, [&](const CatalogueRow& r) { return r.feed_per_tooth_mm != rows.front().feed_per_tooth_mm; }));
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

}  // namespace camber::machine
