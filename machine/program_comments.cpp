#include "machine/program_comments.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <regex>
#include <vector>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"

namespace camber::machine {
namespace {

constexpr std::size_t kLongest = 400;  // of a line; std::regex needs stack for each character

struct Split {
  std::string code, comment;
  bool has_comment = false;
};

/// Brackets within a comment belong to it as far as they are closed: "(End Mill (0.25 inch))".
std::size_t end_of_comment(std::string_view text, std::size_t from, char open, char close) {
  int depth = 0;
  for (std::size_t at = from; at < text.size(); ++at) {
    if (text[at] == open) ++depth;
    if (text[at] == close && --depth == 0) return at;
  }
  return std::min(text.find(close, from), text.size());
}

/// A structure line of Klartext, "32 * - TOOL: T5", is a comment: offset of its star.
std::optional<std::size_t> star_of(std::string_view text) {
  std::size_t at = text.find_first_not_of(" \t");
  if (at != std::string_view::npos && text[at] != '*') at = text.find_first_not_of("0123456789 \t", at);
  return at != std::string_view::npos && text[at] == '*' ? std::optional(at) : std::nullopt;
}

/// MSG("FACE MILL D100") of Sinumerik: the quotes are the language's, no sign for inches.
std::string_view without_quotes(std::string_view text) {
  const std::size_t from = text.find_first_not_of(' '), to = text.find_last_not_of(' ');
  if (from == std::string_view::npos || to == from || text[from] != '"' || text[to] != '"') return text;
  return text.substr(from + 1, to - from - 1);
}

Split split(std::string_view text) {
  text = text.substr(0, kLongest);
  Split out;
  if (const auto star = star_of(text)) return {{}, std::string(text.substr(*star + 1)), true};
  const std::size_t first = std::min(text.find_first_not_of(" \t"), text.size());
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const bool bracket = c == '[' && at == first;
    if (c != '(' && c != ';' && !bracket) {
      out.code += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      ++at;
      continue;
    }
    const std::size_t end = c == ';' ? text.size() : end_of_comment(text, at, c, bracket ? ']' : ')');
    if (!out.has_comment) out.comment = std::string(without_quotes(text.substr(at + 1, end - at - 1)));
    out.has_comment = true;
    at = std::min(end, text.size() - 1) + 1;
  }
  return out;
}

}  // namespace

std::string code_of_line(const SourceText& program, std::size_t line) { return split(program.line(line)).code; }

std::vector<CommentedLine> commented_lines(const SourceText& program) {
  std::vector<CommentedLine> out;
  for (std::size_t line = 1; line <= program.line_count(); ++line) {
    if (program.line(line).find_first_of("(;[*") == std::string_view::npos) continue;
    Split parts = split(program.line(line));
    if (parts.has_comment) out.push_back({line, std::move(parts.code), std::move(parts.comment)});
  }
  return out;
}

namespace {

/// Three numbers with or without units: "X= 1676.400, Y= 3200.400, Z= 31.877", "12.104\" x 12.588\" x 0.170\"".
std::optional<Vec3> three_sizes(const std::string& text, bool inch) {
  static const std::regex kThree(
      R"((?:X\s*[=:]?\s*)?(-?\d*\.?\d+\.?)\s*(MM|IN(?:CH(?:ES)?)?|")?\s*[,X*\s]\s*(?:[YX*]\s*[=:]?\s*)?(-?\d*\.?\d+\.?)\s*(MM|IN(?:CH(?:ES)?)?|")?\s*[,X*\s]\s*(?:[ZX*]\s*[=:]?\s*)?(-?\d*\.?\d+\.?)\s*(MM|IN(?:CH(?:ES)?)?|")?)",
      std::regex::icase);
  std::smatch m;
  if (!std::regex_search(text, m, kThree)) return std::nullopt;
  const std::string last = m[6].str();  // "100 x 50 x 20 mm"
  Vec3 out;
  for (int i = 0; i < 3; ++i) {
    const auto value = parse_number(m[static_cast<std::size_t>(1 + 2 * i)].str());
    if (!value) return std::nullopt;
    std::string unit = m[static_cast<std::size_t>(2 + 2 * i)].str();
    if (unit.empty()) unit = last;
    const bool metric = !unit.empty() && (unit[0] == 'm' || unit[0] == 'M');
    out[i] = *value * ((unit.empty() ? inch : !metric) ? kMmPerInch : 1);
  }
  return out;
}

std::optional<Box> cutviewer_block(const std::string& comment, bool inch, std::optional<Vec3>& size) {
  static const std::regex kBlock(R"(^\s*STOCK\s*/\s*BLOCK\s*,(.*)$)", std::regex::icase), kNumber(R"(-?\d*\.?\d+\.?)");
  std::smatch m;
  if (!std::regex_search(comment, m, kBlock)) return std::nullopt;
  std::vector<double> n;
  const std::string list = m[1].str();
  for (std::sregex_iterator at(list.begin(), list.end(), kNumber), end; at != end; ++at)
    if (const auto value = parse_number(at->str())) n.push_back(*value * (inch ? kMmPerInch : 1));
  if (n.size() < 3) return std::nullopt;
  size = Vec3(n[0], n[1], n[2]);
  if (n.size() < 6) return std::nullopt;
  const Vec3 zero(n[3], n[4], n[5]);
  return Box{-zero, *size - zero};
}

bool is_box(const Box& box) { return ((box.max_mm - box.min_mm).array() > 0).all(); }

struct Patterns {
  std::regex min{R"(^\s*(?:STOCK\s*MIN|(?:STOCK\s+|MATERIAL\s+)?MIN\s*EXTENTS?)\s*[:=]?(.*)$)", std::regex::icase};
  std::regex max{R"(^\s*(?:STOCK\s*MAX|(?:STOCK\s+|MATERIAL\s+)?MAX\s*EXTENTS?)\s*[:=]?(.*)$)", std::regex::icase};
  std::regex size{
      R"(^\s*(?:(?:RAW\s+)?MATERIAL|STOCK|BLANK|WORKPIECE|BLOCK|ROHTEIL|RAW)\s*(?:SIZE|DIMENSIONS?)?\s*[:=]?(.*)$)",
      std::regex::icase};
  std::regex table{R"(Z\s*(?:ZERO|ORIGIN|0).*(?:TABLE|BED|BOTTOM)|ORIGIN\s*=.*(?:TABLE|BED))", std::regex::icase};
  std::regex surface{R"(Z\s*(?:ZERO|ORIGIN|0).*(?:SURFACE|TOP)|ORIGIN\s*=.*(?:SURFACE|TOP))", std::regex::icase};
  std::regex centre{R"(ORIGIN\s*[=:]?\s*CENT(?:ER|RE)|XY\s*(?:ZERO|ORIGIN).*CENT(?:ER|RE))", std::regex::icase};
  std::regex corner{R"(ORIGIN\s*[=:]?\s*(?:LOWER|BOTTOM)[ -]?LEFT|XY\s*(?:ZERO|ORIGIN).*(?:LOWER|BOTTOM)[ -]?LEFT)",
                    std::regex::icase};
};

}  // namespace

std::optional<CommentedStock> stock_in_comments(const SourceText& program, bool inch) {
  static const Patterns patterns;
  CommentedStock out;
  std::optional<Vec3> low, high;
  bool size_follows = false;
  const auto found = [&](const CommentedLine& line) {
    if (out.from.empty()) out.from = fmt::format("{}:{}", program.name(), line.line), out.what = line.comment;
  };
  for (const CommentedLine& line : commented_lines(program)) {
    const std::string& text = line.comment;
    std::smatch m;
    if (!out.box && !out.size_mm) {
      if (const auto block = cutviewer_block(text, inch, out.size_mm); block && is_box(*block)) out.box = block;
      if (out.size_mm) found(line);
    }
    const bool is_low = std::regex_search(text, m, patterns.min);
    if (is_low || std::regex_search(text, m, patterns.max)) {
      auto& end = is_low ? low : high;
      if (!end) end = three_sizes(m[1].str(), inch);
      if (end) found(line);
      size_follows = false;
      continue;
    }
    const bool names_size = std::regex_search(text, m, patterns.size);
    if (!out.size_mm && (names_size || size_follows))
      if (const auto size = three_sizes(names_size ? m[1].str() : text, inch); size && (size->array() > 0).all()) {
        out.size_mm = size;
        found(line);
      }
    size_follows = names_size && !out.size_mm;
    if (std::regex_search(text, patterns.table))
      out.zero_on_table = true;
    else if (std::regex_search(text, patterns.surface))
      out.zero_on_table = false;
    if (std::regex_search(text, patterns.centre))
      out.zero_in_centre = true;
    else if (std::regex_search(text, patterns.corner))
      out.zero_in_centre = false;
  }
  if (!out.box && low && high && is_box({*low, *high})) out.box = Box{*low, *high};
  return out.box || out.size_mm ? std::optional(out) : std::nullopt;
}

}  // namespace camber::machine
