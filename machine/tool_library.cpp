// Tool tables of LinuxCNC and tool libraries of Fusion.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/library_words.h"
#include "machine/tool_proposal.h"
#include "machine/zip_entry.h"

namespace camber::machine {
namespace {

using nlohmann::json;

[[noreturn]] void fail_at(const SourceText& source, std::size_t offset, std::string message, std::string check) {
  throw InputError({source.diagnostic(Severity::error, offset, std::move(message), std::move(check))});
}

/// One line of a table, its remark apart: words of a letter and a number.
std::optional<ToolProposal> table_line(const SourceText& source, std::size_t line, bool inch) {
  const std::string_view all = source.line(line);
  const std::string_view words = all.substr(0, all.find(';'));
  const auto offset = static_cast<std::size_t>(all.data() - source.text().data());
  std::optional<double> number, diameter;
  for (std::size_t at = 0; at < words.size();) {
    if (std::isspace(static_cast<unsigned char>(words[at]))) {
      ++at;
      continue;
    }
    const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(words[at])));
    const std::size_t end = std::min(words.find_first_of(" \t\r", at), words.size());
    const auto value = parse_number(words.substr(at + 1, end - at - 1));
    if (!std::isalpha(static_cast<unsigned char>(letter)) || !value)
      fail_at(source, offset + at,
              fmt::format("\"{}\" in a tool table; a letter with a number was expected, as in T1 P1 D6.0 ;remark",
                          words.substr(at, end - at)),
              "tool-table");
    if (letter == 'T') number = value;
    if (letter == 'D') diameter = value;
    at = end;
  }
  if (!number) return std::nullopt;
  if (*number < 0 || *number > 1e6 || *number != std::floor(*number))
    fail_at(source, offset, fmt::format("T{} in a tool table; a whole number was expected", *number), "tool-table");
  const bool remark = all.find(';') != std::string_view::npos;
  ToolProposal tool = tool_of_words(remark ? all.substr(all.find(';') + 1) : std::string_view(), inch);
  tool.number = static_cast<int>(*number);
  tool.from = fmt::format("{}:{}", source.name(), line);
  if (diameter && *diameter > 0) {
    tool.diameter_mm = *diameter * (inch ? kMmPerInch : 1);
    tool.doubt.clear();
  }
  return tool;
}

std::optional<double> number_at(const json& object, const char* key, double unit) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_number()) return std::nullopt;
  const double value = at->get<double>() * unit;
  return value > 0 ? std::optional(value) : std::nullopt;
}

std::string text_at(const json& object, const char* key) {
  const auto at = object.find(key);
  return at != object.end() && at->is_string() ? at->get<std::string>() : std::string();
}

std::optional<ToolProposal> library_tool(const json& entry, const std::string& path, std::size_t index) {
  if (!entry.is_object()) return std::nullopt;
  const json none = json::object();
  const auto part = [&](const char* key) -> const json& {
    const auto at = entry.find(key);
    return at != entry.end() && at->is_object() ? *at : none;
  };
  const json& geometry = part("geometry");
  const json& post = part("post-process");
  const auto number = post.find("number");
  if (number == post.end() || !number->is_number_integer()) return std::nullopt;
  const double unit = text_at(entry, "unit") == "inches" ? kMmPerInch : 1;
  ToolProposal tool;
  tool.number = number->get<int>();
  tool.from = fmt::format("{}, tool {}", path, index + 1);
  tool.what = text_at(entry, "description");
  if (tool.what.empty()) tool.what = text_at(entry, "type");
  tool.type = type_of_library(text_at(entry, "type"));
  tool.diameter_mm = number_at(geometry, "DC", unit);
  if (tool.type == ToolType::bull) tool.corner_radius_mm = number_at(geometry, "RE", unit);
  tool.flute_length_mm = number_at(geometry, "LCF", unit);
  tool.overhang_mm = number_at(geometry, "LB", unit);
  tool.shank_diameter_mm = number_at(geometry, "SFDM", unit);
  if (const auto flutes = number_at(geometry, "NOF", 1)) tool.flutes = static_cast<int>(std::lround(*flutes));
  tool.youngs_modulus_GPa = modulus_of_library_GPa(text_at(entry, "BMC"));
  return tool;
}

}  // namespace

std::vector<ToolProposal> read_tool_table(const std::string& path, bool inch) {
  const SourceText source = SourceText::read(path);
  std::vector<ToolProposal> out;
  for (std::size_t line = 1; line <= source.line_count(); ++line)
    if (auto tool = table_line(source, line, inch)) out.push_back(std::move(*tool));
  return out;
}

std::vector<ToolProposal> read_tool_library(const std::string& path) {
  const bool packed = std::filesystem::path(path).extension() == ".tools";
  const SourceText source = packed ? read_zip_entry(path, "tools.json", "tool-library") : SourceText::read(path);
  json library;
  try {
    library = json::parse(source.text());
  } catch (const json::parse_error& e) {
    fail_at(source, e.byte > 0 ? std::min<std::size_t>(e.byte - 1, source.text().size()) : 0,
            "this is not JSON; a tool library of Fusion (File, Export, JSON) was expected", "tool-library");
  }
  const auto data = library.is_object() ? library.find("data") : library.end();
  if (!library.is_object() || data == library.end() || !data->is_array())
    fail_on_file(path, "has no list \"data\"; a tool library of Fusion (File, Export, JSON) was expected",
                 "tool-library");
  std::vector<ToolProposal> out;
  for (std::size_t i = 0; i < data->size(); ++i)
    if (auto tool = library_tool((*data)[i], path, i)) out.push_back(std::move(*tool));
  return out;
}

std::vector<ToolProposal> read_tools(const std::string& path, bool inch) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".hsmlib") return read_hsm_library(path);
  return ending == ".json" || ending == ".tools" ? read_tool_library(path) : read_tool_table(path, inch);
}

}  // namespace camber::machine
