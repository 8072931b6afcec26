// Tool tables of LinuxCNC; files and folders of tool libraries.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/job_keys.h"
#include "machine/library_words.h"

namespace camber::machine {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_at(const SourceText& source, std::size_t offset, std::string message, std::string check) {
  throw InputError({source.diagnostic(Severity::error, offset, std::move(message), std::move(check))});
}

/// One line of a table, its remark apart: words of a letter and a number.
std::optional<ToolProposal> table_line(const SourceText& source, std::size_t line, bool inch) {
  const std::string_view all = source.line(line);
  const std::string_view words = all.substr(0, all.find(';'));
  const auto offset = static_cast<std::size_t>(all.data() - source.text().data());
  std::optional<double> number, diameter;
  bool turning = false;  // front and back angle, orientation of the tip
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
    turning = turning || (std::string_view("IJQ").find(letter) != std::string_view::npos && *value != 0);
    at = end;
  }
  if (!number) return std::nullopt;
  if (!kToolNumber.holds(*number))
    fail_at(source, offset, fmt::format("T{} in a tool table; a whole number was expected", *number), "tool-table");
  const bool remark = all.find(';') != std::string_view::npos;
  ToolProposal tool = tool_of_words(remark ? all.substr(all.find(';') + 1) : std::string_view(), inch);
  tool.number = static_cast<int>(*number);
  tool.from = fmt::format("{}:{}", source.name(), line);
  if (diameter && *diameter > 0) {
    tool.diameter_mm = *diameter * (inch ? kMmPerInch : 1);
    tool.doubt.clear();
  }
  if (turning) {
    tool.kind = "turning";
    tool.type.reset();
    set_type_by_kind(tool);
  }
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

namespace {

std::string ending_of(const fs::path& path) {
  std::string out = path.extension().string();
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

void append(std::vector<ToolProposal>& out, std::vector<ToolProposal> more) {
  std::move(more.begin(), more.end(), std::back_inserter(out));
}

/// Whether a .json or .csv file, in a folder that has all sorts of them, begins as a tool library does.
bool is_library(const fs::path& path) {
  const std::string ending = ending_of(path);
  if (ending == ".json") {
    const std::string text = SourceText::read(path.string()).text();
    return text.find("\"data\"") != std::string::npos && text.find("\"geometry\"") != std::string::npos;
  }
  if (ending == ".csv") return SourceText::read(path.string()).line(1).find("(tool_index)") != std::string_view::npos;
  constexpr std::array<std::string_view, 6> kEndings{".tools", ".hsmlib", ".fctl", ".fctb", ".vtdb", ".tbl"};
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

std::vector<ToolProposal> read_folder(const std::string& path, bool inch, Diagnostics& diagnostics) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path, fs::directory_options::skip_permission_denied))
    if (entry.is_regular_file() && is_library(entry.path())) files.push_back(entry.path());
  if (files.empty())
    fail_on_file(path,
                 "no tool library in this folder; .json, .tools, .csv, .hsmlib, .fctl, .vtdb or .tbl was expected",
                 "tool-library");
  // Bits after the libraries that list them.
  std::ranges::sort(files, {}, [](const fs::path& f) { return std::pair(ending_of(f) == ".fctb", f); });
  std::vector<ToolProposal> out;
  std::set<std::string> listed;
  for (const fs::path& file : files) {
    if (listed.contains(file.lexically_normal().string())) continue;
    append(out, read_tools(file.string(), inch, diagnostics));
    for (const auto& tool : out) listed.insert(tool.from);
  }
  return out;
}

}  // namespace

std::vector<ToolProposal> read_tools(const std::string& path, bool inch, Diagnostics& diagnostics) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) return read_folder(path, inch, diagnostics);
  const std::string ending = ending_of(path);
  if (ending == ".hsmlib") return read_hsm_library(path);
  if (ending == ".json" || ending == ".tools") return read_fusion_library(path);
  if (ending == ".csv") return read_fusion_csv(path);
  if (ending == ".fctl") return read_freecad_library(path, diagnostics);
  if (ending == ".fctb") return {read_freecad_bit(path)};
  if (ending == ".vtdb") return read_vectric_library(path);
  if (ending == ".toml")
    fail_on_file(path, "is TOML, which a job names itself (tools = \"shop.toml\"); a tool library was expected",
                 "tool-library");
  return read_tool_table(path, inch);
}

std::string body_toml(const ToolProposal& tool) {
  const auto line = [](const char* key, double value) {
    return fmt::format("{} = {}\n", key, toml_number(value, kAsIs));
  };
  std::string out, rows;
  const double overhang_mm = tool.overhang_mm.value_or(kNoLimit);
  if (tool.flute_length_mm) {
    const double length_mm = std::min(*tool.flute_length_mm, overhang_mm);
    out += line("flute_length_mm", length_mm);
    const double neck_mm = std::min(tool.shoulder_length_mm.value_or(0), overhang_mm) - length_mm;
    if (tool.neck_diameter_mm && neck_mm > 0)
      out += line("neck_diameter_mm", *tool.neck_diameter_mm) + line("neck_length_mm", neck_mm);
    if (tool.shank_diameter_mm) out += line("shank_diameter_mm", *tool.shank_diameter_mm);
  }
  for (const auto& part : tool.holder)
    rows += fmt::format("{}[{}, {}, {}]", rows.empty() ? "" : ", ", toml_number(part.lower_diameter_mm, kAsIs),
                        toml_number(part.upper_diameter_mm, kAsIs), toml_number(part.length_mm, kAsIs));
  return rows.empty() ? out : out + fmt::format("holder_mm = [{}]\n", rows);
}

namespace {

/// Whether two descriptions may be of one cutter: what both tell of type and diameter agrees.
bool may_be_same(const ToolProposal& a, const ToolProposal& b) {
  constexpr double kRounding = 0.01;
  if (a.type && b.type && a.type != b.type) return false;
  return !a.diameter_mm || !b.diameter_mm || std::abs(*a.diameter_mm - *b.diameter_mm) <= kRounding * *a.diameter_mm;
}

}  // namespace

void add_tools(std::vector<ToolProposal>& known, const std::vector<ToolProposal>& library) {
  for (ToolProposal& tool : known) {
    const ToolProposal* other = nullptr;
    const ToolProposal* same = nullptr;
    for (const ToolProposal& candidate : library) {
      if (!tool.number || candidate.number != tool.number) continue;
      const ToolProposal*& kind = may_be_same(tool, candidate) ? same : other;
      if (!kind) kind = &candidate;
    }
    if (same)
      complete(tool, *same);
    else if (other && tool.doubt.empty())
      tool.doubt = fmt::format("{} has another cutter of this number: {}", other->from, other->what);
  }
  const std::size_t before = known.size();
  for (const ToolProposal& tool : library) {
    if (!tool.number) continue;
    const auto same = std::ranges::find(known, tool.number, &ToolProposal::number);
    if (same == known.end())
      known.push_back(tool);
    else if (static_cast<std::size_t>(same - known.begin()) < before)
      continue;
    else if (same->what == tool.what && may_be_same(*same, tool))
      complete(*same, tool);  // a cutter in several formats
    else
      same->doubt = fmt::format("{} is another cutter of this number: {}", tool.from, tool.what);
  }
}

}  // namespace camber::machine
