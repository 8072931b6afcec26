#include "machine/assumptions.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "machine/machine_presets.h"
#include "machine/material_presets.h"
#include "machine/toml_table.h"

namespace camber::machine {
namespace {

constexpr std::string_view kTypicalMark = "[typical-value]";

/// The file's tables; null where they cannot be read, which their reader has said. Throws where the file, that could be
/// opened before, no longer can: what is assumed would not be told.
std::unique_ptr<TomlFile> file_of(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec)) return nullptr;
  try {
    Diagnostics ignored;
    auto file = read_toml(path, "TOML", ignored);
    return ignored.has_errors() ? nullptr : std::move(file);
  } catch (const InputError& problem) {
    for (const Diagnostic& d : problem.diagnostics())
      if (d.check == "file-unreadable") throw;
    return nullptr;
  }
}

const TomlNode* value_at(const TomlNode& table, std::string_view key) {
  for (const TomlNode::Entry& entry : table.entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

std::vector<std::string> assumed_of(const TomlNode& table) {
  std::vector<std::string> out;
  if (const TomlNode* list = value_at(table, "assumed"))
    for (const TomlNode& item : list->items)
      if (item.kind == TomlNode::Kind::text) out.push_back(item.text);
  return out;
}

std::map<std::string, std::vector<std::string>> assumed_in(const TomlNode& root) {
  std::map<std::string, std::vector<std::string>> out;
  const auto take = [&](const std::string& name, const TomlNode& table) {
    if (auto keys = assumed_of(table); !keys.empty()) out[name] = std::move(keys);
  };
  for (const char* name : {"material", "stock"})
    if (const TomlNode* table = value_at(root, name)) take(name, *table);
  if (const TomlNode* tools = value_at(root, "tool"))
    for (const TomlNode::Entry& tool : tools->entries) take("tool." + tool.key, tool.value);
  return out;
}

}  // namespace

std::map<std::string, std::vector<std::string>> assumed_keys(const std::string& job_path) {
  const auto file = file_of(job_path);
  return file ? assumed_in(file->root) : std::map<std::string, std::vector<std::string>>{};
}

bool is_assumed(const std::map<std::string, std::vector<std::string>>& keys, const std::string& table,
                std::string_view key) {
  const auto found = keys.find(table);
  return found != keys.end() && std::ranges::find(found->second, key) != found->second.end();
}

std::vector<std::string> assumptions(const Machine& machine) {
  std::string preset;
  if (is_preset(machine.path)) {
    preset = machine.path;
  } else if (const auto file = file_of(machine.path)) {
    const TomlNode* assumed = value_at(file->root, "assumed");
    if (assumed) preset = assumed->text;
  }
  if (preset.empty()) return {};
  return {fmt::format("machine {}, typical values of its class", preset)};
}

std::vector<std::string> assumptions(const Job& job) {
  std::vector<std::string> out = assumptions(job.machine);
  const auto file = file_of(job.path);
  if (!file) return out;
  auto keys = assumed_in(file->root);
  const TomlNode* material = value_at(file->root, "material");
  const TomlNode* name = material ? value_at(*material, "preset") : nullptr;
  if (const auto at = keys.find("material"); at != keys.end()) {
    const MaterialPreset* preset = find_preset(job.material.preset);
    out.push_back(fmt::format("material {}", fmt::join(at->second, ", ")));
    if (preset)
      out.back() = fmt::format("material {} ({}, within {:g} %)", preset->name, fmt::join(at->second, ", "),
                               preset->scatter_percent);
  }
  if (name)
    if (const std::string note = find_material(name->text).note; !note.empty()) out.push_back("material " + note);
  for (const auto& [number, tool] : job.tools)
    if (const auto at = keys.find(fmt::format("tool.{}", number)); at != keys.end())
      out.push_back(fmt::format("T{} {}", number, fmt::join(at->second, ", ")));
  for (const auto& [number, tool] : job.tools)
    if (!tool.typical.empty())
      out.push_back(fmt::format("T{} {} {}", number, fmt::join(tool.typical, ", "), kTypicalMark));
  if (const auto at = keys.find("stock"); at != keys.end())
    out.push_back(fmt::format("stock {}", fmt::join(at->second, ", ")));
  return out;
}

std::string assumptions_text(const std::vector<std::string>& assumptions) {
  std::vector<std::string> assumed;
  std::string notes;
  for (const std::string& a : assumptions) {
    if (a.ends_with(kTypicalMark))
      notes += fmt::format("note: {}\n", a);
    else
      assumed.push_back(a);
  }
  if (assumed.empty()) return notes;
  return fmt::format("warning: assumed, not given: {} [assumed]\n", fmt::join(assumed, "; ")) + notes;
}

std::string with_assumptions(std::string json, const std::vector<std::string>& assumptions) {
  if (assumptions.empty()) return json;
  return json.insert(json.find('{') + 1, fmt::format("\n  \"assumed\": {},", nlohmann::json(assumptions).dump()));
}

}  // namespace camber::machine
