// Tools that are kept once, for many jobs: `tools = "shop.toml"` in a job, and `from` in its [tool.N] tables.
#include "machine/job_tables.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/job_keys.h"
#include "machine/toml_table.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

/// A TOML file with [tool.N] tables (N a number or a name; `name` may name a numbered one), a tool library, or a folder
/// of libraries.
class ToolShelf {
 public:
  /// inch: unit of a tool table of LinuxCNC. Throws InputError where the file cannot be read or is damaged.
  ToolShelf(const std::string& path, bool inch);

  /// Gives `table`, a [tool.N] with the key `from`, what it does not say itself. A tool that is missing, or a number or
  /// name of several different cutters, is an error at `from`, with the names that are nearest.
  void fill(TomlTable& table) const;

 private:
  struct Kept {
    std::optional<double> number;
    std::string name;   ///< empty: none
    std::string place;  ///< "tool.17"; "fusion.json, tool 3"
    std::string text;   ///< keys of a job, of a library's cutter: what tells two cutters apart
    const TomlNode* node = nullptr;
  };
  void add_tables(std::unique_ptr<TomlFile> file, Diagnostics& diagnostics);
  void add_library(const std::vector<ToolProposal>& tools);
  std::string nearest(const std::optional<double>& number, const std::string& name) const;

  std::string path_;
  std::vector<Kept> kept_;
  std::vector<std::unique_ptr<TomlFile>> files_;  ///< what the nodes point into
  std::string left_out_;                          ///< what a library says is missing
};

constexpr std::size_t kNearest = 3;

/// N of [tool.N]; nothing where it is a name.
std::optional<int> number_of(const std::string& key) {
  int number = 0;
  const auto [end, ec] = std::from_chars(key.data(), key.data() + key.size(), number);
  return ec == std::errc{} && end == key.data() + key.size() && number >= 0 ? std::optional(number) : std::nullopt;
}

std::string described(const std::optional<double>& number, const std::string& name) {
  if (!number) return fmt::format("\"{}\"", name);
  return name.empty() ? fmt::format("{}", *number) : fmt::format("{} \"{}\"", *number, name);
}

/// The keys of a [tool.N] table that a library's cutter tells.
std::string tool_toml(const ToolProposal& tool) {
  std::string out;
  const auto number = [&](const char* key, const std::optional<double>& value) {
    if (value) out += fmt::format("{} = {}\n", key, toml_number(*value, kAsIs));
  };
  if (tool.type) out += fmt::format("type = \"{}\"\n", kToolTypeWords[static_cast<std::size_t>(*tool.type)]);
  number("diameter_mm", tool.diameter_mm);
  if (tool.type == ToolType::bull) number("corner_radius_mm", tool.corner_radius_mm);
  if (tool.type == ToolType::chamfer) number("tip_diameter_mm", tool.tip_diameter_mm);
  if (tool.type == ToolType::chamfer || tool.type == ToolType::drill) number("point_angle_deg", tool.point_angle_deg);
  if (tool.type == ToolType::tapered_ball) number("taper_deg", tool.taper_deg);
  if (tool.flutes) out += fmt::format("flutes = {}\n", *tool.flutes);
  number("overhang_mm", tool.overhang_mm);
  number("youngs_modulus_GPa", tool.youngs_modulus_GPa);
  return out + body_toml(tool);
}

}  // namespace

ToolShelf::ToolShelf(const std::string& path, bool inch) : path_(path) {
  Diagnostics diagnostics;
  if (std::filesystem::path(path).extension() == ".toml") {
    add_tables(read_toml(path, "tools, as in [tool.1],", diagnostics), diagnostics);
    diagnostics.throw_if_errors();
    return;
  }
  add_library(read_tools(path, inch, diagnostics));
  for (const auto& d : diagnostics.all()) left_out_ += fmt::format("; {}", d.message);
}

void ToolShelf::add_tables(std::unique_ptr<TomlFile> file, Diagnostics& diagnostics) {
  TomlTable top = TomlTable::top(*file, diagnostics);
  if (auto tools = top.table("tool"))
    for (const auto& entry : tools->entries()) {
      if (entry.value.kind != TomlNode::Kind::table) {
        tools->error_at(entry.key, fmt::format("tool.{0}: a table [tool.{0}] was expected", entry.key), "value-type");
        continue;
      }
      Kept kept{.number = {}, .name = {}, .place = "tool." + entry.key, .text = {}, .node = &entry.value};
      if (const auto number = number_of(entry.key))
        kept.number = *number;
      else
        kept.name = entry.key;
      TomlTable table(entry.value, kept.place, diagnostics);
      if (table.has("name")) kept.name = table.text("name", "");
      kept_.push_back(std::move(kept));
    }
  else if (!top.has("tool"))
    top.missing("[tool.1]", "a table for each tool");
  top.finish();
  files_.push_back(std::move(file));
}

void ToolShelf::add_library(const std::vector<ToolProposal>& tools) {
  for (const ToolProposal& tool : tools) {
    Diagnostics diagnostics;
    Kept kept{.number = tool.number, .name = tool.what, .place = tool.from, .text = tool_toml(tool)};
    files_.push_back(parse_toml(SourceText(tool.from, kept.text), diagnostics));
    kept.node = &files_.back()->root;
    kept_.push_back(std::move(kept));
  }
}

std::string ToolShelf::nearest(const std::optional<double>& number, const std::string& name) const {
  std::vector<const Kept*> numbered, named;
  std::vector<std::string> words, out;
  for (const Kept& kept : kept_) {
    if (kept.number) numbered.push_back(&kept);
    if (!kept.name.empty()) words.push_back(kept.name);
  }
  if (!number) {
    for (const std::string& word : nearest_words(name, words, kNearest)) out.push_back(fmt::format("\"{}\"", word));
  } else {
    std::ranges::stable_sort(numbered, {}, [&](const Kept* k) { return std::abs(*k->number - *number); });
    for (std::size_t i = 0; i < std::min(kNearest, numbered.size()); ++i)
      out.push_back(described(numbered[i]->number, numbered[i]->name));
  }
  return out.empty() ? "" : fmt::format("; the nearest: {}", fmt::join(out, ", "));
}

void ToolShelf::fill(TomlTable& table) const {
  std::optional<double> number;
  std::string name;
  if (table.kind_of("from") == TomlNode::Kind::number)
    number = table.optional_number("from", kToolNumber);
  else
    name = table.text("from", "");
  if (!number && name.empty()) return;
  const std::string wanted = described(number, name);
  std::vector<const Kept*> found;
  for (const Kept& kept : kept_)
    if (number ? kept.number == number : kept.name == name)
      if (std::ranges::none_of(found, [&](const Kept* k) { return !k->text.empty() && k->text == kept.text; }))
        found.push_back(&kept);
  if (found.size() == 1) return table.fall_back_on(*found.front()->node, found.front()->place);
  std::string others;
  for (const Kept* kept : found)
    others += fmt::format("{}{}", others.empty() ? "" : ", ", number ? "\"" + kept->name + "\"" : kept->place);
  table.error_at(
      "from",
      found.empty() ? fmt::format("from = {}: {} has no such tool{}{}", wanted, path_, nearest(number, name), left_out_)
                    : fmt::format("from = {}: {} has {} different tools of this {} ({}); one was expected", wanted,
                                  path_, found.size(), number ? "number" : "name", others),
      "tool-missing");
}

namespace {

/// Errors within a file of tools are reported there; that it is missing is reported at the job's line.
void add_problem(TomlTable& top, const InputError& problem, Diagnostics& diagnostics) {
  for (const Diagnostic& d : problem.diagnostics())
    if (d.check == "file-missing" || d.check == "file-unreadable")
      top.error_at("tools",
                   fmt::format("tools: {}: {} (paths are relative to the job's folder)", d.location.file, d.message),
                   d.check);
    else
      diagnostics.add(d);
}

/// False where nothing stands behind `from`: then nothing more can be asked of the tool.
bool take_from(const std::optional<ToolShelf>& shelf, bool named, TomlTable& tool) {
  tool.ignore("from");
  if (shelf)
    shelf->fill(tool);
  else if (!named)
    tool.error_at_name(
        "from",
        "from names a tool kept elsewhere, but no file: tools = \"shop.toml\" was expected at the top of "
        "the job",
        "key-missing");
  return tool.has_fallback();
}

}  // namespace

void read_tools(TomlTable& top, const std::filesystem::path& folder, bool inch, std::map<int, Tool>& tools,
                Diagnostics& diagnostics) {
  std::optional<ToolShelf> shelf;
  const std::string kept = top.text("tools", "");
  try {
    if (!kept.empty()) shelf.emplace((folder / kept).lexically_normal().string(), inch);
  } catch (const InputError& problem) {
    add_problem(top, problem, diagnostics);
  }
  auto tables = top.table("tool");
  if (!tables) return;
  for (const auto& key : tables->keys()) {
    auto tool = tables->table(key);
    const auto number = number_of(key);
    if (!number)
      tables->error_at_name(key, fmt::format("[tool.{}]: a tool number was expected, as in [tool.1] for T1", key),
                            "tool-number");
    else if (tool && tool->has("from") && !take_from(shelf, !kept.empty(), *tool))
      tools[*number].number = *number;
    else if (tool)
      tools.emplace(*number, read_tool(*tool, *number));
  }
}

}  // namespace camber::machine
