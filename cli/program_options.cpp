#include "cli/program_options.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/numbers.h"
#include "camber/machine.h"
#include "cli/console.h"
#include "machine/control_kind.h"
#include "nc/dialect.h"
#include "nc/offsets.h"

namespace camber::cli {
namespace {

/// G54=100,50,-300 or G54=100,50,-300,0,0,90: the name and six coordinates.
std::optional<std::pair<std::string, std::vector<double>>> parse_work_offset(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos) return std::nullopt;
  std::string name = text.substr(0, at);
  std::vector<double> values;
  for (std::size_t from = at + 1; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const auto value = parse_number(text.substr(from, to - from));
    if (!value) return std::nullopt;
    values.push_back(*value);
    from = to + 1;
  }
  if (!nc::work_offset_number(name) || (values.size() != 3 && values.size() != 6)) return std::nullopt;
  values.resize(6);
  return std::pair(std::move(name), std::move(values));
}

/// Index of a control in the table: what --dialect maps a name to.
enum class ControlRow : std::uint8_t {};

std::map<std::string, ControlRow> rows_of_controls() {
  std::map<std::string, ControlRow> rows;
  for (const std::string_view name : machine::control_kind_names())
    rows.emplace(name, static_cast<ControlRow>(rows.size()));
  return rows;
}

std::string_view name_of_dialect_with(bool nc::Dialect::*fact) {
  return std::ranges::find(nc::dialects(), true, fact)->name;
}

}  // namespace

void add_reading_options(CLI::App& command, ReadOptions& read) {
  command.add_option("--units", read.inch, "unit of a program without G20 and G21")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"mm", false}, {"inch", true}}).description(""))
      ->type_name("mm|inch");
  command.add_flag("--block-skip", read.skip_slash_blocks, "skip blocks that begin with / or /1 to /9");
  command
      .add_option_function<std::vector<int>>(
          "--skip-switch", [&read](const std::vector<int>& switches) { read.skip_switches = switches; },
          "skip blocks that begin with /N; / is /1")
      ->check(CLI::Range(1, 9))
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->type_name("N");
}

void add_tool_lengths(CLI::App& command, ReadOptions& read) {
  const auto parsed = [](const std::string& text) -> std::optional<std::pair<int, double>> {
    const std::size_t at = text.find('=');
    if (at == std::string::npos) return std::nullopt;
    const auto number = parse_number(text.substr(0, at)), length = parse_number(text.substr(at + 1));
    if (!number || !length || *number < 0 || *number > 9999 || *number != std::floor(*number)) return std::nullopt;
    return std::pair(static_cast<int>(*number), *length);
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--tool-length",
          [&read, parsed](const std::vector<std::string>& given) {
            for (const std::string& text : given)
              if (const auto offset = parsed(text)) read.tool_lengths_mm[offset->first] = offset->second;
          },
          "length of tool offset H, gauge line to tip, mm; for programs with rotary axes")
      ->check(CLI::Validator(
          [parsed](std::string& text) {
            return parsed(text) ? std::string()
                                : text + ": a number of H and a length in mm were expected, such as 1=80";
          },
          ""))
      ->expected(1)
      ->take_all()
      ->type_name("H=MM");
}

void add_language_options(CLI::App& command, ReadOptions& read) {
  command
      .add_option_function<ControlRow>(
          "--dialect",
          [&read](ControlRow row) {
            read.dialect = std::string(machine::control_kind_names()[static_cast<std::size_t>(row)]);
          },
          fmt::format("control of the program; default: from its text (O-words: {}, M97: {}), else {}, with P of a "
                      "dwell in seconds",
                      name_of_dialect_with(&nc::Dialect::shown_by_o_words),
                      name_of_dialect_with(&nc::Dialect::shown_by_m97), nc::default_dialect().name))
      ->transform(CLI::CheckedTransformer(rows_of_controls()).description(""))
      ->type_name(fmt::format("{}", fmt::join(machine::control_kind_names(), "|")));
  command.add_flag_function(
      "--least-increments,!--no-least-increments", [&read](std::int64_t count) { read.least_increments = count > 0; },
      "X1000 without a point is 1000 least increments (1 mm), not 1000 mm");
}

void add_work_offsets(CLI::App& command, ReadOptions& read) {
  command
      .add_option_function<std::vector<std::string>>(
          "--work-offset",
          [&read](const std::vector<std::string>& given) {
            for (const std::string& text : given)
              if (auto offset = parse_work_offset(text)) read.work_offsets[offset->first] = std::move(offset->second);
          },
          "machine coordinates of a work offset, mm and degrees; for the positions of the axes")
      ->check(CLI::Validator(
          [](std::string& text) {
            return parse_work_offset(text) ? std::string()
                                           : text +
                                                 ": a work offset and its machine coordinates were expected, such "
                                                 "as G54=100,50,-300 (A,B,C in degrees may follow)";
          },
          ""))
      ->expected(1)
      ->take_all()
      ->type_name("G54=X,Y,Z[,A,B,C]");
}

CLI::Validator number_from_to(double min, double max) {
  return CLI::Validator(
      [min, max](std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= min && *value <= max
                   ? std::string()
                   : fmt::format("{}: a number from {:g} to {:g} was expected", text, min, max);
      },
      "");
}

CLI::Validator length_validator() {
  return CLI::Validator(
      [](std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= 1e-5 && *value <= 10 ? "" : text + ": a number from 0.00001 to 10 was expected";
      },
      "");
}

void add_rewriting(CLI::App& command, double& tolerance_mm, std::string& output, std::string& page) {
  command.add_option("--tolerance-mm", tolerance_mm, "maximum distance between the new and the old path")
      ->required()
      ->check(length_validator())
      ->type_name("X");
  command.add_option("-o,--output", output, "the new program")->required()->type_name("OUT.nc");
  command.add_option("--report", page, "the page: before and after, deviation, picture")->type_name("R.html");
}

int print_effective_machine(const std::string& path, const GlobalOptions& options) {
  const Machine machine = read_machine(path);
  settle(machine.diagnostics(), options);
  fmt::print("# {}\n{}", path, machine.to_toml());
  return kDone;
}

}  // namespace camber::cli
