// Tools as the comments of CAM systems describe them.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

constexpr double kLargestBareInch = 3;
constexpr std::size_t kLongestComment = 400;  // std::regex needs stack for each character

std::string upper(std::string_view text) {
  std::string out(text.substr(0, kLongestComment));
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

bool has(const std::string& text, std::string_view word) { return text.find(word) != std::string::npos; }

/// "6.", ".093", "3/4", "1-1/2"; nothing where it is none of these.
std::optional<double> size_of(const std::string& text) {
  static const std::regex kFraction(R"((?:(\d+)-)?(\d+)/(\d+))"), kDecimal(R"((\d+\.?\d*|\.\d+))");
  std::smatch m;
  if (std::regex_match(text, m, kFraction)) {
    const double below = std::stod(m[3].str());
    if (below == 0) return std::nullopt;
    return (m[1].matched ? std::stod(m[1].str()) : 0) + std::stod(m[2].str()) / below;
  }
  if (std::regex_match(text, m, kDecimal)) return std::stod(text);
  return std::nullopt;
}

std::optional<ToolType> type_of(const std::string& words, const ToolProposal& tool) {
  if (has(words, "TAPER") && has(words, "BALL")) return ToolType::tapered_ball;
  if (has(words, "BALL") || has(words, "SPHERICAL")) return ToolType::ball;
  if (has(words, "CHAMFER") || has(words, "COUNTERSINK")) return ToolType::chamfer;
  if (has(words, "DRILL") || has(words, "SPOT")) return ToolType::drill;
  if (has(words, "TAP ") || has(words, "REAM") || has(words, "THREAD")) return std::nullopt;
  if (has(words, "BULL") || tool.corner_radius_mm.value_or(0) > 0) return ToolType::bull;
  if (has(words, "FLAT") || has(words, "END MILL") || has(words, "ENDMILL") || has(words, "FACE MILL"))
    return ToolType::flat;
  return std::nullopt;
}

/// The bare size that Mastercam begins with; in inches where it has the sign.
void read_bare_size(const std::string& words, bool inch, ToolProposal& tool) {
  static const std::regex kSize(R"(^[\s|]*([\d./-]*\d\.?)(\s*MM|\s*")?(?=[\s|]|$))");
  std::smatch m;
  if (!std::regex_search(words, m, kSize)) return;
  const auto size = size_of(m[1].str());
  if (!size) return;
  const std::string unit = m[2].str();
  const bool says_mm = has(unit, "MM"), says_inch = has(unit, "\"");
  bool in_inch = says_inch || (inch && !says_mm);
  if (in_inch && !says_inch && *size >= kLargestBareInch) {
    in_inch = false;
    tool.doubt = fmt::format("the size {} has no unit in a program in inches; taken as mm", m[1].str());
  }
  tool.diameter_mm = *size * (in_inch ? kMmPerInch : 1);
}

std::optional<double> named_size(const std::string& words, const std::regex& name, double unit_mm) {
  std::smatch m;
  if (!std::regex_search(words, m, name)) return std::nullopt;
  const auto size = size_of(m[1].str());
  return size ? std::optional<double>(*size * unit_mm) : std::nullopt;
}

}  // namespace

ToolProposal tool_of_words(std::string_view text, bool inch) {
  static const std::regex kDiameter(R"((?:\bD\s*=\s*|\bDIA[\s.=-]*)([\d./]*\d\.?))"),
      kCorner(R"((?:\bCR\s*=\s*|\bRAD[\s.=-]+|\bR\s*=\s*)([\d./]*\d\.?))"), kCornerAfter(R"(([\d./]*\d\.?)\s*RAD\b)"),
      kFlutes(R"((\d+)\s*-?\s*FL(?:UTES?|T)?\b)");
  const std::string words = upper(text);
  const double unit_mm = inch ? kMmPerInch : 1;
  ToolProposal tool;
  tool.what = std::string(text);
  tool.diameter_mm = named_size(words, kDiameter, unit_mm);
  if (!tool.diameter_mm) read_bare_size(words, inch, tool);
  tool.corner_radius_mm = named_size(words, kCorner, unit_mm);
  if (!tool.corner_radius_mm) tool.corner_radius_mm = named_size(words, kCornerAfter, unit_mm);
  if (tool.diameter_mm && *tool.diameter_mm <= 0) tool.diameter_mm.reset();
  std::smatch m;
  if (std::regex_search(words, m, kFlutes) && m[1].length() <= 2) tool.flutes = std::stoi(m[1].str());
  tool.type = type_of(words, tool);
  if (tool.type != ToolType::bull) tool.corner_radius_mm.reset();
  return tool;
}

std::vector<ToolProposal> tools_in_comments(const SourceText& program, bool inch) {
  static const std::regex kNamed(R"([(;]\s*T\s*0*(\d{1,6})(?!\d)([^)]*))", std::regex::icase),
      kBeside(R"(^(?=[^(;]*M0?6(?!\d))[^(;]*?T\s*0*(\d{1,6})(?!\d)[^(;]*[(;]([^)]+))", std::regex::icase);
  std::vector<ToolProposal> out;
  for (std::size_t line = 1; line <= program.line_count(); ++line) {
    const std::string text(program.line(line).substr(0, kLongestComment));
    if (text.find_first_of("(;") == std::string::npos || text.find_first_of("Tt") == std::string::npos) continue;
    std::smatch m;
    if (!std::regex_search(text, m, kNamed) && !std::regex_search(text, m, kBeside)) continue;
    ToolProposal tool = tool_of_words(m[2].str(), inch);
    tool.number = std::stoi(m[1].str());
    tool.from = fmt::format("{}:{}", program.name(), line);
    const auto same = std::find_if(out.begin(), out.end(), [&](const auto& t) { return t.number == tool.number; });
    if (same == out.end())
      out.push_back(std::move(tool));
    else
      complete(*same, tool);
  }
  return out;
}

void complete(ToolProposal& tool, const ToolProposal& other) {
  const auto fill = [](auto& value, const auto& from) {
    if (!value) value = from;
  };
  fill(tool.type, other.type);
  fill(tool.diameter_mm, other.diameter_mm);
  fill(tool.corner_radius_mm, other.corner_radius_mm);
  fill(tool.flute_length_mm, other.flute_length_mm);
  fill(tool.shank_diameter_mm, other.shank_diameter_mm);
  fill(tool.overhang_mm, other.overhang_mm);
  fill(tool.flutes, other.flutes);
  fill(tool.youngs_modulus_GPa, other.youngs_modulus_GPa);
}

}  // namespace camber::machine
