// Channels from lines of separated numbers, and from TwinCAT Scope's export.
#include <fmt/format.h>

#include <cmath>

#include "base/numbers.h"
#include "calib/column_map.h"

namespace camber::calib {
namespace {

constexpr double kFileTimeTicks = 1e15;   // no export lasts so many ms; times since 1601 are more than this
constexpr double kSecondsPerTick = 1e-7;  // FILETIME

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator != ' ') {
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(separator, begin), line.size());
      cells.push_back(trimmed(line.substr(begin, end - begin)));
      begin = end + 1;
    }
    return;
  }
  for (std::size_t begin = line.find_first_not_of(" \t\r"); begin != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(" \t\r", end);
  }
}

std::optional<double> number_of(std::string_view cell, bool decimal_comma) {
  std::optional<double> value;
  if (decimal_comma && cell.find(',') != cell.npos) {
    std::string text(cell);
    text[text.find(',')] = '.';
    value = parse_number(text);
  } else {
    value = parse_number(cell);
  }
  return value && std::isfinite(*value) ? value : std::nullopt;
}

[[noreturn]] void fail_at(const SourceText& source, std::size_t line, std::string message, std::string check) {
  throw InputError({{.severity = Severity::error,
                     .location = {source.name(), line, 1},
                     .message = std::move(message),
                     .check = std::move(check),
                     .source_line = std::string(source.line(line))}});
}

void add(const SourceText& source, std::size_t line, Channel& channel, double t_s, double value) {
  if (!channel.t_s.empty() && t_s <= channel.t_s.back())
    fail_at(source, line, fmt::format("time {} s is not after the sample before it, {} s", t_s, channel.t_s.back()),
            "trace-time");
  channel.t_s.push_back(t_s);
  channel.value.push_back(value);
}

std::size_t time_column(const SourceText& source, const ColumnMap& map, const std::vector<Channel>& channels) {
  const MappedColumn& t = *map.column[0];
  if (t.name.empty()) return t.index - 1;
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (!channels[i].names.empty() && channels[i].names.front() == t.name) return i;
  fail_at(source, map.skip_lines + 1, fmt::format("no column is named \"{}\", the time of {}", t.name, map.path),
          "map-column");
}

}  // namespace

std::vector<Channel> read_text_channels(const SourceText& source, const ColumnMap& map) {
  if (!map.period_s && !map.column[0])
    fail_on_file(map.path, "the map has neither [t] nor period_ms, and lines of numbers have no times of their own",
                 "map-time");
  std::vector<Channel> channels;
  std::vector<std::string_view> cells;
  std::size_t line = map.skip_lines + 1;
  if (map.header && line <= source.line_count()) {
    split(source.line(line++), map.separator, cells);
    for (std::string_view cell : cells) channels.push_back({.names = {std::string(cell)}, .t_s = {}, .value = {}});
  }
  const std::size_t time = map.period_s || channels.empty() ? 0 : time_column(source, map, channels);
  std::size_t row = 0;
  for (; line <= source.line_count(); ++line) {
    split(source.line(line), map.separator, cells);
    std::vector<std::optional<double>> values;
    bool any = false;
    for (std::string_view cell : cells) {
      values.push_back(number_of(cell, map.decimal_comma));
      any = any || values.back();
    }
    if (!any) continue;
    if (channels.size() < values.size() && !map.header) channels.resize(values.size());
    const std::size_t t_column = map.period_s ? 0 : map.header ? time : map.column[0]->index - 1;
    double t_s = static_cast<double>(row++) * map.period_s.value_or(0);
    if (!map.period_s) {
      if (t_column >= values.size() || !values[t_column]) continue;
      const MappedColumn& t = *map.column[0];
      t_s = (*values[t_column] * t.scale + t.offset) * t.inside_factor;
    }
    for (std::size_t i = 0; i < std::min(values.size(), channels.size()); ++i)
      if (values[i]) add(source, line, channels[i], t_s, *values[i]);
  }
  return channels;
}

std::vector<Channel> read_twincat_channels(const SourceText& source, const ColumnMap& map) {
  std::vector<Channel> channels;
  std::vector<std::size_t> time_of;  // of each column, its time column; its own index: a time column
  std::vector<std::size_t> channel_of;
  std::vector<std::string_view> cells;
  std::size_t line = 1;
  while (!source.line(line).starts_with("Name")) ++line;
  split(source.line(line), map.separator, cells);
  std::size_t time = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == "Name") time = i;
    time_of.push_back(time);
    channel_of.push_back(channels.size());
    if (cells[i] != "Name") channels.push_back({.names = {std::string(cells[i])}, .t_s = {}, .value = {}});
  }
  if (channels.empty()) fail_at(source, line, "the line Name names no channel", "twincat-layout");
  std::optional<double> start;
  for (++line; line <= source.line_count(); ++line) {
    split(source.line(line), map.separator, cells);
    if (cells[0] == "EOF") break;
    for (std::size_t i = 0; i < std::min(cells.size(), time_of.size()); ++i) {
      if (time_of[i] == i) continue;
      const auto t = number_of(cells[time_of[i]], map.decimal_comma), value = number_of(cells[i], map.decimal_comma);
      if (!t || !value) continue;
      if (!start) start = *t > kFileTimeTicks ? *t : 0.0;
      const double t_s = *start > 0 ? (*t - *start) * kSecondsPerTick : *t / 1000;
      add(source, line, channels[channel_of[i]], t_s, *value);
    }
  }
  return channels;
}

}  // namespace camber::calib
