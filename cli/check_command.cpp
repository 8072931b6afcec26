#include "cli/check_command.h"

#include <algorithm>
#include <optional>
#include <ostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "base/output_file.h"
#include "cli/check_page.h"
#include "feedmodel/control_options.h"
#include "machine/job.h"
#include "nc/program.h"
#include "report/planned_picture.h"
#include "simulate/machine_checks.h"
#include "simulate/setup_checks.h"

namespace camber::cli {
namespace {

using nlohmann::ordered_json;

std::vector<Diagnostic> in_order(std::vector<Diagnostic> list) {
  std::stable_sort(list.begin(), list.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.location.line, a.location.column) < std::pair(b.location.line, b.location.column);
  });
  return list;
}

/// As the control of the job's machine, or of the machine, reads it.
nc::InterpreterOptions options_of(const CheckCommand& command, const machine::Machine* machine,
                                  const machine::Job* job) {
  nc::InterpreterOptions options = command.interpreter;
  if (job && !options.inch) options.inch = job->inch;
  return machine ? feedmodel::interpreter_options(*machine, options) : options;
}

struct Checked {
  nc::Summary summary;
  report::PathPicture picture;  ///< where a page is asked for
};

/// As the control of the machine plans it, where a machine is known.
report::PathPicture picture_of(const nc::Interpretation& moves, const machine::Machine* machine) {
  return machine ? report::planned_picture(moves, *machine, report::kMaxPicturePoints)
                 : report::program_picture(moves, report::kMaxPicturePoints);
}

Checked read_and_summarize(const CheckCommand& command, Diagnostics& found) {
  std::optional<machine::Job> job;
  std::optional<machine::Machine> machine;
  if (!command.job.empty()) {
    job = machine::read_job(command.job, found);
    machine = job->machine;
  } else if (!command.machine.empty()) {
    machine = machine::read_machine(command.machine, found);
  }
  const nc::Program text = nc::read_program(SourceText::read(command.program), found);
  const nc::Interpretation moves =
      nc::interpret(text, options_of(command, machine ? &*machine : nullptr, job ? &*job : nullptr), found);
  found.throw_if_errors();
  if (machine) simulate::check_machine(*machine, text, moves, found);
  if (job)
    simulate::check_job(*job, text, moves, found);
  else if (machine)
    simulate::check_spindle(text, moves, found);
  found.throw_if_errors();
  Checked checked{nc::summarize(text, moves), {}};
  if (!command.report.empty()) checked.picture = picture_of(moves, machine ? &*machine : nullptr);
  return checked;
}

std::string unit_text(const nc::Summary& s) {
  if (s.has_mm && s.has_inch) return "mm and inch";
  return s.has_inch ? "inch" : "mm";
}

std::string extents_text(const nc::Extents& e) {
  if (e.empty()) return "none";
  std::string out;
  for (int axis = 0; axis < 3; ++axis)
    out += fmt::format("{}{} {:.3f} to {:.3f}", axis > 0 ? "  " : "", "XYZ"[axis], e.min_mm[axis], e.max_mm[axis]);
  return out;
}

std::string tool_table(const std::vector<nc::ToolUse>& tools) {
  if (tools.empty()) return {};
  constexpr const char* kRow = "{:>4} {:>6} {:>6} {:>16} {:>14} {:>9} {}\n";
  std::string out =
      "\n" + fmt::format(kRow, "tool", "line", "moves", "feed mm/min", "spindle rpm", "cut mm", "cut Z mm");
  for (const auto& t : tools) {
    const std::string z = cut_depths_text(t);
    out += fmt::format(kRow, fmt::format("T{}", t.tool), t.line, t.cutting_moves, range_text(t.feed_mm_per_min, 1),
                       range_text(t.spindle_speed_rpm, 0), fmt::format("{:.1f}", t.cutting_length_mm), z);
  }
  return out;
}

ordered_json extents_json(const nc::Extents& e) {
  if (e.empty()) return nullptr;
  return {{"min", {e.min_mm.x(), e.min_mm.y(), e.min_mm.z()}}, {"max", {e.max_mm.x(), e.max_mm.y(), e.max_mm.z()}}};
}

ordered_json range_json(const nc::Range& r) {
  if (r.empty()) return nullptr;
  return {{"min", r.min}, {"max", r.max}};
}

ordered_json tool_json(const nc::ToolUse& t) {
  return {{"tool", t.tool},
          {"line", t.line},
          {"calls", t.calls},
          {"cutting_moves", t.cutting_moves},
          {"cutting_length_mm", t.cutting_length_mm},
          {"rapid_length_mm", t.rapid_length_mm},
          {"feed_mm_per_min", range_json(t.feed_mm_per_min)},
          {"spindle_speed_rpm", range_json(t.spindle_speed_rpm)},
          {"cutting_extents_mm", extents_json(t.cutting)}};
}

ordered_json diagnostic_json(const Diagnostic& d) {
  return {{"severity", d.severity == Severity::error ? "error" : "warning"},
          {"file", d.location.file},
          {"line", d.location.line},
          {"column", d.location.column},
          {"message", d.message},
          {"check", d.check}};
}

}  // namespace

std::string check_report(const std::string& program, const nc::Summary& s, const Diagnostics& diagnostics) {
  std::string out =
      fmt::format("{}: {} blocks, {} of them with words, {}\n", program, s.blocks, s.blocks_with_words, unit_text(s));
  out += fmt::format("moves     {} rapid, {} linear, {} arc, {} dwell", s.rapids, s.lines, s.arcs, s.dwells);
  const auto of_them = [&out](std::size_t count, const char* what) {
    if (count > 0) out += fmt::format("\n          {} of them {}", count, what);
  };
  of_them(s.canned, "by drilling cycles");
  of_them(s.cutter_radius, "under cutter radius compensation");
  of_them(s.high_speed_contouring, "in high speed contouring");
  of_them(s.reference, "to or from the reference point");
  out += fmt::format("\ncutting   {:.1f} mm\n        {}\n", s.cutting_length_mm, extents_text(s.cutting));
  out += fmt::format("rapid     {:.1f} mm\n        {}\n", s.rapid_length_mm, extents_text(s.rapid));
  if (s.dwells > 0) out += fmt::format("dwell     {} s\n", format_trimmed(s.dwell_s, 3));
  out += tool_table(s.tools);
  const std::size_t warnings = diagnostics.warnings();
  out += fmt::format("\n{}\n",
                     warnings == 0 ? "no warnings" : fmt::format("{} warning{}", warnings, warnings == 1 ? "" : "s"));
  return out;
}

std::string check_json(const std::string& program, const nc::Summary& s, const Diagnostics& diagnostics) {
  ordered_json tools = ordered_json::array(), found = ordered_json::array();
  for (const auto& t : s.tools) tools.push_back(tool_json(t));
  for (const auto& d : diagnostics.all()) found.push_back(diagnostic_json(d));
  const ordered_json report = {{"program", program},
                               {"blocks", s.blocks},
                               {"blocks_with_words", s.blocks_with_words},
                               {"unit", unit_text(s)},
                               {"moves",
                                {{"rapid", s.rapids},
                                 {"linear", s.lines},
                                 {"arc", s.arcs},
                                 {"dwell", s.dwells},
                                 {"canned", s.canned},
                                 {"cutter_radius", s.cutter_radius},
                                 {"high_speed_contouring", s.high_speed_contouring},
                                 {"reference", s.reference}}},
                               {"cutting_length_mm", s.cutting_length_mm},
                               {"rapid_length_mm", s.rapid_length_mm},
                               {"dwell_s", s.dwell_s},
                               {"cutting_extents_mm", extents_json(s.cutting)},
                               {"rapid_extents_mm", extents_json(s.rapid)},
                               {"tools", tools},
                               {"warnings", diagnostics.warnings()},
                               {"diagnostics", found}};
  return report.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

int run_check(const CheckCommand& command, Diagnostics& diagnostics, std::ostream& out) {
  Diagnostics found;
  Checked checked;
  try {
    checked = read_and_summarize(command, found);
  } catch (const InputError& e) {
    throw InputError(in_order(e.diagnostics()));
  }
  Diagnostics ordered;
  for (auto& d : in_order(found.all())) ordered.add(std::move(d));
  if (!command.json.empty()) write_file(command.json, check_json(command.program, checked.summary, ordered));
  if (!command.report.empty())
    write_file(command.report, check_page(command, checked.summary, ordered, checked.picture));
  out << check_report(command.program, checked.summary, ordered);
  diagnostics.append(ordered);
  return 0;
}

}  // namespace camber::cli
