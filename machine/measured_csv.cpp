// Measured values from CSV.
#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/numbers.h"
#include "machine/measured_table.h"
#include "machine/toml_table.h"

namespace camber::machine {
namespace {

constexpr std::array<std::string_view, 4> kSeparatorWords{"auto", ",", ";", "tab"};
constexpr std::array kSeparators{'\0', ',', ';', '\t'};
constexpr std::array<std::string_view, 3> kMeasuredUnitWords{"mm", "um", "inch"};
constexpr std::array kMmPerUnit{1.0, 1e-3, 25.4};

struct Cell {
  std::string text;
  std::size_t offset = 0;  ///< in the file
};

std::string trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return std::string(text.substr(from, text.find_last_not_of(" \t\r") - from + 1));
}

/// Cells of a line; quotes keep separators, a doubled quote is one.
std::vector<Cell> cells_of(std::string_view line, std::size_t offset, char separator) {
  std::vector<Cell> out;
  std::string cell;
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    const bool end = i == line.size();
    if (end || (line[i] == separator && !quoted)) {
      out.push_back({trimmed(cell), offset + begin});
      cell.clear();
      begin = i + 1;
    } else if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        cell += line[i++];
      else
        quoted = !quoted;
    } else {
      cell += line[i];
    }
  }
  return out;
}

/// What a header is separated by: a semicolon or a tab where it has one.
char separator_of(std::string_view header) {
  const std::size_t at = header.find_first_of(";\t");
  return at == std::string_view::npos ? ',' : header[at];
}

/// What inspection reports write for a value that is not there: dashes, n/a.
bool is_missing(std::string_view text) {
  return text.empty() || text.find_first_not_of('-') == std::string_view::npos || text == "n/a" || text == "N/A";
}

class Reader {
 public:
  Reader(const SourceText& source, const MeasuredColumns& columns)
      : source_(source), columns_(columns), separator_(columns.separator) {}

  std::vector<MeasuredValue> run() {
    const std::string& text = source_.text();
    for (std::size_t from = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; from < text.size();) {
      const std::size_t end = std::min(text.find('\n', from), text.size());
      take(std::string_view(text).substr(from, end - from), from);
      from = end + 1;
    }
    if (!headed_) fail(0, "is empty; a header that names the columns was expected");
    found_.throw_if_errors();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(std::size_t offset, const std::string& message) {
    throw InputError({source_.diagnostic(Severity::error, offset, message, "measured-table")});
  }

  void take(std::string_view line, std::size_t offset) {
    if (trimmed(line).empty() || trimmed(line).starts_with('#')) return;
    if (separator_ == 0) separator_ = separator_of(line);
    const std::vector<Cell> cells = cells_of(line, offset, separator_);
    headed_ ? row(cells, offset) : header(cells, offset);
  }

  void header(const std::vector<Cell>& cells, std::size_t offset) {
    headed_ = true;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < cells.size(); ++i) column_[cells[i].text] = i, names.push_back(cells[i].text);
    width_ = cells.size();
    for (const std::string& wanted : {columns_.feature, columns_.value})
      if (!column_.contains(wanted))
        fail(offset, fmt::format("the header has no column \"{}\"; it has {}", wanted, fmt::join(names, ", ")));
  }

  const Cell* cell(const std::vector<Cell>& cells, const std::string& name) const {
    const auto at = column_.find(name);
    return at == column_.end() || at->second >= cells.size() || cells[at->second].text.empty() ? nullptr
                                                                                               : &cells[at->second];
  }

  std::optional<double> number(const std::vector<Cell>& cells, const std::string& name) {
    const Cell* c = cell(cells, name);
    if (!c || is_missing(c->text)) return std::nullopt;
    std::string text = c->text;
    if (text.find('.') == std::string::npos) std::ranges::replace(text, ',', '.');  // a decimal comma
    const auto value = parse_number(text);
    if (!value)
      found_.add(source_.diagnostic(Severity::error, c->offset,
                                    fmt::format("{} is \"{}\"; a number was expected", name, c->text),
                                    "measured-table"));
    return value ? std::optional(*value * columns_.mm_per_unit) : std::nullopt;
  }

  void row(const std::vector<Cell>& cells, std::size_t offset) {
    const auto text = [&](const std::string& name) {
      const Cell* c = cell(cells, name);
      return c ? c->text : std::string();
    };
    if (std::any_of(cells.begin() + std::min(width_, cells.size()), cells.end(),
                    [](const Cell& c) { return !c.text.empty(); })) {
      found_.add(source_.diagnostic(Severity::error, cells[width_].offset,
                                    fmt::format("the row has {} cells, the header {}; as many were expected (numbers "
                                                "with a decimal comma: in quotes, or columns separated by ;)",
                                                cells.size(), width_),
                                    "measured-table"));
      return;
    }
    const auto value = number(cells, columns_.value);
    if (!value) return;
    MeasuredValue v{.feature = text(columns_.feature),
                    .part = text(columns_.part),
                    .date = text(columns_.date),
                    .value_mm = *value,
                    .nominal_mm = number(cells, columns_.nominal),
                    .lower_mm = number(cells, columns_.lower),
                    .upper_mm = number(cells, columns_.upper)};
    if (v.feature.empty())
      found_.add(source_.diagnostic(Severity::error, offset, "the row has a value and no feature; a name was expected",
                                    "measured-table"));
    out_.push_back(std::move(v));
  }

  const SourceText& source_;
  const MeasuredColumns& columns_;
  char separator_;
  std::map<std::string, std::size_t> column_;
  std::size_t width_ = 0;  ///< cells of the header
  bool headed_ = false;
  Diagnostics found_;
  std::vector<MeasuredValue> out_;
};

}  // namespace

std::vector<MeasuredValue> read_measured_csv(const std::string& path, const MeasuredColumns& columns) {
  const SourceText source = SourceText::read(path);
  return Reader(source, columns).run();
}

MeasuredColumns read_measured_columns(const std::string& path, Diagnostics& diagnostics) {
  MeasuredColumns out;
  const auto file = read_toml(path, "a column map (feature, part, date, value)", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  for (const auto& [key, field] :
       {std::pair{"feature", &MeasuredColumns::feature}, std::pair{"part", &MeasuredColumns::part},
        std::pair{"date", &MeasuredColumns::date}, std::pair{"value", &MeasuredColumns::value},
        std::pair{"nominal", &MeasuredColumns::nominal}, std::pair{"lower", &MeasuredColumns::lower},
        std::pair{"upper", &MeasuredColumns::upper}})
    out.*field = top.text(key, out.*field);
  out.separator = kSeparators[top.choice("separator", kSeparatorWords, 0)];
  out.mm_per_unit = kMmPerUnit[top.choice("unit", kMeasuredUnitWords, 0)];
  top.finish();
  diagnostics.throw_if_errors();
  return out;
}

std::vector<MeasuredValue> read_measured_table(const std::string& path, const std::string& columns,
                                               Diagnostics& diagnostics) {
  if (path.ends_with(".qif") || path.ends_with(".QIF")) return read_qif(path);
  return read_measured_csv(path, columns.empty() ? MeasuredColumns{} : read_measured_columns(columns, diagnostics));
}

}  // namespace camber::machine
