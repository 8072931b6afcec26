#include <toml++/toml.h>

#include "machine/toml_table.h"

namespace camber::machine {
namespace {

std::size_t offset_of(const SourceText& source, const toml::source_position& at) {
  const std::string_view line = source.line(at.line);
  if (line.data() == nullptr) return source.text().size();
  const std::size_t column = at.column > 0 ? at.column - 1 : 0;
  return static_cast<std::size_t>(line.data() - source.text().data()) + std::min<std::size_t>(column, line.size());
}

TomlNode convert(const SourceText& source, const toml::node& from);

void convert_entries(const SourceText& source, const toml::table& from, TomlNode& into) {
  for (const auto& [key, value] : from)
    into.entries.push_back({std::string(key.str()), offset_of(source, key.source().begin), convert(source, value)});
}

TomlNode convert(const SourceText& source, const toml::node& from) {
  TomlNode node;
  node.source = &source;
  node.offset = offset_of(source, from.source().begin);
  if (const auto* table = from.as_table()) {
    node.kind = TomlNode::Kind::table;
    convert_entries(source, *table, node);
  } else if (const auto* array = from.as_array()) {
    node.kind = TomlNode::Kind::array;
    for (const auto& item : *array) node.items.push_back(convert(source, item));
  } else if (const auto* text = from.as_string()) {
    node.kind = TomlNode::Kind::text;
    node.text = text->get();
  } else if (from.is_number()) {
    node.kind = TomlNode::Kind::number;
    node.number = from.is_integer() ? static_cast<double>(from.as_integer()->get()) : from.as_floating_point()->get();
  } else if (const auto* flag = from.as_boolean()) {
    node.kind = TomlNode::Kind::boolean;
    node.boolean = flag->get();
  }
  return node;
}

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == std::string_view::npos; }

/// The parser's sentence, without the prefix that names its inner function.
std::string reason(std::string_view description) {
  const std::string_view prefix = "Error while parsing ";
  if (description.substr(0, prefix.size()) == prefix) description.remove_prefix(prefix.size());
  return std::string(description);
}

}  // namespace

std::unique_ptr<TomlFile> parse_toml(SourceText source, Diagnostics& diagnostics) {
  auto file = std::make_unique<TomlFile>();
  file->source = std::move(source);
  file->root.kind = TomlNode::Kind::table;
  file->root.source = &file->source;
  try {
    const toml::table root = toml::parse(file->source.text(), file->source.name());
    convert_entries(file->source, root, file->root);
  } catch (const toml::parse_error& problem) {
    diagnostics.add(file->source.diagnostic(Severity::error, offset_of(file->source, problem.source().begin),
                                            "not valid TOML: " + reason(problem.description()), "toml-syntax"));
  }
  return file;
}

std::unique_ptr<TomlFile> parse_toml(SourceText source, const std::string& contents, Diagnostics& diagnostics) {
  if (is_blank(source.text()))
    diagnostics.add(
        {Severity::error, {source.name(), 0, 0}, "the file is empty; " + contents + " was expected", "file-empty", {}});
  return parse_toml(std::move(source), diagnostics);
}

std::unique_ptr<TomlFile> read_toml(const std::string& path, const std::string& contents, Diagnostics& diagnostics) {
  return parse_toml(SourceText::read(path), contents, diagnostics);
}

}  // namespace camber::machine
