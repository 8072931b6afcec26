#include "calib/column_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <span>

#include "base/units.h"
#include "machine/toml_table.h"

namespace camber::calib {
namespace {

using machine::TomlTable;

constexpr std::size_t kNamesShown = 12;
constexpr double kMaxLine = 4e9;
constexpr std::size_t kGapsShown = 5;
constexpr double kInchMm = 25.4;

struct UnitFactor {
  std::string_view word;
  double factor;
};
constexpr std::array kTimeUnits{UnitFactor{"s", 1}, UnitFactor{"ms", 1e-3}, UnitFactor{"us", 1e-6},
                                UnitFactor{"100ns", 1e-7}};
constexpr std::array kLengthUnits{UnitFactor{"mm", 1}, UnitFactor{"um", 1e-3}, UnitFactor{"nm", 1e-6},
                                  UnitFactor{"m", 1e3}, UnitFactor{"inch", kInchMm}};
constexpr std::array kFeedUnits{UnitFactor{"mm/min", 1.0 / 60}, UnitFactor{"mm/s", 1}, UnitFactor{"m/min", 1000.0 / 60},
                                UnitFactor{"m/s", 1000}, UnitFactor{"inch/min", kInchMm / 60}};
constexpr std::array kAngleUnits{UnitFactor{"deg", 1}, UnitFactor{"mdeg", 1e-3}, UnitFactor{"rad", 180 / kPi}};
constexpr std::array kCountUnits{UnitFactor{"1", 1}};
constexpr std::array<std::string_view, 4> kSeparatorWords{",", ";", "tab", "blank"};
constexpr std::array kSeparators{',', ';', '\t', ' '};

bool is_angle(std::size_t q) { return q >= static_cast<std::size_t>(Quantity::a_cmd); }

bool is_position(std::size_t q) {
  return is_angle(q) ||
         (q >= static_cast<std::size_t>(Quantity::x_cmd) && q <= static_cast<std::size_t>(Quantity::z_act));
}

std::span<const UnitFactor> units_of(std::size_t q) {
  if (q == static_cast<std::size_t>(Quantity::time)) return kTimeUnits;
  if (q == static_cast<std::size_t>(Quantity::feed)) return kFeedUnits;
  if (q == static_cast<std::size_t>(Quantity::line)) return kCountUnits;
  if (is_angle(q)) return kAngleUnits;
  return kLengthUnits;
}

MappedColumn read_column(TomlTable table, std::size_t quantity) {
  MappedColumn c;
  c.name = table.text("name", "");
  const auto index = table.optional_number("index", {.min = 1, .max = 1e6, .whole = true});
  if (index) c.index = static_cast<std::size_t>(*index);
  if (c.name.empty() == !index)
    table.error_at(index ? "index" : "name", "one of name and index is expected", "map-column");
  std::vector<std::string_view> words;
  for (const UnitFactor& u : units_of(quantity)) words.push_back(u.word);
  c.inside_factor = units_of(quantity)[table.choice("unit", words, 0)].factor;
  c.scale = table.number("scale", machine::kAnyNumber, 1);
  c.offset = table.number("offset", machine::kAnyNumber, 0);
  table.finish();
  return c;
}

std::string names_of(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (const Channel& c : channels)
    if (!c.names.empty() && names.size() < kNamesShown) names.push_back("\"" + c.names.front() + "\"");
  return fmt::format("{}{}", fmt::join(names, ", "), channels.size() > kNamesShown ? " ..." : "");
}

const Channel& channel_of(const std::string& path, const std::vector<Channel>& channels, const MappedColumn& column,
                          std::string_view key) {
  if (column.name.empty()) {
    if (column.index <= channels.size()) return channels[column.index - 1];
    fail_on_file(path, fmt::format("{} is column {}; the trace has {}", key, column.index, channels.size()),
                 "map-column");
  }
  for (const Channel& c : channels)
    if (std::find(c.names.begin(), c.names.end(), column.name) != c.names.end()) return c;
  fail_on_file(
      path, fmt::format("{} is \"{}\", which the trace does not have; it has {}", key, column.name, names_of(channels)),
      "map-column");
}

double interpolated(const Channel& c, std::size_t after, double t_s) {
  const double span = c.t_s[after] - c.t_s[after - 1];
  const double u = span > 0 ? (t_s - c.t_s[after - 1]) / span : 1.0;
  return (1 - u) * c.value[after - 1] + u * c.value[after];
}

/// Goes through a channel in time.
class Reader {
 public:
  Reader(const Channel& channel, const MappedColumn& column, bool hold)
      : channel_(channel), column_(column), hold_(hold) {
    assert(channel.value.size() == channel.t_s.size());
    assert(std::ranges::adjacent_find(channel.t_s, std::greater_equal{}) == channel.t_s.end());
  }

  /// Returns the value at a time; nothing before the first sample and, of positions, after the last.
  std::optional<double> at(double t_s) {
    while (next_ < channel_.t_s.size() && channel_.t_s[next_] <= t_s) ++next_;
    if (next_ == 0) return std::nullopt;
    if (hold_ || channel_.t_s[next_ - 1] == t_s) return inside(channel_.value[next_ - 1]);
    if (next_ == channel_.t_s.size()) return std::nullopt;
    return inside(interpolated(channel_, next_, t_s));
  }

 private:
  double inside(double raw) const { return (raw * column_.scale + column_.offset) * column_.inside_factor; }

  const Channel& channel_;
  const MappedColumn& column_;
  bool hold_;
  std::size_t next_ = 0;  // first sample after the time asked for
};

void report_gaps(const ServoTrace& trace, const std::vector<std::size_t>& gaps, Diagnostics& diagnostics) {
  for (std::size_t n = 0; n < std::min(gaps.size(), kGapsShown); ++n)
    diagnostics.add({.severity = Severity::warning,
                     .location = {trace.path, 0, 0},
                     .message = fmt::format("{:.6g} s are missing before {:.6g} s (the samples are {:.6g} s apart); "
                                            "the parts before and after are used separately",
                                            trace.t_s[gaps[n]] - trace.t_s[gaps[n] - 1] - trace.period_s,
                                            trace.t_s[gaps[n]], trace.period_s),
                     .check = "trace-gap",
                     .source_line = {}});
  if (gaps.size() > kGapsShown)
    diagnostics.add({.severity = Severity::warning,
                     .location = {trace.path, 0, 0},
                     .message = fmt::format("{} more gaps in the trace", gaps.size() - kGapsShown),
                     .check = "trace-gap",
                     .source_line = {}});
}

}  // namespace

ColumnMap read_column_map(const std::string& path, Diagnostics& diagnostics) {
  ColumnMap map;
  map.path = path;
  const auto file = machine::read_toml(path, "a column map ([t], [x_cmd] ...)", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  map.separator = kSeparators[top.choice("separator", kSeparatorWords, 0)];
  map.decimal_comma = top.boolean("decimal_comma", false);
  map.skip_lines = static_cast<std::size_t>(top.number("skip_lines", {.min = 0, .max = 1e6, .whole = true}, 0));
  map.header = top.boolean("header", true);
  const auto period_ms = top.optional_number("period_ms", machine::kPositive);
  if (period_ms) map.period_s = *period_ms / 1000;
  bool position = false;
  for (std::size_t q = 0; q < kQuantities; ++q) {
    if (auto table = top.table(kQuantityKeys[q])) map.column[q] = read_column(*table, q);
    position = position || (is_position(q) && map.column[q]);
  }
  top.finish();
  if (!position)
    top.error_at("x_cmd", "the map names no position; at least one of x_cmd y_cmd z_cmd x_act y_act z_act is expected",
                 "map-position");
  if (map.period_s && map.column[0])
    top.error_at("period_ms", "period_ms and [t] are given; one of them is expected", "map-time");
  diagnostics.throw_if_errors();
  return map;
}

ServoTrace trace_of(const std::string& path, const std::vector<Channel>& channels, const ColumnMap& map,
                    Diagnostics& diagnostics) {
  ServoTrace trace;
  trace.path = path;
  const Channel* base = nullptr;
  std::array<std::optional<Reader>, kQuantities> readers;
  for (std::size_t q = 1; q < kQuantities; ++q) {
    if (!map.column[q]) continue;
    const Channel& c = channel_of(path, channels, *map.column[q], kQuantityKeys[q]);
    readers[q].emplace(c, *map.column[q], !is_position(q));
    if (is_position(q) && (!base || c.t_s.size() > base->t_s.size())) base = &c;
  }
  for (int i = 0; i < 3; ++i) {
    trace.has_command[i] = map.column[1 + i].has_value();
    trace.has_actual[i] = map.column[4 + i].has_value();
    trace.has_rotary_command[i] = map.column[9 + i].has_value();
    trace.has_rotary_actual[i] = map.column[12 + i].has_value();
  }
  const bool rotary =
      std::any_of(map.column.begin() + 9, map.column.end(), [](const auto& c) { return c.has_value(); });
  for (const double t : base->t_s) {
    std::array<double, kQuantities> v{};
    bool whole = true;
    for (std::size_t q = 1; q < kQuantities; ++q) {
      if (!readers[q]) continue;
      const auto value = readers[q]->at(t);
      whole = whole && (value || !is_position(q));
      v[q] = value.value_or(0);
    }
    if (!whole) continue;
    trace.t_s.push_back(t);
    trace.command_mm.emplace_back(v[1], v[2], v[3]);
    trace.actual_mm.emplace_back(v[4], v[5], v[6]);
    if (rotary) {
      trace.rotary_command_deg.emplace_back(v[9], v[10], v[11]);
      trace.rotary_actual_deg.emplace_back(v[12], v[13], v[14]);
    }
    if (readers[7]) trace.feed_mm_per_s.push_back(v[7]);
    if (readers[8]) trace.line.push_back(static_cast<std::uint32_t>(std::clamp(v[8] + 0.5, 0.0, kMaxLine)));
  }
  if (trace.size() < 2)
    fail_on_file(path,
                 fmt::format("the trace has {} samples of all its positions; at least two are needed", trace.size()),
                 "trace-empty");
  report_gaps(trace, set_stretches(trace), diagnostics);
  return trace;
}

ServoTrace read_mapped_trace(const std::string& path, const ColumnMap& map, Diagnostics& diagnostics) {
  const SourceText source = SourceText::read(path);
  const std::size_t first = source.text().find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && source.text()[first] == '<')
    return trace_of(path, read_sinumerik_channels(source), map, diagnostics);
  if (first != std::string::npos && source.text()[first] == '{')
    return trace_of(path, read_edge_channels(source), map, diagnostics);
  for (std::size_t line = 1; line <= std::min<std::size_t>(source.line_count(), 100); ++line) {
    const std::string_view text = source.line(line);
    if (text.starts_with("Name") && text.size() > 4 && (text[4] == map.separator))
      return trace_of(path, read_twincat_channels(source, map), map, diagnostics);
  }
  return trace_of(path, read_text_channels(source, map), map, diagnostics);
}

}  // namespace camber::calib
