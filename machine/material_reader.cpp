#include "machine/material_reader.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/force_law.h"
#include "machine/material_presets.h"
#include "machine/number_key.h"

namespace camber::machine {
namespace {

const MaterialPreset* read_preset(TomlTable& table) {
  if (!table.has("preset")) return nullptr;
  const std::string name = table.text("preset", "");
  const MaterialPreset* preset = find_material(name).preset;
  if (preset == nullptr) table.error_at("preset", unknown_material(name), "material-preset");
  return preset;
}

/// The law other than the default one that the keys show, or the default.
ForceLaw shown_law(const TomlTable& table) {
  const auto laws = force_laws();
  for (std::size_t i = 1; i < laws.size(); ++i)
    for (const auto key : laws[i].shown_by)
      if (table.has(key)) return static_cast<ForceLaw>(i);
  return ForceLaw{};
}

ForceLaw read_law(TomlTable& table, const MaterialPreset* preset) {
  const ForceLaw fallback = preset ? preset->material.law : shown_law(table);
  const auto law = static_cast<ForceLaw>(table.choice("law", ForceLaws::words, static_cast<std::size_t>(fallback)));
  if (preset && law != preset->material.law)
    table.error_at("law",
                   fmt::format("law is \"{}\", but the values of preset \"{}\" belong to law \"{}\"",
                               description(law).word, preset->name, description(preset->material.law).word),
                   "material-law");
  return law;
}

/// Keys of the other laws.
void refuse_others(TomlTable& table, ForceLaw law, const MaterialPreset* preset) {
  const ForceLawDescription& own = description(law);
  const std::string of_preset =
      preset ? fmt::format(", which preset \"{}\" has; its keys are {}", preset->name, fmt::join(own.keys, ", ")) : "";
  for (const auto& other : force_laws()) {
    if (&other == &own) continue;
    for (const auto key : other.keys) {
      if (!table.has(key)) continue;
      table.ignore(key);
      table.error_at_name(key, fmt::format("{} does not belong to law \"{}\"{}", key, own.word, of_preset),
                          "key-unused");
    }
  }
}

}  // namespace

Material read_material(TomlTable table) {
  const MaterialPreset* preset = read_preset(table);
  Material material = preset ? preset->material : Material{};
  material.law = read_law(table, preset);
  const bool preset_refused = table.has("preset") && !preset;
  if (preset_refused) {
    for (const auto& law : force_laws())
      for (const auto key : law.keys) table.ignore(key);
  } else {
    refuse_others(table, material.law, preset);
    description(material.law).read(table, preset, material);
  }
  for (const auto& c : kEdgeTerms)
    if (const auto value = table.optional_number(c.key, c.range)) material.*c.field = *value;
  table.ignore("assumed");  // assumptions.h
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
    table.error_at("file", fmt::format("file: no such file: {} (paths are relative to the job's folder)", path),
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
  for (const auto& c : description(law).coefficients) out.push_back(c.field);
  return out;
}

std::string material_text(const Material& m) {
  std::string out;
  if (!m.preset.empty()) {
    const MaterialPreset* p = find_preset(m.preset);
    if (p) out += fmt::format("# from preset \"{}\": {}; range: {}\n", p->name, p->source, p->range);
  }
  if (m.law != ForceLaw{}) out += toml_line("law", description(m.law).word);
  for (const auto& c : description(m.law).coefficients) out += toml_line(c.key, m.*c.field, kAsIs);
  return out;
}

}  // namespace camber::machine
