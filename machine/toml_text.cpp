#include "machine/toml_text.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace camber::machine {
namespace {

std::string quoted_toml(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (c == '\n')
      out += "\\n";
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

bool is_bare(std::string_view key) {
  return !key.empty() && std::ranges::all_of(key, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::string key_text(std::string_view key) { return is_bare(key) ? std::string(key) : quoted_toml(key); }

std::string number_toml(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{}", value);
}

std::vector<const TomlNode::Entry*> in_order(const TomlNode& table) {
  std::vector<const TomlNode::Entry*> out;
  for (const auto& entry : table.entries) out.push_back(&entry);
  std::ranges::stable_sort(out, {}, &TomlNode::Entry::key_offset);
  return out;
}

void write_table(const TomlNode& table, const std::string& name, std::string& out) {
  const auto entries = in_order(table);
  const auto is_table = [](const TomlNode::Entry* e) { return e->value.kind == TomlNode::Kind::table; };
  if (!name.empty() && (entries.empty() || !std::ranges::all_of(entries, is_table)))
    out += fmt::format("{}[{}]\n", out.empty() ? "" : "\n", name);
  for (const auto* e : entries)
    if (!is_table(e)) out += fmt::format("{} = {}\n", key_text(e->key), toml_value(e->value));
  for (const auto* e : entries)
    if (is_table(e)) write_table(e->value, (name.empty() ? "" : name + ".") + key_text(e->key), out);
}

}  // namespace

std::string toml_value(const TomlNode& value) {
  std::string out;
  switch (value.kind) {
    case TomlNode::Kind::text:
      return quoted_toml(value.text);
    case TomlNode::Kind::number:
      return number_toml(value.number);
    case TomlNode::Kind::boolean:
      return value.boolean ? "true" : "false";
    case TomlNode::Kind::array:
      for (const TomlNode& item : value.items) out += (out.empty() ? "" : ", ") + toml_value(item);
      return "[" + out + "]";
    case TomlNode::Kind::table:
      for (const auto* e : in_order(value))
        out += fmt::format("{} {} = {}", out.empty() ? "" : ",", key_text(e->key), toml_value(e->value));
      return "{" + out + (out.empty() ? "}" : " }");
    case TomlNode::Kind::other:
      break;
  }
  return "\"\"";
}

std::string toml_text(const TomlNode& table) {
  std::string out;
  write_table(table, "", out);
  return out;
}

std::vector<std::string> key_parts(std::string_view dotted) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= dotted.size();) {
    const std::size_t dot = std::min(dotted.find('.', at), dotted.size());
    out.emplace_back(dotted.substr(at, dot - at));
    at = dot + 1;
  }
  return out;
}

const TomlNode* value_at(const TomlNode& table, std::span<const std::string> path) {
  const TomlNode* node = &table;
  for (const std::string& key : path) {
    const auto found = std::ranges::find(node->entries, key, &TomlNode::Entry::key);
    if (found == node->entries.end()) return nullptr;
    node = &found->value;
  }
  return node;
}

bool set_value(TomlNode& table, std::span<const std::string> path, const TomlNode& value) {
  if (table.kind != TomlNode::Kind::table) return false;
  if (path.empty()) {
    if (value.kind != TomlNode::Kind::table) return false;
    for (const auto& e : value.entries)
      if (!set_value(table, std::span(&e.key, 1), e.value)) return false;
    return true;
  }
  auto found = std::ranges::find(table.entries, path.front(), &TomlNode::Entry::key);
  const bool last = path.size() == 1;
  if (found == table.entries.end()) {
    table.entries.push_back({path.front(), std::numeric_limits<std::size_t>::max(), {}});
    found = std::prev(table.entries.end());
    found->value.kind = TomlNode::Kind::table;
    if (last) return found->value = value, true;
  }
  const bool merges = value.kind == TomlNode::Kind::table && found->value.kind == TomlNode::Kind::table;
  if (last && !merges) return found->value = value, true;
  return set_value(found->value, path.subspan(1), value);
}

}  // namespace camber::machine
