#include "calib/force_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/numbers.h"

namespace camber::calib {
namespace {

constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\r") == std::string_view::npos; }

}  // namespace

ForceTable::ForceTable(const std::string& path, int header_line, Diagnostics& diagnostics)
    : source_(SourceText::read(path)), diagnostics_(diagnostics) {
  const std::string& text = source_.text();
  std::size_t number = 0;
  bool have_header = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    ++number;
    if (!have_header && number >= static_cast<std::size_t>(header_line) && !is_blank(line)) {
      have_header = true;
      header_offset_ = at;
      separator_ = line.find('\t') != std::string_view::npos  ? '\t'
                   : line.find(';') != std::string_view::npos ? ';'
                                                              : ',';
    } else if (have_header && !is_blank(line)) {
      rows_.push_back({number, at});
    }
    at = end + 1;
  }
  if (!have_header || rows_.empty())
    fail_on_file(path, "the log is empty; a line that names the columns and rows of numbers were expected",
                 "trace-empty");
  // A row of units has no number in it.
  const auto first = fields(rows_.front().offset);
  if (std::ranges::none_of(first, [](const Field& f) { return parse_number(f.text).has_value(); }) && rows_.size() > 1)
    rows_.erase(rows_.begin());
}

std::vector<ForceTable::Field> ForceTable::fields(std::size_t offset) const {
  const std::string& text = source_.text();
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  std::vector<Field> out;
  for (std::size_t at = offset; at <= end;) {
    std::size_t to = std::min(text.find(separator_, at), end), from = at;
    at = to + 1;
    const auto blank = [&](std::size_t i) { return text[i] == ' ' || text[i] == '\r' || text[i] == '"'; };
    while (from < to && blank(from)) ++from;
    while (to > from && blank(to - 1)) --to;
    out.push_back({std::string_view(text).substr(from, to - from), from});
  }
  return out;
}

std::size_t ForceTable::find_column(const machine::LogQuantity& q, const char* key) {
  const auto header = fields(header_offset_);
  const auto error = [&](std::string message) {
    diagnostics_.add(source_.diagnostic(Severity::error, header.front().offset, std::move(message), "trace-column"));
    return kNoColumn;
  };
  if (q.index > 0) {
    if (static_cast<std::size_t>(q.index) <= header.size()) return static_cast<std::size_t>(q.index - 1);
    return error(fmt::format("{} is column {}; the log has {} columns", key, q.index, header.size()));
  }
  const auto at = std::ranges::find(header, q.column, &Field::text);
  if (at != header.end()) return static_cast<std::size_t>(at - header.begin());
  std::vector<std::string_view> names;
  for (const Field& f : header) names.push_back(f.text);
  return error(fmt::format("there is no column \"{}\" for {} of [force_log]; the columns are {}", q.column, key,
                           fmt::join(names, ", ")));
}

std::vector<double> ForceTable::values(const machine::LogQuantity& q, const char* key) {
  if (q.constant) return std::vector<double>(rows_.size(), *q.constant);
  std::vector<double> out;
  const std::size_t column = find_column(q, key);
  if (column == kNoColumn) return std::vector<double>(rows_.size(), 1.0);
  out.reserve(rows_.size());
  for (const Row& row : rows_) {
    const auto all = fields(row.offset);
    if (column >= all.size()) {
      diagnostics_.add(source_.diagnostic(
          Severity::error, all.back().offset,
          fmt::format("{} fields; column {} was expected for {}", all.size(), column + 1, key), "trace-fields"));
      out.push_back(1);
      continue;
    }
    const auto value = parse_number(all[column].text);
    if (!value || !std::isfinite(*value)) {
      diagnostics_.add(source_.diagnostic(Severity::error, all[column].offset,
                                          fmt::format("{} is \"{}\"; a number was expected", key, all[column].text),
                                          "trace-number"));
      out.push_back(1);
      continue;
    }
    out.push_back(*value * q.scale);
  }
  return out;
}

void ForceTable::error_at_row(std::size_t row, std::string message, std::string check) {
  diagnostics_.add(source_.diagnostic(Severity::error, rows_[row].offset, std::move(message), std::move(check)));
}

}  // namespace camber::calib
