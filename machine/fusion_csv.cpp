// Fusion's export of a tool library as CSV: a row for each preset.
#include <map>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/job_keys.h"
#include "machine/library_words.h"

namespace camber::machine {
namespace {

struct Cell {
  std::string text;
  std::size_t offset = 0;
};
using Row = std::vector<Cell>;

[[noreturn]] void fail_at(const SourceText& source, std::size_t offset, std::string message) {
  throw InputError({source.diagnostic(Severity::error, offset, std::move(message), "tool-library")});
}

/// Rows of cells, which may be in quotes and then hold commas, line ends and doubled quotes (RFC 4180).
class CsvScanner {
 public:
  explicit CsvScanner(const SourceText& source) : source_(source), text_(source.text()) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
  }

  /// Empty at the end.
  Row row() {
    while (at_ < text_.size() && (text_[at_] == '\r' || text_[at_] == '\n')) ++at_;
    Row out;
    if (at_ >= text_.size()) return out;
    out.push_back(cell());
    while (at_ < text_.size() && text_[at_] == ',') {
      ++at_;
      out.push_back(cell());
    }
    return out;
  }

 private:
  Cell cell() {
    Cell out{{}, at_};
    if (at_ < text_.size() && text_[at_] == '"') {
      quoted(out.text);
      if (at_ < text_.size() && std::string_view(",\r\n").find(text_[at_]) == std::string_view::npos)
        fail_at(source_, at_, fmt::format("'{}' after a text in quotes; a comma was expected", text_[at_]));
      return out;
    }
    const std::size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
    out.text = text_.substr(at_, end - at_);
    at_ = end;
    return out;
  }

  void quoted(std::string& out) {
    const std::size_t from = at_++;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] != '"') {
        out += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        out += text_[at_++];
      } else {
        ++at_;
        return;
      }
    }
    fail_at(source_, from, "the quotes that begin here do not end; a closing \" was expected");
  }

  const SourceText& source_;
  const std::string& text_;
  std::size_t at_ = 0;
};

/// "Diameter (tool_diameter)" is tool_diameter.
std::string column_name(const std::string& heading) {
  const auto open = heading.rfind('('), close = heading.rfind(')');
  return open == std::string::npos || close == std::string::npos || close < open
             ? heading
             : heading.substr(open + 1, close - open - 1);
}

class CsvTool {
 public:
  CsvTool(const SourceText& source, const std::map<std::string, std::size_t>& columns, const Row& row)
      : source_(source), columns_(columns), row_(row) {}

  ToolProposal read() const {
    ToolProposal tool;
    tool.from = fmt::format("{}:{}", source_.name(), source_.location(row_.front().offset).line);
    const std::string type = text("tool_type");
    tool.what = text("tool_description").empty() ? type : text("tool_description");
    const double unit = unit_mm();
    if (!text("tool_number").empty()) {
      const double number = value("tool_number", 1);
      if (!kToolNumber.holds(number))
        fail_at(source_, offset("tool_number"),
                fmt::format("tool number {}; a whole number was expected", text("tool_number")));
      tool.number = static_cast<int>(number);
    }
    set_fusion_cutter(tool, type,
                      {.diameter = value("tool_diameter", unit),
                       .corner_radius = value("tool_cornerRadius", unit),
                       .flute_length = value("tool_fluteLength", unit),
                       .body_length = value("tool_bodyLength", unit),
                       .overall_length = value("tool_overallLength", unit),
                       .shank_diameter = value("tool_shaftDiameter", unit),
                       .shoulder_diameter = value("tool_shoulderDiameter", unit),
                       .shoulder_length = value("tool_shoulderLength", unit),
                       .tip_diameter = value("tool_tipDiameter", unit),
                       .flutes = value("tool_numberOfFlutes", 1),
                       .taper_deg = value("tool_taperAngle", 1),
                       .point_deg = value("tool_tipAngle", 1)});
    tool.youngs_modulus_GPa = modulus_of_library_GPa(text("tool_material"));
    read_holder(tool, unit);
    return tool;
  }

 private:
  const Cell* cell(const char* column) const {
    const auto at = columns_.find(column);
    return at == columns_.end() || at->second >= row_.size() ? nullptr : &row_[at->second];
  }
  std::string text(const char* column) const {
    const Cell* at = cell(column);
    return at ? at->text : std::string();
  }
  std::size_t offset(const char* column) const {
    const Cell* at = cell(column);
    return at ? at->offset : row_.front().offset;
  }

  double unit_mm() const {
    const std::string unit = text("tool_unit");
    if (unit == "inches") return kMmPerInch;
    if (unit != "millimeters")
      fail_at(source_, offset("tool_unit"), fmt::format("unit \"{}\"; millimeters or inches was expected", unit));
    return 1;
  }

  /// Zero where the cell is empty.
  double value(const char* column, double unit) const {
    const std::string word = text(column);
    if (word.empty()) return 0;
    const auto number = parse_number(word);
    if (!number) fail_at(source_, offset(column), fmt::format("{} \"{}\"; a number was expected", column, word));
    return *number * unit;
  }

  /// "H17.5 U28.0 L28.0; H5.0 U40.0 L28.0": height, upper and lower diameter of each segment, from the nose up.
  void read_holder(ToolProposal& tool, double unit) const {
    const std::string all = text("holder_segments");
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t end = std::min(all.find(';', at), all.size());
      HolderPart part;
      std::string segment = all.substr(at, end - at);
      at = end + 1;
      for (std::size_t word = segment.find_first_not_of(' '); word != std::string::npos;) {
        const std::size_t stop = std::min(segment.find(' ', word), segment.size());
        const auto number = parse_number(std::string_view(segment).substr(word + 1, stop - word - 1));
        double* into = segment[word] == 'H'   ? &part.length_mm
                       : segment[word] == 'U' ? &part.upper_diameter_mm
                       : segment[word] == 'L' ? &part.lower_diameter_mm
                                              : nullptr;
        if (!number || !into)
          fail_at(source_, offset("holder_segments"),
                  fmt::format("\"{}\" in the holder's segments; words as in H20 U40 L28 were expected",
                              segment.substr(word, stop - word)));
        *into = *number * unit;
        word = segment.find_first_not_of(' ', stop);
      }
      if (part.length_mm > 0) tool.holder.push_back(part);
    }
  }

  const SourceText& source_;
  const std::map<std::string, std::size_t>& columns_;
  const Row& row_;
};

}  // namespace

std::vector<ToolProposal> read_fusion_csv(const std::string& path) {
  const SourceText source = SourceText::read(path);
  CsvScanner scanner(source);
  std::map<std::string, std::size_t> columns;
  const Row head = scanner.row();
  for (std::size_t i = 0; i < head.size(); ++i) columns.emplace(column_name(head[i].text), i);
  for (const char* needed : {"tool_index", "tool_type", "tool_diameter", "tool_unit"})
    if (!columns.contains(needed))
      fail_at(source, 0, fmt::format("no column ({}); a tool library of Fusion (Export, CSV) was expected", needed));
  std::vector<ToolProposal> out;
  std::string last;
  for (Row row = scanner.row(); !row.empty(); row = scanner.row()) {
    const std::size_t at = columns["tool_index"];
    if (row.size() < 2 || row.size() <= at)
      fail_at(source, row.front().offset,
              fmt::format("{} cells; {} were expected, as in the first line", row.size(), head.size()));
    if (row[at].text == last) continue;
    last = row[at].text;
    out.push_back(CsvTool(source, columns, row).read());
  }
  return out;
}

}  // namespace camber::machine
