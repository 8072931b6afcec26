#include "machine/material_reader.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/job_keys.h"
#include "machine/material_presets.h"

namespace camber::machine {
namespace {

constexpr std::array<std::string_view, 2> kLawWords{"linear", "kienzle"};
constexpr std::array<std::string_view, 9> kKienzleOnly{"kc1_1_MPa", "mc",        "kr1_1_MPa", "mr",        "ka1_1_MPa",
                                                       "ma",        "krc_ratio", "kac_ratio", "kc_by_feed"};
constexpr std::array<std::string_view, 3> kLinearOnly{"ktc_MPa", "krc_MPa", "kac_MPa"};

const MaterialPreset* read_preset(TomlTable& table) {
  if (!table.has("preset")) return nullptr;
  const std::string name = table.text("preset", "");
  const MaterialPreset* preset = find_preset(name);
  if (preset != nullptr || name.empty()) return preset;
  std::vector<std::string> names;
  for (const auto& p : material_presets()) names.emplace_back(p.name);
  const std::string near = nearest_word(name, names);
  table.error_at("preset",
                 fmt::format("there is no material preset \"{}\"{}; one of {} was expected", name,
                             near.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", near), fmt::join(names, ", ")),
                 "material-preset");
  return nullptr;
}

ForceLaw read_law(TomlTable& table, const MaterialPreset* preset) {
  const bool shown = table.has("kc1_1_MPa") || table.has("kc_by_feed");
  const ForceLaw fallback = preset ? preset->material.law : shown ? ForceLaw::kienzle : ForceLaw::linear;
  const auto law = static_cast<ForceLaw>(table.choice("law", kLawWords, static_cast<std::size_t>(fallback)));
  if (preset && law != preset->material.law)
    table.error_at("law",
                   fmt::format("law is \"{}\", but the values of preset \"{}\" belong to law \"{}\"",
                               kLawWords[static_cast<std::size_t>(law)], preset->name,
                               kLawWords[static_cast<std::size_t>(preset->material.law)]),
                   "material-law");
  return law;
}

void refuse(TomlTable& table, std::span<const std::string_view> keys, ForceLaw law) {
  for (const auto key : keys) {
    if (!table.has(key)) continue;
    table.ignore(key);
    table.error_at_name(key,
                        fmt::format("{} does not belong to law \"{}\"", key, kLawWords[static_cast<std::size_t>(law)]),
                        "key-unused");
  }
}

void read_catalogue(TomlTable& table, Material& material) {
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
  material.kc1_1_MPa = pair.k1_1_MPa;
  material.mc = pair.m;
}

/// One of the pairs beside the tangential one. Returns whether anything gave it.
bool read_pair(TomlTable& table, const char* k_key, const char* m_key, const char* ratio_key, const Material& material,
               double& k, double& m) {
  const auto given = table.optional_number(k_key, kAnyNumber), exponent = table.optional_number(m_key, kExponent);
  const auto ratio = table.optional_number(ratio_key, kAnyNumber);
  if (table.has(ratio_key) && (table.has(k_key) || table.has(m_key)))
    table.error_at_name(ratio_key,
                        fmt::format("the material has {} and {}; one of them was expected", ratio_key,
                                    table.has(k_key) ? k_key : m_key),
                        "key-unused");
  if (ratio) {
    k = *ratio * material.kc1_1_MPa;
    m = material.mc;
  }
  if (given) k = *given;
  if (given && !exponent) m = material.mc;
  if (exponent) m = *exponent;
  return table.has(k_key) || table.has(ratio_key);
}

void read_kienzle(TomlTable& table, const MaterialPreset* preset, Material& material) {
  refuse(table, kLinearOnly, ForceLaw::kienzle);
  if (!preset && !table.has("kc1_1_MPa") && !table.has("kc_by_feed"))
    table.missing("kc1_1_MPa", "kc1_1_MPa and mc, or kc_by_feed,");
  if (!preset && table.has("kc1_1_MPa") && !table.has("mc")) table.missing("mc", kExponent.wanted());
  read_numbers<Material>(table, kKienzleKeys, material);
  read_catalogue(table, material);
  const bool radial = read_pair(table, "kr1_1_MPa", "mr", "krc_ratio", material, material.kr1_1_MPa, material.mr);
  read_pair(table, "ka1_1_MPa", "ma", "kac_ratio", material, material.ka1_1_MPa, material.ma);
  if (radial || (preset && preset->radial_known)) return;
  table.missing("krc_ratio", preset ? fmt::format("krc_ratio or kr1_1_MPa, for preset \"{}\" gives the tangential "
                                                  "force only,",
                                                  preset->name)
                                    : std::string("krc_ratio or kr1_1_MPa (radial force)"));
}

}  // namespace

Material read_material(TomlTable table) {
  const MaterialPreset* preset = read_preset(table);
  Material material = preset ? preset->material : Material{};
  material.law = read_law(table, preset);
  const bool preset_refused = table.has("preset") && !preset;
  if (preset_refused) {
    for (const auto key : kKienzleOnly) table.ignore(key);
    for (const auto key : kLinearOnly) table.ignore(key);
  } else if (material.law == ForceLaw::kienzle) {
    read_kienzle(table, preset, material);
  } else {
    refuse(table, kKienzleOnly, ForceLaw::linear);
    for (const std::string_view key : {"ktc_MPa", "krc_MPa"})
      if (!preset && !table.has(key)) table.missing(key, kNotNegative.wanted());
    read_numbers<Material>(table, kLinearKeys, material);
  }
  read_numbers<Material>(table, kEdgeKeys, material);
  table.finish();
  return material;
}

Material read_material_table(TomlTable table, const std::string& folder, Diagnostics& diagnostics) {
  if (!table.has("file")) return read_material(std::move(table));
  const std::string given = table.text("file", "");
  const std::string path = (std::filesystem::path(folder) / given).lexically_normal().string();
  table.finish();
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec)) {
    table.error_at("file", fmt::format("file: no such file: {} (paths count from the job's folder)", path),
                   "file-missing");
    return {};
  }
  const auto file = read_toml(path, "a [material] table", diagnostics);
  TomlTable top = TomlTable::top(*file, diagnostics);
  const auto material = top.table("material");
  if (!material && !top.has("material") && !file->root.entries.empty())
    top.missing("[material]", "a table with the specific cutting forces ktc_MPa, krc_MPa ...");
  top.finish();
  return material ? read_material(*material) : Material{};
}

std::vector<double Material::*> coefficient_fields(ForceLaw law) {
  std::vector<double Material::*> out;
  const auto add = [&](const auto& keys) {
    for (const auto& k : keys) out.push_back(k.field);
  };
  if (law == ForceLaw::linear) {
    add(kLinearKeys);
  } else {
    add(kKienzleKeys);
    add(kKienzleSideKeys);
  }
  add(kEdgeKeys);
  return out;
}

std::string material_text(const Material& m) {
  std::string out;
  if (!m.preset.empty()) {
    const MaterialPreset* p = find_preset(m.preset);
    if (p) out += fmt::format("# from preset \"{}\": {}; range: {}\n", p->name, p->source, p->range);
  }
  if (m.law == ForceLaw::linear) {
    out += toml_lines<Material>(kLinearKeys, m);
  } else {
    out += toml_line("law", kLawWords[1]) + toml_lines<Material>(kKienzleKeys, m);
    out += toml_lines<Material>(kKienzleSideKeys, m);
  }
  return out + toml_lines<Material>(kEdgeKeys, m);
}

}  // namespace camber::machine
