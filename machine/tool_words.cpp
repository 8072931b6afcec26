// Tools as the comments of CAM systems describe them.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <string_view>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

constexpr std::array kNumbers_inch{
    .2280, .2210, .2130, .2090, .2055, .2040, .2010, .1990, .1960, .1935, .1910, .1890, .1850, .1820, .1800, .1770,
    .1730, .1695, .1660, .1610, .1590, .1570, .1540, .1520, .1495, .1470, .1440, .1405, .1360, .1285, .1200, .1160,
    .1130, .1110, .1100, .1065, .1040, .1015, .0995, .0980, .0960, .0935, .0890, .0860, .0820, .0810, .0785, .0760,
    .0730, .0700, .0670, .0635, .0595, .0550, .0520, .0465, .0430, .0420, .0410, .0400, .0390, .0380, .0370, .0360,
    .0350, .0330, .0320, .0310, .0292, .0280, .0260, .0250, .0240, .0225, .0210, .0200, .0180, .0160, .0145, .0135};
static_assert(kNumbers_inch.size() == 80);

constexpr std::array kLetters_inch{.234, .238, .242, .246, .250, .257, .261, .266, .272, .277, .281, .290, .295,
                                   .302, .316, .323, .332, .339, .348, .358, .368, .377, .386, .397, .404, .413};
static_assert(kLetters_inch.size() == 26);

/// Diameter of a wire gauge drill, number 1 to 80. Source: ASME B94.11M, Twist Drills.
std::optional<double> number_drill_mm(int number) {
  if (number < 1 || number > static_cast<int>(kNumbers_inch.size())) return std::nullopt;
  return kNumbers_inch[static_cast<std::size_t>(number - 1)] * kMmPerInch;
}

/// Diameter of a letter drill, A to Z. Source: the same.
std::optional<double> letter_drill_mm(char letter) {
  if (letter < 'A' || letter > 'Z') return std::nullopt;
  return kLetters_inch[static_cast<std::size_t>(letter - 'A')] * kMmPerInch;
}

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

/// The word alone, not as a part of another one.
bool has_word(const std::string& words, const std::string& pattern) {
  static thread_local std::map<std::string, std::regex> known;
  const auto at = known.find(pattern);
  const std::regex& regex = at != known.end()
                                ? at->second
                                : known.emplace(pattern, "(?:^|[^A-Z])(?:" + pattern + ")(?:[^A-Z]|$)").first->second;
  return std::regex_search(words, regex);
}

bool is_end_mill(const std::string& words) {
  return has(words, "END MILL") || has(words, "ENDMILL") || has(words, "END-MILL") || has(words, "E.M.") ||
         has(words, "FEM") || has_word(words, "EM") || has(words, "SCHAFT") || has(words, "ROUTER") ||
         has(words, "CUT BIT") || has(words, "DOWNCUT") || has(words, "UPCUT") || has(words, "COMPRESSION") ||
         has(words, "O FLUTE") || has(words, "SLOT DRILL");
}

/// "90 V GROOVE", "V-BIT", "VBIT", "ENGRAVE 30": named by the angle between their sides.
bool is_v_bit(const std::string& words) {
  return has_word(words, "V[ -]?(?:BIT|GROOVE|CARVE|CUTTER|MILL|TOOL)") ||
         has_word(words, "V ?[1-9]\\d{1,2} ?(?:DEG|GRAD)?") || has(words, "ENGRAV") || has(words, "GRAVIER");
}

/// A cutter of any kind, in the languages that programs are met in; longest words first where one holds another.
std::optional<ToolType> type_of(const std::string& words, const ToolProposal& tool) {
  if (has(words, "CORNER ROUND") || has(words, "PROBE") || has(words, "DOVETAIL") || has(words, "T-SLOT") ||
      has(words, "T SLOT") || has_word(words, "SAW"))
    return std::nullopt;
  if (has(words, "TAPER") && has(words, "BALL")) return ToolType::tapered_ball;
  if (has(words, "BALL") || has(words, "SPHER") || has(words, "KUGEL") || has(words, "HEMISPH") ||
      has(words, "SFERIC") || has(words, "BOULE") || has_word(words, "BEM|BNEM|BN|B/E"))
    return ToolType::ball;
  if (is_end_mill(words) && has(words, "CHAMFERS")) return ToolType::flat;
  if (is_v_bit(words) || has(words, "CHAMFER") || has(words, "COUNTERSINK") || has(words, "SENKER") ||
      has(words, "ENTGRAT") || has(words, "ENTFR") || has(words, "CHANFR") || has(words, "DEBURR"))
    return ToolType::chamfer;
  if (has(words, "SLOT DRILL")) return ToolType::flat;
  if (has(words, "DRILL") || has(words, "SPOT") || has(words, "BOHRER") || has_word(words, "FORET|BROCA|PUNTA"))
    return ToolType::drill;
  if (has(words, "THREAD")) return std::nullopt;
  if (has_word(words, "TAP") || has(words, "REAM")) return ToolType::drill;
  if (has(words, "BULL") || has(words, "TORUS") || has(words, "TORIC") || tool.corner_radius_mm.value_or(0) > 0)
    return ToolType::bull;
  if (has(words, "FLAT") || is_end_mill(words) || has(words, "FACE MILL") || has(words, "FACEMILL") ||
      has(words, "FLY CUT") || has(words, "FLYCUT") || has(words, "FRAESER") || has(words, "FRASER") ||
      has(words, "FR\xc3\x84SER") || has(words, "FR\xc3\xa4SER") ||
      has_word(words, "MILL|FRAISE|FRESA|FREZA|BIT|ROUGHER"))
    return ToolType::flat;
  return std::nullopt;
}

constexpr const char* kNumber = R"((\d+-\d+/\d+|\d+/\d+|\d*\.?\d+\.?))";
constexpr const char* kUnit = R"((\s*MM|\s*"|\s*''|\s*IN(?:CH(?:ES)?)?\b)?)";

/// A size with its own unit, or the program's; a fraction is in inches everywhere.
std::optional<double> size_mm(const std::string& number, const std::string& unit, bool inch) {
  const auto size = size_of(number);
  if (!size || *size <= 0) return std::nullopt;
  if (has(unit, "MM")) return *size;
  const bool in_inch = !unit.empty() || inch || has(number, "/");
  return *size * (in_inch ? kMmPerInch : 1);
}

/// The first size that the pattern finds; "NUM" in it stands for a number and its unit.
std::optional<double> find_size(const std::string& words, std::string pattern, bool inch) {
  static thread_local std::map<std::string, std::regex> known;
  const std::size_t at = pattern.find("NUM");
  pattern.replace(at, 3, std::string(kNumber) + kUnit);
  const std::regex& regex = known.try_emplace(pattern, pattern).first->second;
  std::smatch m;
  if (!std::regex_search(words, m, regex)) return std::nullopt;
  return size_mm(m[1].str(), m[2].str(), inch);
}

/// ".505", ".250": nobody writes millimetres to the micrometre without a zero before the point.
bool written_as_inches(const std::string& number) { return number.front() == '.' && number.size() > 3; }

/// The bare size that Mastercam begins with; in inches where it has the sign.
void read_bare_size(const std::string& words, bool inch, ToolProposal& tool) {
  static const std::regex kSize(std::string(R"(^[\s|]*)") + kNumber + kUnit + R"((?=[\s|]|$))");
  std::smatch m;
  if (!std::regex_search(words, m, kSize)) return;
  const std::string unit = m[2].str();
  const auto size = size_of(m[1].str());
  if (!size) return;
  if (inch && unit.empty() && *size >= kLargestBareInch) {
    tool.doubt = fmt::format("the size {} has no unit in a program in inches; taken as mm", m[1].str());
    inch = false;
  } else if (!inch && unit.empty() && written_as_inches(m[1].str())) {
    tool.doubt = fmt::format("the size {} has no unit in a program in millimetres; taken as inches", m[1].str());
    inch = true;
  }
  tool.diameter_mm = size_mm(m[1].str(), unit, inch);
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

/// Returns, as a sentence, what the job's tool types leave out of a cutter with these words; empty: nothing.
std::string doubt_of(const std::string& words) {
  if (has(words, "CORNER ROUND")) return "type \"general\" describes its profile (docs/cutters.md)";
  if (has(words, "DOVETAIL") || has(words, "T-SLOT") || has(words, "T SLOT")) return "its undercut is left out";
  if (is_end_mill(words) && has(words, "CHAMFERS")) return "the chamfers of its corners are left out";
  if (has_word(words, "TAP") || has(words, "REAM")) return "taps and reamers stand as drills: they make holes alone";
  return {};
}

/// "45 DEG CHAMFER MILL" counts from the axis, "90 DEG SPOT DRILL" and "60 V-BIT" between the sides; the sign in
/// Latin-1 or UTF-8.
void read_angle(const std::string& words, ToolProposal& tool) {
  static const std::regex kAngle("(\\d{2,3})(?:\\.\\d*)?\\s*-?\\s*(?:\xb0|\xc2\xb0|DEG|GRAD)"),
      kBeforeV(R"((\d{2,3})\s*-?\s*V[ -]?(?:BIT|GROOVE|CARVE|CUTTER|MILL|TOOL))"),
      kBehindV(R"((?:^|[^A-Z])V[ -]?(?:BIT|GROOVE|CARVE|CUTTER|MILL|TOOL)?[ -]?([1-9]\d{1,2})(?![\d./]))");
  std::smatch m;
  const bool v_bit = is_v_bit(words);
  if (!std::regex_search(words, m, kAngle) &&
      !(v_bit && (std::regex_search(words, m, kBeforeV) || std::regex_search(words, m, kBehindV))))
    return;
  const double angle_deg = std::stod(m[1].str());
  if (tool.type == ToolType::chamfer)
    tool.point_angle_deg = angle_deg < 60 && !v_bit ? 2 * angle_deg : angle_deg;
  else if (tool.type == ToolType::drill)
    tool.point_angle_deg = angle_deg;
  if (tool.point_angle_deg && (*tool.point_angle_deg < 10 || *tool.point_angle_deg > 170)) tool.point_angle_deg.reset();
}

/// "DIA. - .5", "D=10.", "1/4 DIAMETER", "6MM", "MILL_D10R1": the most outspoken first.
void read_diameter(const std::string& words, bool inch, ToolProposal& tool) {
  static const std::regex kShankDiameter(R"(SHANK\s*DIA(?:METER)?)");
  tool.diameter_mm = find_size(words, R"((?:^[\s|]*|[^-.=#:\d/\s"]\s*)NUM\s*DIA(?:M|METER)?\b)", inch);
  // English, French, Italian, Spanish, German: "DIAMETRE 100", "DIA OUTIL = 12.", "DURCHMESSER 8".
  if (!tool.diameter_mm && (has(words, "DIA") || has(words, "DURCHM")))
    tool.diameter_mm = find_size(std::regex_replace(words, kShankDiameter, "SHANK"),
                                 R"(\b(?:DIA(?:M|METER|METR[EO])?|DURCHM(?:ESSER)?)\b\.?(?:\s*(?:OUTIL|TOOL|FRAISE))?)"
                                 R"(\s*[-=:]*\s*NUM)",
                                 inch);
  if (!tool.diameter_mm) tool.diameter_mm = find_size(words, R"(\bD\s*[=:]\s*NUM)", inch);
  if (!tool.diameter_mm) read_gauge(words, tool);
  if (!tool.diameter_mm) read_bare_size(words, inch, tool);
  if (tool.diameter_mm) return;
  // "MILL D10R1", not the offsets of "|H1|D1|".
  static const std::regex kLengthOffset(R"(\bH\d+\b)");
  if (!std::regex_search(words, kLengthOffset))
    tool.diameter_mm = find_size(words, R"(\bD\s?NUM(?=R\d|[^\d]|$))", inch);
  // Of what is left once other sizes are taken out: one with a unit, a fraction, a number with a point.
  static const std::regex kOthers(
      R"((?:\d*\.?\d+/?\d*\s*(?:MM|"|IN)?\s*(?:SHANK|SHK|LOC|OAL|FLUTE|FL\b|RAD|DEG|GRAD|LONG|STICK|OVERHANG|V[ -]?(?:BIT|GROOVE)))|(?:(?:SHANK|SHK|LOC|OAL|LEN\w*|LENGTH|RAD\w*|CR|ZMIN|STICK\w*|OVERHANG|TIP)\s*[-=:.]*\s*-?\d*\.?\d+/?\d*\s*(?:MM|"|IN)?))");
  const std::string left = std::regex_replace(words, kOthers, " ");
  static const std::regex kAnySize(std::string(R"((?:^|[^\dA-Z./#]))") + kNumber + kUnit);
  for (std::sregex_iterator at(left.begin(), left.end(), kAnySize), end; at != end && !tool.diameter_mm; ++at) {
    const std::string number = (*at)[1].str(), unit = (*at)[2].str();
    if (!unit.empty() || has(number, "/") || has(number, ".")) tool.diameter_mm = size_mm(number, unit, inch);
  }
  // "BALL R3": twice the radius.
  if (!tool.diameter_mm && tool.type == ToolType::ball)
    if (const auto radius = find_size(words, R"(\bR\s?NUM(?=[^\d]|$))", inch)) tool.diameter_mm = 2 * *radius;
}

void read_corner(const std::string& words, bool inch, ToolProposal& tool) {
  for (const char* pattern :
       {R"((?:\bCR\s*=\s*|\bRAD[\s.=-]+|\bRADIUS\s*[=:-]\s*|\bR\s*=\s*)NUM)", R"(NUM\s*RAD(?:IUS)?\b)",
        R"(\bD\s?[\d.]+\s?R\s?NUM)", R"((?:\d\.\d*|\d\s*MM)\s+R\s?NUM(?=[\s|]|$))",
        R"(\b(?:BULL|TORUS|TORIC)\w*[ A-Z]*\bR\s?NUM)"})
    if (!tool.corner_radius_mm) tool.corner_radius_mm = find_size(words, pattern, inch);
}

/// Reads overhang, length of the flutes, and shank.
void read_lengths(const std::string& words, bool inch, ToolProposal& tool) {
  tool.overhang_mm = find_size(
      words, R"(\b(?:STICK[ -]?OUT|OVERHANG|OHL|PROJECTION|EXTENSION|AUSKRAG\w*|AUSSPANN\w*)\s*[-=:.]*\s*NUM)", inch);
  if (!tool.overhang_mm)
    tool.overhang_mm = find_size(words, R"((?:^|[^\d./])NUM\s*(?:STICK[ -]?OUT|OVERHANG)\b)", inch);
  tool.flute_length_mm = find_size(words, R"(\b(?:FLUTE ?LENGTH|CUT(?:TING)? ?LENGTH|LOC|LCF)\s*[-=:.]*\s*NUM)", inch);
  if (!tool.flute_length_mm) tool.flute_length_mm = find_size(words, R"((?:^|[^\d./])NUM\s*LOC\b)", inch);
  tool.shank_diameter_mm = find_size(words, R"((?:^|[^\d./])NUM\s*(?:DIA\w*\s*)?(?:SHANK|SHK)\b)", inch);
  if (!tool.shank_diameter_mm)
    tool.shank_diameter_mm = find_size(words, R"(\b(?:SHANK|SHK)\s*(?:DIA(?:METER)?)?\s*[-=:.]*\s*NUM)", inch);
}

}  // namespace

ToolProposal tool_of_words(std::string_view text, bool inch) {
  // "4 FLUTE", "4FL"; in Europe "Z4", which is no height: those have a point, a sign or zero.
  static const std::regex kFlutes(R"((\d+)\s*-?\s*FL(?:UTES?|T)?\b)"),
      kTeeth(R"((?:^|[\s|,-])Z\s?=?\s?(\d{1,2})(?=[\s|,]|$))");
  constexpr double kCarbide_GPa = 600, kSteel_GPa = 210;
  std::string words = upper(text);
  std::ranges::replace(words, '_', ' ');
  ToolProposal tool;
  tool.what = std::string(text);
  read_corner(words, inch, tool);
  tool.type = type_of(words, tool);
  read_diameter(words, inch, tool);
  if (tool.diameter_mm && *tool.diameter_mm <= 0) tool.diameter_mm.reset();
  std::smatch m;
  if ((std::regex_search(words, m, kFlutes) || (tool.type && std::regex_search(words, m, kTeeth))) &&
      m[1].length() <= 2 && std::stoi(m[1].str()) > 0)
    tool.flutes = std::stoi(m[1].str());
  if (tool.type != ToolType::bull) tool.corner_radius_mm.reset();
  read_lengths(words, inch, tool);
  if (has_word(words, "HSS")) tool.youngs_modulus_GPa = kSteel_GPa;
  if (has(words, "CARBIDE") || has_word(words, "VHM")) tool.youngs_modulus_GPa = kCarbide_GPa;
  read_angle(words, tool);
  if (tool.doubt.empty()) tool.doubt = doubt_of(words);
  return tool;
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
