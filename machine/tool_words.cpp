// Tools as the comments of CAM systems describe them.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/drill_sizes.h"
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

bool is_end_mill(const std::string& words) {
  return has(words, "END MILL") || has(words, "ENDMILL") || has(words, "END_MILL") || has(words, "E.M.");
}

std::optional<ToolType> type_of(const std::string& words, const ToolProposal& tool) {
  if (has(words, "CORNER ROUNDING")) return std::nullopt;
  if (has(words, "TAPER") && has(words, "BALL")) return ToolType::tapered_ball;
  if (has(words, "BALL") || has(words, "SPHER")) return ToolType::ball;
  if (is_end_mill(words) && has(words, "CHAMFERS")) return ToolType::flat;
  if (has(words, "CHAMFER") || has(words, "COUNTERSINK")) return ToolType::chamfer;
  if (has(words, "DRILL") || has(words, "SPOT")) return ToolType::drill;
  if (has(words, "THREAD")) return std::nullopt;
  if (has(words, "TAP ") || has(words, "REAM")) return ToolType::drill;
  if (has(words, "BULL") || tool.corner_radius_mm.value_or(0) > 0) return ToolType::bull;
  if (has(words, "FLAT") || is_end_mill(words) || has(words, "FACE MILL")) return ToolType::flat;
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

/// "#30 DRILL", "NO. 33 DRILL", "LET. B DRILL": sizes by the gauge; "4.00-0.7 TAP": a metric thread and its pitch.
void read_gauge(const std::string& words, ToolProposal& tool) {
  static const std::regex kNumber(R"((?:#|\bNO\.?)\s*(\d{1,2})\s+(?:[A-Z]+\s+)*DRILL\b)"),
      kMetricTap(R"((\d+\.?\d*)-\d?\.\d+\s+TAP\b)"), kLetter(R"(\bLET(?:TER|\.)?\s*([A-Z])\s+(?:[A-Z]+\s+)*DRILL\b)");
  std::smatch m;
  if (std::regex_search(words, m, kNumber))
    tool.diameter_mm = number_drill_mm(std::stoi(m[1].str()));
  else if (std::regex_search(words, m, kLetter))
    tool.diameter_mm = letter_drill_mm(m[1].str()[0]);
  else if (std::regex_search(words, m, kMetricTap))
    tool.diameter_mm = size_of(m[1].str());
}

/// What the job's tool types leave out of these words.
std::string doubt_of(const std::string& words) {
  if (has(words, "CORNER ROUNDING")) return "type \"general\" describes its profile (docs/cutters.md)";
  if (is_end_mill(words) && has(words, "CHAMFERS")) return "the chamfers of its corners are left out";
  if (has(words, "TAP ") || has(words, "REAM")) return "taps and reamers stand as drills: they make holes alone";
  return {};
}

/// "45 DEG CHAMFER MILL" counts from the axis, "90 DEG SPOT DRILL" between the sides; the sign in Latin-1 or UTF-8.
void read_angle(const std::string& words, ToolProposal& tool) {
  static const std::regex kAngle("(\\d{2,3})\\s*(?:\xb0|\xc2\xb0|DEG)");
  std::smatch m;
  if (!std::regex_search(words, m, kAngle)) return;
  const double angle_deg = std::stod(m[1].str());
  if (tool.type == ToolType::chamfer)
    tool.point_angle_deg = angle_deg < 60 ? 2 * angle_deg : angle_deg;
  else if (tool.type == ToolType::drill)
    tool.point_angle_deg = angle_deg;
  if (tool.point_angle_deg && (*tool.point_angle_deg < 10 || *tool.point_angle_deg > 170)) tool.point_angle_deg.reset();
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
      kCorner(R"((?:\bCR\s*=\s*|\bRAD[\s.=-]+|\bR\s*=\s*)([\d./]*\d\.?))"),
      kCornerAfter(R"(([\d./]*\d\.?)\s*"?\s*RAD(?:IUS)?\b)"), kFlutes(R"((\d+)\s*-?\s*FL(?:UTES?|T)?\b)"),
      kSizeBeforeDia(R"(^[\s|]*[\d./-]*\d\.?\s*(?:MM|")?\s*DIA\b)");
  const std::string words = upper(text);
  const double unit_mm = inch ? kMmPerInch : 1;
  ToolProposal tool;
  tool.what = std::string(text);
  // 1/2" DIA. 2 FLUTE: the number behind belongs to the flutes.
  if (std::regex_search(words, kSizeBeforeDia)) read_bare_size(words, inch, tool);
  if (!tool.diameter_mm) tool.diameter_mm = named_size(words, kDiameter, unit_mm);
  if (!tool.diameter_mm) read_gauge(words, tool);
  if (!tool.diameter_mm) read_bare_size(words, inch, tool);
  tool.corner_radius_mm = named_size(words, kCorner, unit_mm);
  if (!tool.corner_radius_mm) tool.corner_radius_mm = named_size(words, kCornerAfter, unit_mm);
  if (tool.diameter_mm && *tool.diameter_mm <= 0) tool.diameter_mm.reset();
  std::smatch m;
  if (std::regex_search(words, m, kFlutes) && m[1].length() <= 2) tool.flutes = std::stoi(m[1].str());
  tool.type = type_of(words, tool);
  if (tool.type != ToolType::bull) tool.corner_radius_mm.reset();
  read_angle(words, tool);
  if (tool.doubt.empty()) tool.doubt = doubt_of(words);
  return tool;
}

namespace {

/// The tool of the change that follows within a few lines: "( 1/2\" DIA. 2 FLUTE E.M. )", then "T2" and "M06", on one
/// line or two. Nothing where the program moves in between.
std::optional<int> tool_of_next_change(const SourceText& program, std::size_t line) {
  constexpr std::size_t kReach = 8;
  static const std::regex kTool(R"(T\s*0*(\d{1,6})(?!\d))", std::regex::icase),
      kChange(R"(M\s*0?6(?!\d))", std::regex::icase), kMotion(R"([XY]\s*[-+.\d])", std::regex::icase),
      kComment(R"(\([^)]*\)|;.*)");
  std::optional<int> tool;
  for (std::size_t at = line + 1; at <= std::min(line + kReach, program.line_count()); ++at) {
    const std::string words =
        std::regex_replace(std::string(program.line(at).substr(0, kLongestComment)), kComment, "");
    std::smatch m;
    if (std::regex_search(words, m, kTool)) tool = std::stoi(m[1].str());
    if (std::regex_search(words, kChange)) return tool;
    if (std::regex_search(words, kMotion)) return std::nullopt;
  }
  return std::nullopt;
}

/// A comment alone on its line that gives a tool's type and size, above the change that brings the tool in.
std::optional<ToolProposal> tool_above_change(const SourceText& program, std::size_t line, const std::string& text,
                                              bool inch) {
  static const std::regex kAlone(R"(^\s*(?:N\d+\s*)?\(([^)]+)\)?\s*$)");
  std::smatch m;
  if (!std::regex_search(text, m, kAlone)) return std::nullopt;
  ToolProposal tool = tool_of_words(m[1].str(), inch);
  if (!tool.diameter_mm || (!tool.type && tool.doubt.empty())) return std::nullopt;
  const auto number = tool_of_next_change(program, line);
  if (!number) return std::nullopt;
  tool.number = *number;
  return tool;
}

/// A comment that names the tool's number, or stands beside it.
std::optional<ToolProposal> tool_named(const std::string& text, bool inch) {
  static const std::regex kNamed(R"([(;]\s*T\s*0*(\d{1,6})(?!\d)([^)]*))", std::regex::icase),
      kBeside(R"(^(?=[^(;]*M0?6(?!\d))[^(;]*?T\s*0*(\d{1,6})(?!\d)[^(;]*[(;]([^)]+))", std::regex::icase);
  if (text.find_first_of("Tt") == std::string::npos) return std::nullopt;
  std::smatch m;
  if (!std::regex_search(text, m, kNamed) && !std::regex_search(text, m, kBeside)) return std::nullopt;
  ToolProposal tool = tool_of_words(m[2].str(), inch);
  tool.number = std::stoi(m[1].str());
  return tool;
}

}  // namespace

std::vector<ToolProposal> tools_in_comments(const SourceText& program, bool inch) {
  std::vector<ToolProposal> out;
  for (std::size_t line = 1; line <= program.line_count(); ++line) {
    const std::string text(program.line(line).substr(0, kLongestComment));
    if (text.find_first_of("(;") == std::string::npos) continue;
    std::optional<ToolProposal> tool = tool_named(text, inch);
    if (!tool) tool = tool_above_change(program, line, text, inch);
    if (!tool) continue;
    tool->from = fmt::format("{}:{}", program.name(), line);
    const auto same = std::find_if(out.begin(), out.end(), [&](const auto& t) { return t.number == tool->number; });
    if (same == out.end())
      out.push_back(std::move(*tool));
    else
      complete(*same, *tool);
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
  fill(tool.point_angle_deg, other.point_angle_deg);
  fill(tool.tip_diameter_mm, other.tip_diameter_mm);
  fill(tool.taper_deg, other.taper_deg);
  fill(tool.neck_diameter_mm, other.neck_diameter_mm);
  fill(tool.shoulder_length_mm, other.shoulder_length_mm);
  fill(tool.overall_length_mm, other.overall_length_mm);
  if (tool.holder.empty()) tool.holder = other.holder;
}

}  // namespace camber::machine
