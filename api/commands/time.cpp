#include "api/commands/time.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "api/commands/rotary_program.h"
#include "base/numbers.h"
#include "base/units.h"
#include "calib/cycle_accuracy.h"
#include "feedmodel/fitted_range.h"
#include "feedmodel/joint_map.h"
#include "machine/cycle_cases.h"
#include "machine/set_number.h"
#include "nc/language.h"
#include "report/cycle_page.h"
#include "report/planned_picture.h"
#include "report/timed_track.h"
#include "simulate/machine_checks.h"

namespace camber::api {
namespace {

constexpr std::size_t kMaxPoints = 10000;

/// Warning [feed-low]: cutting moves at a feed per minute that no milling machine is meant to cut at. Many controls
/// read F1 to F9 as numbers of stored feeds.
void check_low_feeds(const nc::Program& program, const nc::Interpretation& moves, Diagnostics& diagnostics) {
  constexpr double kLow_mm_per_min = 10;
  const nc::Move* first = nullptr;
  double slowest = kLow_mm_per_min, time_s = 0;
  std::size_t count = 0;
  for (const nc::Move& m : moves.moves) {
    const double feed = mm_per_min_from_mm_per_s(m.feed_mm_per_s), length = nc::length_mm(moves, m);
    const bool cuts = m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc;
    if (!cuts || m.reference || length <= 0 || feed <= 0 || feed >= kLow_mm_per_min) continue;
    if (moves.state_of(m).feed_mode != nc::FeedMode::per_minute) continue;
    if (!first) first = &m;
    slowest = std::min(slowest, feed);
    time_s += length / m.feed_mm_per_s;
    ++count;
  }
  if (!first) return;
  diagnostics.add(program.source.diagnostic(
      Severity::warning, program.blocks[first->block].offset,
      fmt::format("the feed is {:.3g} mm/min{}, which takes {:.0f} s; {:g} mm/min or more was expected (unit? G93 or "
                  "G95? F1 to F9 are stored feeds on many controls)",
                  slowest, count > 1 ? fmt::format(" or more in this move and {} more", count - 1) : std::string(),
                  time_s, kLow_mm_per_min),
      "feed-low"));
}

nc::Interpretation moves_of(const nc::Program& program, const machine::Machine& machine, const TimeRequest& request,
                            Diagnostics& diagnostics) {
  nc::InterpreterOptions options = rotary_interpreter_options(machine, request.interpreter);
  options.index_table = machine.index.present;
  nc::Interpretation moves = nc::interpret(program, options, diagnostics);
  check_low_feeds(program, moves, diagnostics);
  if (diagnostics.errors() == 0) {
    simulate::check_machine(machine, program, moves, diagnostics);
    check_rotary_motion(machine, program, moves, false, diagnostics);
    place_rotary_moves(machine, moves);
  }
  feedmodel::check_range(moves, program.source.name(), machine, diagnostics);
  return moves;
}

nc::Interpretation read_moves(const std::string& path, const machine::Machine& machine, const TimeRequest& request,
                              Diagnostics& diagnostics) {
  if (request.text && path == request.program) return moves_of(*request.text, machine, request, diagnostics);
  return moves_of(nc::read_program(SourceText::read(path), nc::language_asked_for(request.interpreter), diagnostics),
                  machine, request, diagnostics);
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
  report::MachineCards machine{};
  bool rotary_motion = false;    ///< of the first of it
  bool machine_unknown = false;  ///< a program with rotary motion of which the positions of the axes are not known
};

report::MachineCards machine_of(const nc::Interpretation& moves, const machine::Machine& machine) {
  report::MachinePage page;
  page.time_label = "time, s";
  page.work_origin_mm = -moves.machine_origin_mm.value_or(Vec3::Zero());
  page.notes = {
      "Positions are the predicted actual axes; their time is that of motion, without tool changes and other actions."};
  return report::machine_cards(machine, report::timed_track(machine, moves), page);
}

void add_picture(Timed& timed, const TimeRequest& request, const nc::Interpretation& moves,
                 const machine::Machine& machine) {
  if (!request.picture || !timed.rows.empty()) return;
  const bool rotary = feedmodel::has_rotary_motion(moves, machine);
  timed.machine_unknown = rotary && !joints_known(moves);
  if (rotary && !timed.machine_unknown)
    timed.machine = machine_of(moves, machine);
  else
    timed.picture = report::planned_picture(moves, machine, report::kMaxPicturePoints);
}

/// Every combination of the swept values, the last key running fastest.
Timed sweep_rows(const TimeRequest& request, const std::vector<Sweep>& sweeps, const nc::Interpretation& moves,
                 const machine::Machine& machine) {
  std::size_t points = 1;
  for (const Sweep& sweep : sweeps) points *= sweep.values.size();
  Timed timed;
  for (std::size_t i = 0; i < points; ++i) {
    if (request.progress) request.progress(static_cast<double>(i) / static_cast<double>(points));
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
    timed.rotary_motion = feedmodel::has_rotary_motion(moves, changed);
    add_picture(timed, request, moves, changed);
    timed.rows.push_back(row_of(std::move(name), std::move(values), moves, changed));
  }
  return timed;
}

Timed case_rows(const TimeRequest& request, const machine::Machine* machine, Diagnostics& diagnostics) {
  Timed timed;
  for (const machine::CycleCase& one : machine::read_cases(request.cases, machine, diagnostics)) {
    const std::string& program = one.program.empty() ? request.program : one.program;
    Diagnostics found;
    const nc::Interpretation moves = read_moves(program, one.machine, request, found);
    found.throw_if_errors();
    for (const Diagnostic& d : found.all()) {
      const auto same = [&](const Diagnostic& known) { return to_string(known) == to_string(d); };
      if (std::none_of(diagnostics.all().begin(), diagnostics.all().end(), same)) diagnostics.add(d);
    }
    if (timed.rows.empty()) timed.rotary_motion = feedmodel::has_rotary_motion(moves, one.machine);
    add_picture(timed, request, moves, one.machine);
    timed.rows.push_back(row_of(one.title.empty() ? one.name : one.name + ": " + one.title, {}, moves, one.machine));
  }
  return timed;
}

std::vector<Sweep> checked_sweeps(const TimeRequest& request, const machine::Machine& machine) {
  std::vector<Sweep> sweeps;
  std::size_t points = 1;
  for (const std::string& text : request.sweeps) {
    sweeps.push_back(parse_sweep(text));
    points *= sweeps.back().values.size();
    machine::Machine probe = machine;
    for (const double value : sweeps.back().values) {
      const std::string wrong = machine::set_number(probe, sweeps.back().key, value);
      if (!wrong.empty()) fail_on_file(request.machine_path, "--sweep: " + wrong, "sweep-key");
    }
    if (points > kMaxPoints)
      fail_on_file(request.machine_path, fmt::format("--sweep: more than {} points; fewer were expected", kMaxPoints),
                   "sweep-points");
  }
  return sweeps;
}

/// Programs with rotary motion have a warning with its place instead ([reference-unknown]).
std::vector<std::string> notes_of(const std::vector<report::CycleRow>& rows, bool rotary_motion) {
  std::vector<std::string> notes;
  const feedmodel::CycleUse& all = rows.front().time.all;
  if (all.tool_changes > 0 && all.time.tool_change_s <= 0)
    notes.push_back(
        fmt::format("{} tool change{} take{} 0 s: the machine file has no time for them (tool_to_tool_s or "
                    "chip_to_chip_s of [tool_change])",
                    all.tool_changes, all.tool_changes > 1 ? "s" : "", all.tool_changes > 1 ? "" : "s"));
  if (rotary_motion) return notes;
  const std::size_t unplaced = rows.front().time.unplaced_moves;
  if (unplaced > 0)
    notes.push_back(
        fmt::format("{} moves to or from the reference point: its position is not known (x_mm, y_mm, z_mm of "
                    "[tool_change] in the machine file); that part of their path is ignored",
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

TimedProgram time_program(const TimeRequest& request, Diagnostics& diagnostics) {
  TimedProgram out;
  TimeReport& report = out.report;
  report.program = request.program;
  report.machine = request.cases.empty() ? request.machine_path : request.cases;
  Timed timed;
  if (!request.cases.empty()) {
    timed = case_rows(request, request.machine, diagnostics);
  } else {
    const machine::Machine& machine = *request.machine;
    const std::vector<Sweep> sweeps = checked_sweeps(request, machine);
    const nc::Interpretation moves = read_moves(request.program, machine, request, diagnostics);
    diagnostics.throw_if_errors();
    if (sweeps.empty()) {
      feedmodel::CycleTime time = feedmodel::cycle_time(moves, machine);
      if (!request.trace.empty())
        report.accuracy = calib::cycle_accuracy(calib::read_trace(request.trace, diagnostics), moves, time);
      time.move_s = {};
      timed.rotary_motion = feedmodel::has_rotary_motion(moves, machine);
      add_picture(timed, request, moves, machine);
      timed.rows.push_back({request.machine_path, {}, std::move(time)});
    } else {
      for (const Sweep& sweep : sweeps) report.keys.push_back(sweep.key);
      timed = sweep_rows(request, sweeps, moves, machine);
    }
  }
  report.rows = std::move(timed.rows);
  report.notes = notes_of(report.rows, timed.rotary_motion);
  if (timed.machine_unknown)
    report.notes.emplace_back(
        "the machine is not drawn: the work offset (G10 L2 in the program, or --work-offset) or the tool length "
        "(--tool-length) is not known");
  out.picture = std::move(timed.picture);
  out.machine = std::move(timed.machine);
  return out;
}

}  // namespace camber::api
