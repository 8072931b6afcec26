#include "cli/time_command.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/output_file.h"
#include "calib/cycle_accuracy.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "cli/time_report.h"
#include "feedmodel/control_options.h"
#include "feedmodel/fitted_range.h"
#include "machine/cases.h"
#include "machine/set_number.h"
#include "nc/program.h"
#include "report/cycle_page.h"
#include "report/path_card.h"
#include "report/planned_picture.h"

namespace camber::cli {
namespace {

constexpr std::size_t kMaxPoints = 10000;

nc::Interpretation read_moves(const std::string& path, const machine::Machine& machine, const TimeArguments& arguments,
                              Diagnostics& diagnostics) {
  const nc::Program program = nc::read_program(SourceText::read(path), diagnostics);
  nc::InterpreterOptions options = feedmodel::interpreter_options(machine, arguments.interpreter);
  options.index_table = machine.index.present;
  nc::Interpretation moves = nc::interpret(program, options, diagnostics);
  feedmodel::check_range(moves, path, machine, diagnostics);
  return moves;
}

report::CycleRow row_of(std::string name, std::vector<double> values, const nc::Interpretation& moves,
                        const machine::Machine& machine) {
  report::CycleRow row{std::move(name), std::move(values), feedmodel::cycle_time(moves, machine)};
  row.time.move_s = {};
  return row;
}

/// What was timed, and the path of the first of it where a page is asked for.
struct Timed {
  std::vector<report::CycleRow> rows{};
  report::PathPicture picture{};
};

void add_picture(Timed& timed, const TimeArguments& arguments, const nc::Interpretation& moves,
                 const machine::Machine& machine) {
  if (!arguments.report.empty() && timed.rows.empty())
    timed.picture = report::planned_picture(moves, machine, report::kMaxPicturePoints);
}

/// Every combination of the swept values, the last key running fastest.
Timed sweep_rows(const TimeArguments& arguments, const std::vector<Sweep>& sweeps, const nc::Interpretation& moves,
                 const machine::Machine& machine, ProgressLine& progress) {
  std::size_t points = 1;
  for (const Sweep& sweep : sweeps) points *= sweep.values.size();
  Timed timed;
  for (std::size_t i = 0; i < points; ++i) {
    progress.show("timing", static_cast<double>(i) / static_cast<double>(points));
    machine::Machine changed = machine;
    std::vector<double> values(sweeps.size());
    std::string name;
    std::size_t rest = i;
    for (std::size_t k = sweeps.size(); k-- > 0; rest /= sweeps[k].values.size())
      values[k] = sweeps[k].values[rest % sweeps[k].values.size()];
    for (std::size_t k = 0; k < sweeps.size(); ++k) {
      machine::set_number(changed, sweeps[k].key, values[k]);
      name += fmt::format("{}{}", k > 0 ? " / " : "", format_trimmed(values[k], 4));
    }
    add_picture(timed, arguments, moves, changed);
    timed.rows.push_back(row_of(std::move(name), std::move(values), moves, changed));
  }
  return timed;
}

Timed case_rows(const TimeArguments& arguments, const machine::Machine* machine, Diagnostics& diagnostics) {
  Timed timed;
  for (const machine::CycleCase& one : machine::read_cases(arguments.cases, machine, diagnostics)) {
    const std::string& program = one.program.empty() ? arguments.program : one.program;
    Diagnostics found;
    const nc::Interpretation moves = read_moves(program, one.machine, arguments, found);
    found.throw_if_errors();
    for (const Diagnostic& d : found.all()) {
      const auto same = [&](const Diagnostic& known) { return to_string(known) == to_string(d); };
      if (std::none_of(diagnostics.all().begin(), diagnostics.all().end(), same)) diagnostics.add(d);
    }
    add_picture(timed, arguments, moves, one.machine);
    timed.rows.push_back(row_of(one.title.empty() ? one.name : one.name + ": " + one.title, {}, moves, one.machine));
  }
  return timed;
}

std::vector<Sweep> checked_sweeps(const TimeArguments& arguments, const machine::Machine& machine) {
  std::vector<Sweep> sweeps;
  std::size_t points = 1;
  for (const std::string& text : arguments.sweeps) {
    sweeps.push_back(parse_sweep(text));
    points *= sweeps.back().values.size();
    machine::Machine probe = machine;
    for (const double value : sweeps.back().values) {
      const std::string wrong = machine::set_number(probe, sweeps.back().key, value);
      if (!wrong.empty()) fail_on_file(arguments.machine, "--sweep: " + wrong, "sweep-key");
    }
    if (points > kMaxPoints)
      fail_on_file(arguments.machine, fmt::format("--sweep: more than {} points; fewer were expected", kMaxPoints),
                   "sweep-points");
  }
  return sweeps;
}

std::vector<std::string> notes_of(const std::vector<report::CycleRow>& rows) {
  std::vector<std::string> notes;
  const std::size_t unplaced = rows.front().time.unplaced_moves;
  if (unplaced > 0)
    notes.push_back(fmt::format(
        "{} moves to or from the reference point: its place is not known (x_mm, y_mm, z_mm of [tool_change] "
        "in the machine file), that part of their way counts for nothing",
        unplaced));
  return notes;
}

}  // namespace

Sweep parse_sweep(const std::string& text) {
  const std::string wanted = "KEY=FROM:TO:N was expected, as in axis.x.acceleration_mm_per_s2=3500:15000:4";
  const auto equals = text.find('='), first = text.find(':', equals), second = text.find(':', first + 1);
  if (equals == std::string::npos || first == std::string::npos || second == std::string::npos)
    throw std::invalid_argument(text + ": " + wanted);
  const auto from = parse_number(std::string_view(text).substr(equals + 1, first - equals - 1));
  const auto to = parse_number(std::string_view(text).substr(first + 1, second - first - 1));
  const auto count = parse_number(std::string_view(text).substr(second + 1));
  if (!from || !to || !count) throw std::invalid_argument(text + ": " + wanted);
  if (*count < 2 || *count > 1000 || *count != static_cast<int>(*count))
    throw std::invalid_argument(fmt::format("{}: {} points; a whole number from 2 to 1000 was expected", text, *count));
  Sweep sweep{text.substr(0, equals), {}};
  const int n = static_cast<int>(*count);
  for (int i = 0; i < n; ++i) sweep.values.push_back(*from + (*to - *from) * i / (n - 1));
  return sweep;
}

int run_time(const TimeArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  ProgressLine progress(options, "timing");
  std::optional<machine::Machine> machine;
  if (!arguments.machine.empty()) machine = machine::read_machine(arguments.machine, diagnostics);
  TimeReport out{.program = arguments.program, .machine = arguments.machine};
  Timed timed;
  if (!arguments.cases.empty()) {
    timed = case_rows(arguments, machine ? &*machine : nullptr, diagnostics);
    out.machine = arguments.cases;
  } else {
    const std::vector<Sweep> sweeps = checked_sweeps(arguments, *machine);
    const nc::Interpretation moves = read_moves(arguments.program, *machine, arguments, diagnostics);
    diagnostics.throw_if_errors();
    if (sweeps.empty()) {
      feedmodel::CycleTime time = feedmodel::cycle_time(moves, *machine);
      if (!arguments.trace.empty())
        out.accuracy = calib::cycle_accuracy(calib::read_trace(arguments.trace, diagnostics), moves, time);
      time.move_s = {};
      add_picture(timed, arguments, moves, *machine);
      timed.rows.push_back({arguments.machine, {}, std::move(time)});
    } else {
      for (const Sweep& sweep : sweeps) out.keys.push_back(sweep.key);
      timed = sweep_rows(arguments, sweeps, moves, *machine, progress);
    }
  }
  out.rows = std::move(timed.rows);
  progress.clear();
  settle(diagnostics, options);
  out.notes = notes_of(out.rows);
  if (!options.quiet) fmt::print("{}", time_text(out));
  if (!arguments.json.empty()) write_file(arguments.json, time_json(out));
  if (!arguments.report.empty())
    write_file(arguments.report, report::cycle_page({.title = "Cycle time: " + out.program,
                                                     .subtitle = out.machine,
                                                     .keys = out.keys,
                                                     .rows = out.rows,
                                                     .picture = std::move(timed.picture),
                                                     .notes = out.notes}));
  return kDone;
}

}  // namespace camber::cli
