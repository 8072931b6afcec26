#include "machine/stock_comments.h"

#include <array>
#include <regex>
#include <vector>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/program_comments.h"

namespace camber::machine {
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
