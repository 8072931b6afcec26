// [force_log] of a job into a ForceLog.
#include <algorithm>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/force_law.h"
#include "machine/force_log.h"
#include "machine/job_keys.h"
#include "machine/job_tables.h"
#include "machine/material_reader.h"

namespace camber::machine {
namespace {

constexpr std::array<std::string_view, 2> kContentsWords{"means", "samples"};
constexpr std::array<std::string_view, 2> kFitWords{"means", "waveform"};
constexpr std::array<std::string_view, 2> kMillingWords{"up", "down"};
constexpr std::array<std::string_view, 2> kSideWords{"tool", "work"};
constexpr std::array<std::string_view, 3> kForceUnitWords{"N", "kN", "lbf"};
constexpr std::array<double, 3> kNewtons{1, 1000, 4.4482216152605};
constexpr NumberRange kColumnNumber{.min = 1, .max = 10000, .whole = true};

/// `key = "name"`, `key = { column = "name" or number, scale = .., unit = .. }`, or a number: the constant.
std::optional<LogQuantity> read_quantity(TomlTable& table, std::string_view key, const NumberRange& range,
                                         bool is_force) {
  const auto kind = table.kind_of(key);
  if (!kind) return std::nullopt;
  LogQuantity q;
  if (*kind == TomlNode::Kind::text) {
    q.column = table.text(key, "");
  } else if (*kind == TomlNode::Kind::table) {
    TomlTable column = *table.table(key);
    if (column.kind_of("column") == TomlNode::Kind::number)
      q.index = static_cast<int>(column.number("column", kColumnNumber, 1));
    else
      q.column = column.required_text("column");
    q.scale = column.number("scale", kAnyNumber, 1);
    if (q.scale == 0) column.error_at("scale", "scale is 0; a number other than zero was expected", "value-range");
    if (is_force) q.scale *= kNewtons[column.choice("unit", kForceUnitWords, 0)];
    column.finish();
  } else if (is_force) {
    table.error_at(key,
                   fmt::format("{}: the name of a column, or {{ column = \"name\", scale = -1 }}, was expected", key),
                   "value-type");
    table.ignore(key);
  } else {
    q.constant = table.number(key, range, 1);
  }
  return q;
}

LogQuantity quantity_or_own_name(TomlTable& table, std::string_view key, const NumberRange& range) {
  if (auto q = read_quantity(table, key, range, false)) return *q;
  LogQuantity q;
  q.column = key;
  return q;
}

void read_feed(TomlTable& table, ForceLog& log) {
  log.feed_is_per_tooth = table.has("feed_per_tooth_mm");
  if (log.feed_is_per_tooth && table.has("feed_mm_per_min"))
    table.error_at_name("feed_mm_per_min", "the log has feed_per_tooth_mm and feed_mm_per_min; one was expected",
                        "key-unused");
  table.ignore("feed_mm_per_min");
  log.feed = quantity_or_own_name(table, log.feed_is_per_tooth ? "feed_per_tooth_mm" : "feed_mm_per_min", kPositive);
}

void read_forces(TomlTable& table, ForceLog& log) {
  constexpr std::array<std::string_view, 3> kKeys{"fx", "fy", "fz"};
  for (std::size_t i = 0; i < 3; ++i) log.force[i] = read_quantity(table, kKeys[i], kAnyNumber, true);
  if (!log.force[0] && !log.force[1] && !log.force[2])
    table.missing("fx", "at least one of fx, fy, fz, each the name of a column,");
}

void read_ranges(TomlTable& table, ForceLog& log) {
  const auto idle = table.number_rows("idle_s", 0, 2, kAnyNumber, "ranges of time, as in [[0, 0.5]],");
  for (const auto& r : idle.value_or(std::vector<std::vector<double>>{})) {
    log.idle_s.push_back({r[0], r[1]});
    if (r[0] >= r[1])
      table.error_at("idle_s", fmt::format("idle_s goes from {} to {} s; the second must be greater", r[0], r[1]),
                     "value-range");
  }
  const auto cuts = table.number_rows("cuts", 0, 5, kNotNegative,
                                      "rows [from s, to s, feed mm/min, axial depth mm, radial depth mm],");
  for (const auto& r : cuts.value_or(std::vector<std::vector<double>>{})) {
    log.cuts.push_back({r[0], r[1], r[2], r[3], r[4]});
    if (r[0] >= r[1])
      table.error_at("cuts", fmt::format("a cut goes from {} to {} s; the second must be greater", r[0], r[1]),
                     "value-range");
    if (r[2] <= 0 || r[3] <= 0 || r[4] <= 0)
      table.error_at("cuts", "a cut has a feed or a depth of zero; numbers greater than zero were expected",
                     "value-range");
    if (log.tool.diameter_mm > 0 && r[4] > log.tool.diameter_mm)
      table.error_at(
          "cuts",
          fmt::format("the radial depth is {} mm; at most the diameter, {}, was expected", r[4], log.tool.diameter_mm),
          "value-range");
  }
  if (cuts && cuts->empty())
    table.error_at("cuts",
                   "cuts is empty; at least one row [from s, to s, feed mm/min, axial depth mm, radial depth mm] "
                   "was expected",
                   "value-count");
  if (log.contents == LogContents::samples && !table.has("cuts"))
    table.missing("cuts", "rows [from s, to s, feed mm/min, axial depth mm, radial depth mm]");
  if (log.contents == LogContents::means)
    for (const auto key : {"cuts", "idle_s"})
      if (table.has(key))
        table.error_at_name(key, fmt::format("{} does not belong to contents = \"means\"", key), "key-unused");
}

void read_hold(TomlTable& table, ForceLog& log) {
  std::vector<std::string> names;
  for (const auto& c : description(log.law).fitted) names.emplace_back(c.key);
  for (const std::string& name :
       table.text_list("hold", "names of coefficients, as in [\"kac_MPa\"],").value_or(std::vector<std::string>{})) {
    if (std::ranges::find(names, name) == names.end())
      table.error_at("hold", fmt::format("hold names \"{}\"; one of {} was expected", name, fmt::join(names, ", ")),
                     "value-unknown");
    log.hold.push_back(name);
  }
}

void read_table(TomlTable table, const std::map<int, Tool>& tools, ForceLog& log) {
  const int number = static_cast<int>(
      table.number("tool", kToolNumber, tools.empty() ? 0 : static_cast<double>(tools.begin()->first)));
  if (tools.contains(number))
    log.tool = tools.at(number);
  else if (!tools.empty())
    table.error_at("tool", fmt::format("the log is of T{0}, but there is no [tool.{0}]", number), "tool-missing");
  if (tools.size() > 1 && !table.has("tool")) table.missing("tool", "the number of the tool that was logged");
  if (log.tool.type == ToolType::drill)
    table.error_at("tool", "the log is of a drill; ball, flat or bull was expected", "tool-type");
  log.contents = static_cast<LogContents>(table.choice("contents", kContentsWords, 1));
  log.waveform = table.choice("fit", kFitWords, 0) == 1;
  if (log.waveform && log.contents == LogContents::means)
    table.error_at("fit", "fit = \"waveform\" needs contents = \"samples\"; a table of means has no waveform",
                   "force-log");
  log.up_milling = table.choice("milling", kMillingWords, 0) == 0;
  log.on_work = table.choice("force_on", kSideWords, 0) == 1;
  log.law = static_cast<ForceLaw>(table.choice("law", ForceLaws::words, 0));
  log.header_line = static_cast<int>(table.number("header_line", kLineNumber, 1));
  read_forces(table, log);
  log.spindle_rpm = quantity_or_own_name(table, "spindle_rpm", kPositive);
  if (log.contents == LogContents::means) {
    read_feed(table, log);
    log.axial_depth_mm = quantity_or_own_name(table, "ap_mm", kPositive);
    log.radial_depth_mm = quantity_or_own_name(table, "ae_mm", kPositive);
  } else {
    log.time = quantity_or_own_name(table, "t_s", kPositive);
    if (table.has("sample_rate_Hz")) log.time.constant = 1 / table.number("sample_rate_Hz", kPositive, 1);
  }
  read_ranges(table, log);
  read_hold(table, log);
  table.finish();
}

}  // namespace

ForceLog read_force_log(const std::string& job_path, Diagnostics& diagnostics) {
  ForceLog log;
  log.path = job_path;
  const auto file = read_toml(job_path, "a job with [tool.1] and [force_log]", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  for (const auto key :
       {"program", "machine", "units", "operations", "stock", "part", "simulation", "compensation", "workpiece"})
    top.ignore(key);
  std::map<int, Tool> tools;
  read_tools(top, std::filesystem::path(job_path).parent_path(), false, tools, diagnostics);
  if (tools.empty() && !top.has("tool")) top.missing("[tool.1]", "the tool that was logged");
  if (auto material = top.table("material"))
    log.material = read_material_table(*material, std::filesystem::path(job_path).parent_path().string(), diagnostics);
  if (auto table = top.table("force_log"))
    read_table(*table, tools, log);
  else if (!top.has("force_log"))
    top.missing("[force_log]", "a table that says how the log is to be read");
  top.finish();
  diagnostics.throw_if_errors();
  return log;
}

}  // namespace camber::machine
