// Tools as the comments of a program name them, and which of its tools each comment belongs to.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/program_comments.h"
#include "machine/tool_proposal.h"

namespace camber::machine {
namespace {

/// Contents of a comment, before it is known whose comment it is.
struct Mention {
  std::size_t line = 0;
  std::optional<int> number;
  bool firm = true;         ///< the number is that of the T word; else it may be one of a library
  bool of_current = false;  ///< belongs to the tool that is in, however long ago it came
  ToolProposal tool;
};

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::optional<int> whole_number(const std::string& text) {
  int value = 0;
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
  return ec == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "6", "6 mm", "0.25 in", "1/4\""; without a unit in the program's.
std::optional<double> quantity_mm(const std::string& text, bool inch) {
  static const std::regex kQuantity(R"(^\s*(\d*\.?\d+\.?)\s*(MM|IN(?:CH(?:ES)?)?|")?\s*$)", std::regex::icase);
  std::smatch m;
  if (!std::regex_match(text, m, kQuantity)) return std::nullopt;
  const auto value = parse_number(m[1].str());
  if (!value || *value <= 0) return std::nullopt;
  const std::string unit = upper(m[2].str());
  return *value * ((unit.empty() ? inch : unit != "MM") ? kMmPerInch : 1);
}

/// Numbers of a list, "6.35, 0.00, 19.05"; where one is none, nothing.
std::vector<double> numbers_of(const std::string& list) {
  std::vector<double> out;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t end = std::min(list.find(',', from), list.size());
    std::string one = list.substr(from, end - from);
    one.erase(0, std::min(one.find_first_not_of(" \t"), one.size()));
    one.erase(one.find_last_not_of(" \t)") + 1);
    const auto value = parse_number(one);
    if (!value) return {};
    out.push_back(*value);
    from = end + 1;
  }
  return out;
}

/// FreeCAD: "@FC|TOOL|number=1|name=endmill 6x17|type=Endmill|diameter=6|shankdiameter=6|flutelength=17|length=50".
std::optional<Mention> freecad(const std::string& comment, bool inch) {
  static const std::regex kBegin(R"(^\s*@FC\s*\|\s*TOOL\s*\|)", std::regex::icase);
  std::smatch m;
  if (!std::regex_search(comment, m, kBegin)) return std::nullopt;
  std::map<std::string, std::string> fields;
  const std::string rest = m.suffix().str();
  for (std::size_t from = 0; from < rest.size();) {
    const std::size_t end = std::min(rest.find('|', from), rest.size());
    const std::string one = rest.substr(from, end - from);
    if (const std::size_t equals = one.find('='); equals != std::string::npos)
      fields[upper(one.substr(0, equals))] = one.substr(equals + 1);
    from = end + 1;
  }
  const auto size = [&](std::initializer_list<const char*> keys) {
    std::optional<double> found;
    for (const char* key : keys)
      if (!found && fields.contains(key)) found = quantity_mm(fields[key], inch);
    return found;
  };
  Mention out;
  out.number = whole_number(fields["NUMBER"]);
  out.tool = tool_of_words(fields["TYPE"] + " " + fields["NAME"], inch);
  out.tool.what = comment;
  if (const auto diameter = size({"DIAMETER"})) out.tool.diameter_mm = diameter;
  if (out.tool.type == ToolType::bull)
    if (const auto corner = size({"TORUSRADIUS", "CORNERRADIUS", "FLATRADIUS"})) out.tool.corner_radius_mm = corner;
  if (const auto flutes = size({"FLUTES"})) out.tool.flutes = static_cast<int>(*flutes / (inch ? kMmPerInch : 1));
  if (const auto length = size({"FLUTELENGTH", "CUTTINGEDGEHEIGHT"})) out.tool.flute_length_mm = length;
  if (const auto shank = size({"SHANKDIAMETER"})) out.tool.shank_diameter_mm = shank;
  for (const char* key : {"CUTTINGEDGEANGLE", "TIPANGLE"})
    if (const auto angle = fields.contains(key)
                               ? parse_number(fields[key].substr(0, fields[key].find_first_not_of("0123456789.")))
                               : std::nullopt;
        angle && *angle >= 10 && *angle <= 170)
      out.tool.point_angle_deg = angle;
  return out;
}

/// CutViewer's lines, which CamBam, Carbide Create and others write: TOOL/MILL, diameter, corner radius, height, taper;
/// TOOL/DRILL, diameter, point angle, height.
std::optional<Mention> cutviewer(const std::string& comment, bool inch) {
  static const std::regex kTool(R"(^\s*TOOL\s*/\s*([A-Z]+)\s*,(.*)$)", std::regex::icase);
  std::smatch m;
  if (!std::regex_search(comment, m, kTool)) return std::nullopt;
  const std::vector<double> n = numbers_of(m[2].str());
  if (n.empty() || n[0] <= 0) return std::nullopt;
  const double unit = inch ? kMmPerInch : 1;
  const auto at = [&n](std::size_t i) { return i < n.size() ? n[i] : 0; };
  Mention out;
  ToolProposal& tool = out.tool;
  tool.what = comment;
  tool.diameter_mm = n[0] * unit;
  const std::string kind = upper(m[1].str());
  constexpr double kSame = 0.02;  // corner radii are rounded to two decimals
  if (kind.find("DRILL") != std::string::npos || kind == "TAP" || kind == "REAMER") {
    tool.type = ToolType::drill;
    if (at(1) >= 10 && at(1) <= 170) tool.point_angle_deg = at(1);
  } else if (const double corner = at(1), taper_deg = at(3); taper_deg > 0 && corner > 0) {
    tool.type = ToolType::tapered_ball;
    tool.diameter_mm = 2 * corner * unit;
    tool.taper_deg = taper_deg;
  } else if (taper_deg > 0) {
    // A cone: the diameter is that of its tip, the height that of its cone.
    tool.type = ToolType::chamfer;
    tool.point_angle_deg = 2 * taper_deg;
    tool.tip_diameter_mm = n[0] * unit;
    tool.diameter_mm =
        at(2) > 0 ? std::optional((n[0] + 2 * at(2) * std::tan(rad_from_deg(taper_deg))) * unit) : std::nullopt;
  } else if (std::abs(corner - n[0] / 2) <= kSame) {
    tool.type = ToolType::ball;
  } else if (corner > 0) {
    tool.type = ToolType::bull;
    tool.corner_radius_mm = corner * unit;
  } else {
    tool.type = ToolType::flat;
  }
  if (tool.type != ToolType::chamfer && at(2) > 0) tool.flute_length_mm = at(2) * unit;
  return out;
}

/// Kiri:Moto: "tool#=1 flute=6 len=20 unit=metric".
std::optional<Mention> kiri_moto(const std::string& comment) {
  static const std::regex kTool(
      R"(tool#\s*=\s*(\d+)\s+flute\s*=\s*([\d.]+)\s+len\s*=\s*([\d.]+)(?:\s+unit\s*=\s*(\w+))?)", std::regex::icase);
  std::smatch m;
  if (!std::regex_search(comment, m, kTool)) return std::nullopt;
  const double unit = upper(m[4].str()).starts_with("IMP") || upper(m[4].str()).starts_with("IN") ? kMmPerInch : 1;
  Mention out;
  out.number = whole_number(m[1].str());
  out.tool.what = comment;
  if (const auto diameter = parse_number(m[2].str()); diameter && *diameter > 0)
    out.tool.diameter_mm = *diameter * unit;
  if (const auto length = parse_number(m[3].str()); length && *length > 0) out.tool.flute_length_mm = *length * unit;
  return out;
}

/// "DM=6 CR=3 TL=85" of hyperMILL, "D=6.00 R=0.00 F=15.00 L=35.00" of NX: diameter, corner radius, and in NX's the
/// length of the flutes. The number in front of hyperMILL's is that of its library.
std::optional<Mention> diameter_and_corner(const std::string& comment, bool inch) {
  static const std::regex kHyperMill(R"(\bDM=([\d.]+)\s+CR=([\d.]+))"),
      kNx(R"(^\(?D=([\d.]+)\s+R=([\d.]+)(?:\s+F=([\d.]+))?)");
  std::smatch m;
  if (!std::regex_search(comment, m, kHyperMill) && !std::regex_search(comment, m, kNx)) return std::nullopt;
  const auto diameter = parse_number(m[1].str()), corner = parse_number(m[2].str());
  if (!diameter || !corner || *diameter <= 0) return std::nullopt;
  const double unit = inch ? kMmPerInch : 1;
  Mention out;
  ToolProposal& tool = out.tool;
  tool.what = comment;
  tool.diameter_mm = *diameter * unit;
  constexpr double kSame = 0.02;  // corner radii are rounded
  if (std::abs(*corner - *diameter / 2) <= kSame) {
    tool.type = ToolType::ball;
  } else if (*corner > 0) {
    tool.type = ToolType::bull;
    tool.corner_radius_mm = *corner * unit;
  } else {
    tool.type = ToolType::flat;
  }
  if (m.size() > 3 && m[3].matched)
    if (const auto flutes = parse_number(m[3].str()); flutes && *flutes > 0) tool.flute_length_mm = *flutes * unit;
  return out;
}

/// "T01 TC1: KL+087.000 KR020.000" of Keller's set-up sheets: length and radius.
std::optional<Mention> length_and_radius(const std::string& comment, bool inch) {
  static const std::regex kTool(R"(^\s*T0*(\d{1,6})\s+TC\d+:\s*KL[-+]?[\d.]+\s+KR\+?([\d.]+))");
  std::smatch m;
  if (!std::regex_search(comment, m, kTool)) return std::nullopt;
  const auto radius = parse_number(m[2].str());
  Mention out;
  out.number = whole_number(m[1].str());
  out.tool.what = comment;
  if (radius && *radius > 0) out.tool.diameter_mm = 2 * *radius * (inch ? kMmPerInch : 1);
  return out;
}

/// Comments that begin with a tool's number, or name it: "T3 D=6.", "#11 D=12 - FORM MILL", "1 = End Mill {6 mm}",
/// "TOOL - 7 DIA. - .5", "Tool #6 ...", "No. 1: 3 mm".
std::optional<Mention> numbered(const std::string& comment, bool inch) {
  static const std::regex kT(R"(^\s*(?:T\s*|#(?=\d+\s+D=))0*(\d{1,6})(?![\d.])\s*[:=]?(.*)$)", std::regex::icase),
      kList(R"(^\s*(\d{1,3})\s*=\s*(?=[A-Za-z.\d])(.+)$)"),
      kTool(
          R"(\bTOOL\s*(?:NO\.?|NUMBER|NUM\.?)?\s*[-#=:]+\s*#?\s*-?\s*0*(\d{1,6})(?![\d./])(?!\s*(?:MM\b|IN\b|INCH|")))",
          std::regex::icase),
      kNumber(R"(^\s*NO\.\s*(\d{1,3})\s*:(.*)$)", std::regex::icase);
  std::smatch m;
  Mention out;
  std::string words;
  if (std::regex_search(comment, m, kT) || std::regex_search(comment, m, kList) ||
      std::regex_search(comment, m, kNumber)) {
    words = m[2].str();
  } else if (std::regex_search(comment, m, kTool)) {
    words = m.prefix().str() + " " + m.suffix().str();
    out.firm = false;
  } else {
    return std::nullopt;
  }
  out.number = whole_number(m[1].str());
  out.tool = tool_of_words(words, inch);
  // "( T1 : 6.0 )": a bare number.
  if (!out.tool.diameter_mm && !out.tool.type) out.tool.diameter_mm = quantity_mm(words, inch);
  return out;
}

/// Without a number: a label with a size, or a type with a size.
std::optional<Mention> anonymous(const CommentedLine& line, bool inch) {
  static const std::regex kCompensated(R"(COMPENSATED TOOL PATH\.\s*DIAMETER:\s*([\d.]+))", std::regex::icase),
      kLabel(
          R"(^\s*(?:TC|TOOL(?:\s*(?:NAME|TYPE|DESC(?:RIPTION)?|DIA(?:METER)?))?|CUTTER|WERKZEUG|FRAISE|FREZA|FRESA|FR\S{1,3}SER)\s*[-:=. ])",
          std::regex::icase),
      kCode(R"([A-MO-Z]\s*[-+.\d])");
  Mention out;
  std::smatch m;
  if (std::regex_search(line.comment, m, kCompensated)) {
    out.tool.what = line.comment;
    out.tool.diameter_mm = quantity_mm(m[1].str(), inch);
    out.of_current = true;
    return out;
  }
  if (std::regex_search(line.code, kCode)) return std::nullopt;
  out.tool = tool_of_words(line.comment, inch);
  const bool labelled = std::regex_search(line.comment, kLabel);
  const bool told = labelled ? out.tool.diameter_mm || out.tool.type
                             : out.tool.diameter_mm && (out.tool.type || !out.tool.doubt.empty());
  return told ? std::optional(out) : std::nullopt;
}

std::optional<Mention> mention_of(const CommentedLine& line, bool inch) {
  static const std::regex kBeside(R"((?=.*M\s*0?6(?!\d)).*?T\s*0*(\d{1,6})(?![\d.]))");
  std::optional<Mention> out = freecad(line.comment, inch);
  if (!out) out = cutviewer(line.comment, inch);
  if (!out) out = kiri_moto(line.comment);
  if (!out) out = diameter_and_corner(line.comment, inch);
  if (!out) out = length_and_radius(line.comment, inch);
  if (!out) out = numbered(line.comment, inch);
  std::smatch m;
  const bool beside = std::regex_search(line.code, m, kBeside);
  if (!out && beside) out.emplace().tool = tool_of_words(line.comment, inch);
  if (!out) out = anonymous(line, inch);
  if (!out) return std::nullopt;
  if (beside && !out->number) out->number = whole_number(m[1].str());
  out->line = line.line;
  return out;
}

/// Finds the lines at which the tools of a program come in, and those that move.
class Changes {
 public:
  explicit Changes(const SourceText& program) : program_(program) {
    static const std::regex kTool(R"(T\s*0*(\d{1,6})(?![\d.]))"), kChange(R"(M\s*0?6(?!\d))");
    std::optional<int> selected;
    if (read_tool_calls()) return;
    for (std::size_t line = 1; line <= program.line_count(); ++line) {
      const std::string_view text = program.line(line);
      if (text.find_first_of("TtMm") == std::string_view::npos) continue;
      const std::string code = code_of_line(program, line);
      std::smatch m;
      if (std::regex_search(code, m, kTool)) {
        selected = whole_number(m[1].str());
        if (selected) numbers_.insert(*selected);
      }
      if (selected && std::regex_search(code, kChange)) changes_[line] = *selected;
    }
  }

  bool none() const { return numbers_.empty(); }
  bool has(int number) const { return numbers_.contains(number); }
  /// The only tool that the program can be cutting with.
  std::optional<int> only() const {
    if (numbers_.empty()) return 0;
    return numbers_.size() == 1 ? std::optional(*numbers_.begin()) : std::nullopt;
  }
  /// The change within a few lines below, nothing moving in between.
  std::optional<int> next(std::size_t line) const {
    constexpr std::size_t kReach = 8;
    static const std::regex kMotion(R"([XY]\s*[-+.\d])");
    for (std::size_t at = line + 1; at <= std::min(line + kReach, program_.line_count()); ++at) {
      if (const auto change = changes_.find(at); change != changes_.end()) return change->second;
      const std::string code = code_of_line(program_, at);
      if (std::regex_search(code, kMotion)) return std::nullopt;
    }
    return std::nullopt;
  }
  std::optional<int> last(std::size_t line) const {
    auto at = changes_.upper_bound(line);
    return at == changes_.begin() ? std::nullopt : std::optional(std::prev(at)->second);
  }
  /// True where nothing moves from the last change down to the line.
  bool just_changed(std::size_t line) const {
    static const std::regex kMotion(R"([XY]\s*[-+.\d])");
    const auto at = changes_.upper_bound(line);
    if (at == changes_.begin()) return false;
    for (std::size_t between = std::prev(at)->first + 1; between < line; ++between)
      if (std::regex_search(code_of_line(program_, between), kMotion)) return false;
    return true;
  }

 private:
  /// TOOL CALL of Klartext, by number or name; names have the first numbers that no tool has. False: there is none.
  bool read_tool_calls() {
    static const std::regex kCall(R"re(^\s*/?\s*N?\d*\s*TOOL\s+CALL\s+(?:0*(\d{1,6})(?!\d)|"([^"]*)"))re");
    std::map<std::size_t, std::string> names;
    for (std::size_t line = 1; line <= program_.line_count(); ++line) {
      const std::string_view text = program_.line(line);
      if (text.find_first_of("Cc") == std::string_view::npos || text.find_first_of("Tt") == std::string_view::npos)
        continue;
      const std::string code = code_of_line(program_, line);
      std::smatch m;
      if (!std::regex_search(code, m, kCall)) continue;
      if (!m[1].matched)
        names[line] = m[2].str();
      else if (const auto number = whole_number(m[1].str()))
        numbers_.insert(changes_[line] = *number);
    }
    std::map<std::string, int> number_of_name;
    for (const auto& [line, name] : names) {
      const auto [at, is_new] = number_of_name.emplace(name, 0);
      while (is_new && (at->second == 0 || !numbers_.insert(at->second).second)) ++at->second;
      changes_[line] = at->second;
    }
    return !changes_.empty();
  }

  const SourceText& program_;
  std::map<std::size_t, int> changes_;  ///< by line
  std::set<int> numbers_;
};

std::optional<int> number_of(const Mention& mention, const Changes& changes) {
  if (mention.number && (changes.has(*mention.number) || (mention.firm && !changes.none()))) return mention.number;
  const auto next = mention.of_current ? std::nullopt : changes.next(mention.line);
  if (next) return next;
  if (mention.of_current || changes.just_changed(mention.line))
    if (const auto last = changes.last(mention.line)) return last;
  if (const auto only = changes.only()) return only;
  return mention.number;
}

}  // namespace

std::vector<ToolProposal> tools_in_comments(const SourceText& program, bool inch) {
  const Changes changes(program);
  std::vector<ToolProposal> out;
  std::map<int, std::set<int>> taken_for;  // numbers of comments that stand for a tool of another number
  for (const CommentedLine& line : commented_lines(program)) {
    std::optional<Mention> mention = mention_of(line, inch);
    if (!mention) continue;
    const auto number = number_of(*mention, changes);
    if (!number) continue;
    ToolProposal& tool = mention->tool;
    tool.number = *number;
    tool.from = fmt::format("{}:{}", program.name(), mention->line);
    const auto same = std::ranges::find(out, number, &ToolProposal::number);
    if (same == out.end()) {
      out.push_back(std::move(tool));
    } else if (mention->number && *mention->number != *number) {
      // A list of several tools, none of which the program calls.
      taken_for[*number].insert(*mention->number);
      if (!same->diameter_mm) complete(*same, tool);
    } else {
      complete(*same, tool);
    }
  }
  for (ToolProposal& tool : out)
    if (taken_for.contains(tool.number.value_or(0)) && tool.doubt.empty())
      tool.doubt = "the comments name several tools, and the program calls none of them; this is the first";
  return out;
}

}  // namespace camber::machine
