#include "camber/time.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "api/job.h"
#include "api/program.h"
#include "api/rotary_program.h"
#include "api/run.h"
#include "base/numbers.h"
#include "base/units.h"
#include "calib/cycle_accuracy.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/machine_program.h"
#include "kinematics/offset_check.h"
#include "machine/assumptions.h"
#include "machine/cycle_cases.h"
#include "machine/set_number.h"
#include "motion/machine_checks.h"
#include "nc/language.h"
#include "report/path_card.h"
#include "report/planned_picture.h"
#include "report/time_summary.h"
#include "report/timed_track.h"

namespace camber {
namespace {

/// A key of machine.toml and the values that it takes in turn.
struct Sweep {
  std::string key;
  std::vector<double> values;
};

/// Throws std::invalid_argument with a sentence for the user.
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

struct TimeAsked {
  const Program& program;
  const machine::Machine* machine;  ///< null: every case names its own
  const TimeOptions& options;
  api::Run& run;
};

constexpr std::size_t kMaxSweepPoints = 10000;

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

nc::Interpretation timed_moves(const nc::Program& program, const machine::Machine& machine, const TimeAsked& asked,
                               Diagnostics& diagnostics) {
  kinematics::ReadingOptions options{.given = asked.program.impl().options, .rotary = kinematics::RotaryWords::always};
  options.given.index_table = machine.index.present;
  nc::Interpretation moves = kinematics::read_moves(program, machine, options, diagnostics);
  check_low_feeds(program, moves, diagnostics);
  if (diagnostics.errors() == 0) {
    motion::check_machine(machine, program, moves, diagnostics);
    api::check_rotary_motion(machine, program, moves, false, diagnostics);
    if (kinematics::has_rotary_motion(moves, machine)) kinematics::place_moves(moves, machine);
  }
  feedmodel::check_range(moves, program.source.name(), machine, diagnostics);
  return moves;
}

/// Returns the moves of the program at `path`; the given program is not read a second time.
nc::Interpretation read_moves(const std::string& path, const machine::Machine& machine, const TimeAsked& asked,
                              Diagnostics& diagnostics) {
  const Program::Impl& given = asked.program.impl();
  if (path == given.path) {
    diagnostics.append(given.found);
    return timed_moves(given.text, machine, asked, diagnostics);
  }
  return timed_moves(nc::read_program(SourceText::read(path), nc::language_asked_for(given.options), diagnostics),
                     machine, asked, diagnostics);
}

report::CycleRow row_of(std::string name, std::vector<double> values, const nc::Interpretation& moves,
                        const machine::Machine& machine) {
  report::CycleRow row{std::move(name), std::move(values), feedmodel::cycle_time(moves, machine)};
  row.time.move_s = {};
  return row;
}

/// Rows that were timed, and the path of the first one where a page is asked for.
struct Timed {
  std::vector<report::CycleRow> rows{};
  report::PathPicture picture{};
  report::MachineCards machine{};
  bool rotary_motion = false;    ///< the first row's program turns rotary axes
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

void add_picture(Timed& timed, const TimeAsked& asked, const nc::Interpretation& moves,
                 const machine::Machine& machine) {
  if (!asked.options.page || !timed.rows.empty()) return;
  const bool rotary = kinematics::has_rotary_motion(moves, machine);
  timed.machine_unknown = rotary && !kinematics::offsets_known(moves);
  if (rotary && !timed.machine_unknown)
    timed.machine = machine_of(moves, machine);
  else
    timed.picture = report::planned_picture(moves, machine, report::kMaxPicturePoints);
}

/// Every combination of the swept values, the last key running fastest.
Timed sweep_rows(const TimeAsked& asked, const std::vector<Sweep>& sweeps, const nc::Interpretation& moves,
                 const machine::Machine& machine) {
  std::size_t points = 1;
  for (const Sweep& sweep : sweeps) points *= sweep.values.size();
  Timed timed;
  for (std::size_t i = 0; i < points; ++i) {
    asked.run.show("timing", static_cast<double>(i) / static_cast<double>(points));
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
    timed.rotary_motion = kinematics::has_rotary_motion(moves, changed);
    add_picture(timed, asked, moves, changed);
    timed.rows.push_back(row_of(std::move(name), std::move(values), moves, changed));
  }
  return timed;
}

Timed case_rows(const TimeAsked& asked, Diagnostics& diagnostics) {
  Timed timed;
  for (const machine::CycleCase& one : machine::read_cases(asked.options.cases, asked.machine, diagnostics)) {
    const std::string& program = one.program.empty() ? asked.program.path() : one.program;
    Diagnostics found;
    const nc::Interpretation moves = read_moves(program, one.machine, asked, found);
    found.throw_if_errors();
    for (const Diagnostic& d : found.all()) {
      const auto same = [&](const Diagnostic& known) { return to_string(known) == to_string(d); };
      if (std::none_of(diagnostics.all().begin(), diagnostics.all().end(), same)) diagnostics.add(d);
    }
    if (timed.rows.empty()) timed.rotary_motion = kinematics::has_rotary_motion(moves, one.machine);
    add_picture(timed, asked, moves, one.machine);
    timed.rows.push_back(row_of(one.title.empty() ? one.name : one.name + ": " + one.title, {}, moves, one.machine));
  }
  return timed;
}

std::vector<Sweep> checked_sweeps(const TimeAsked& asked, const machine::Machine& machine) {
  std::vector<Sweep> sweeps;
  std::size_t points = 1;
  for (const std::string& text : asked.options.sweeps) {
    sweeps.push_back(parse_sweep(text));
    points *= sweeps.back().values.size();
    machine::Machine probe = machine;
    for (const double value : sweeps.back().values) {
      const std::string wrong = machine::set_number(probe, sweeps.back().key, value);
      if (!wrong.empty()) fail_on_file(machine.path, "--sweep: " + wrong, "sweep-key");
    }
    if (points > kMaxSweepPoints)
      fail_on_file(machine.path, fmt::format("--sweep: more than {} points; fewer were expected", kMaxSweepPoints),
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

report::TimeSummary summarize(const TimeAsked& asked, Diagnostics& diagnostics) {
  report::TimeSummary out;
  out.program = asked.program.path();
  out.machine = asked.options.cases.empty() ? asked.machine->path : asked.options.cases;
  Timed timed;
  if (!asked.options.cases.empty()) {
    timed = case_rows(asked, diagnostics);
  } else {
    const machine::Machine& machine = *asked.machine;
    const std::vector<Sweep> sweeps = checked_sweeps(asked, machine);
    const nc::Interpretation moves = read_moves(out.program, machine, asked, diagnostics);
    diagnostics.throw_if_errors();
    if (sweeps.empty()) {
      feedmodel::CycleTime time = feedmodel::cycle_time(moves, machine);
      if (!asked.options.trace.empty())
        out.accuracy = calib::cycle_accuracy(calib::read_trace(asked.options.trace, diagnostics), moves, time);
      time.move_s = {};
      timed.rotary_motion = kinematics::has_rotary_motion(moves, machine);
      add_picture(timed, asked, moves, machine);
      timed.rows.push_back({machine.path, {}, std::move(time)});
    } else {
      for (const Sweep& sweep : sweeps) out.keys.push_back(sweep.key);
      timed = sweep_rows(asked, sweeps, moves, machine);
    }
  }
  out.rows = std::move(timed.rows);
  out.notes = notes_of(out.rows, timed.rotary_motion);
  if (timed.machine_unknown)
    out.notes.emplace_back(
        "the machine is not drawn: the work offset (G10 L2 in the program, or --work-offset) or the tool length "
        "(--tool-length) is not known");
  out.picture = std::move(timed.picture);
  out.cards = std::move(timed.machine);
  return out;
}

TimeUse use_of(const feedmodel::CycleUse& u) {
  const feedmodel::CycleSplit& t = u.time;
  return {.tool = u.tool,
          .tool_changes = u.tool_changes,
          .cutting_moves = u.cutting_moves,
          .cutting_s = t.cutting_s,
          .positioning_s = t.positioning_s,
          .spindle_s = t.spindle_s,
          .tool_change_s = t.tool_change_s,
          .m_code_s = t.m_code_s,
          .dwell_s = t.dwell_s,
          .index_s = t.index_s,
          .pallet_s = t.pallet_s,
          .total_s = t.total_s(),
          .cutting_length_mm = u.cutting_mm,
          .positioning_length_mm = u.positioning_mm,
          .commanded_feed_mm_per_min = mm_per_min_from_mm_per_s(u.commanded_feed_mm_per_s()),
          .average_feed_mm_per_min = mm_per_min_from_mm_per_s(u.average_feed_mm_per_s()),
          .e = u.e(),
          .k = u.k()};
}

TimeResult result_of(const report::TimeSummary& summary, const Diagnostics& found) {
  TimeResult out;
  const feedmodel::CycleTime& first = summary.rows.front().time;
  out.all = use_of(first.all);
  for (const feedmodel::CycleUse& use : first.tools) out.tools.push_back(use_of(use));
  if (!summary.keys.empty())
    for (const auto& row : summary.rows) out.sweep.push_back(use_of(row.time.all));
  out.notes = summary.notes;
  out.diagnostics = found.all();
  return out;
}

TimeResult timed(const Program& program, const Machine* machine, const TimeOptions& options,
                 const RunOptions& run_options) {
  TimeResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = machine ? machine->impl().found : Diagnostics();
    const machine::Machine* on = machine ? &machine->impl().machine : nullptr;
    const report::TimeSummary summary = summarize({program, on, options, run}, found);
    run.settle_first(found);
    const std::vector<std::string> assumed = on ? machine::assumptions(*on) : std::vector<std::string>();
    result = result_of(summary, found);
    if (!options.cases.empty())
      for (const auto& row : summary.rows) result.cases.push_back(use_of(row.time.all));
    result.json = machine::with_assumptions(report::time_json(summary), assumed);
    result.printed = machine::assumptions_text(assumed) + report::time_text(summary);
    if (options.page) result.page = report::time_page(summary);
  });
  return result;
}

}  // namespace

TimeResult v0::time(const Program& program, const Machine& machine, const TimeOptions& options, const RunOptions& run) {
  return timed(program, &machine, options, run);
}

TimeResult v0::time(const Program& program, const TimeOptions& options, const RunOptions& run) {
  if (options.cases.empty()) throw std::invalid_argument("cases: a file that names machines was expected");
  return timed(program, nullptr, options, run);
}

void v0::check_sweep(const std::string& text) { parse_sweep(text); }

}  // namespace camber
