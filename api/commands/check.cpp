#include "api/commands/check.h"

#include <algorithm>

#include "api/commands/predict.h"
#include "api/commands/rotary_program.h"
#include "base/json.h"
#include "checks/plausibility.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/control_options.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_program.h"
#include "kinematics/offset_check.h"
#include "kinematics/reference_check.h"
#include "kinematics/travel_check.h"
#include "machine/machine_presets.h"
#include "nc/language.h"
#include "simulate/machine_checks.h"
#include "simulate/machine_collisions.h"
#include "simulate/pieces.h"
#include "simulate/setup_checks.h"
#include "simulate/thin_walls.h"

namespace camber::api {
namespace {

nc::InterpreterOptions options_of(nc::InterpreterOptions options, const machine::Machine* machine,
                                  const machine::Job* job) {
  if (job && !options.inch) options.inch = job->inch;
  if (!machine) return options;
  options.rotary_axes = kinematics::rotary_options(*machine);
  if (job && !options.rotary_axes.empty() &&
      machine::is_preset(machine->path)) {  // as the commands that cut read it; what is given counts before
    const kinematics::ReadingOptions assumed = kinematics::reading_of(*job);
    options.work_offsets_mm.insert(assumed.work_offsets_mm.begin(), assumed.work_offsets_mm.end());
    options.tool_offsets.insert(assumed.tool_offsets.begin(), assumed.tool_offsets.end());
  }
  return kinematics::interpreter_options(*machine, options);
}

Json extents_json(const nc::Extents& e) {
  if (e.empty()) return nullptr;
  return {{"min", {e.min_mm.x(), e.min_mm.y(), e.min_mm.z()}}, {"max", {e.max_mm.x(), e.max_mm.y(), e.max_mm.z()}}};
}

Json range_json(const nc::Range& r) {
  if (r.empty()) return nullptr;
  return {{"min", r.min}, {"max", r.max}};
}

Json tool_json(const nc::ToolUse& t) {
  Json out = {{"tool", t.tool},
              {"line", t.line},
              {"calls", t.calls},
              {"cutting_moves", t.cutting_moves},
              {"cutting_length_mm", t.cutting_length_mm},
              {"rapid_length_mm", t.rapid_length_mm},
              {"feed_mm_per_min", range_json(t.feed_mm_per_min)},
              {"spindle_speed_rpm", range_json(t.spindle_speed_rpm)},
              {"cutting_extents_mm", extents_json(t.cutting)}};
  if (!t.feed_deg_per_min.empty()) out["feed_deg_per_min"] = range_json(t.feed_deg_per_min);
  return out;
}

Json diagnostic_json(const Diagnostic& d) {
  return {{"severity", d.severity == Severity::error ? "error" : "warning"},
          {"file", d.location.file},
          {"line", d.location.line},
          {"column", d.location.column},
          {"message", d.message},
          {"check", d.check}};
}

/// A program that calls no tool and names no spindle speed runs in air.
bool is_to_cut(const nc::Interpretation& moves) {
  return std::ranges::any_of(moves.states, [](const nc::ModalState& s) {
    return s.tool > 0 || s.spindle_speed_rpm > 0 || s.spindle != nc::SpindleDirection::stopped;
  });
}

/// As predict's prepare() up to its sweeps: a height map tells of clearance in seconds. Where none describes the job,
/// all of it.
double memory_where_ready(const machine::Job& job, Diagnostics& diagnostics) {
  const auto check = [&](const simulate::SimulatedProgram& program) {
    checks::check_program(job, program, diagnostics);
  };
  const std::optional<machine::Box> stock = simulate::stock_box(job);
  if (stock) {
    Diagnostics of_original;
    const simulate::Programs programs = simulate::read_programs(
        job, {.check = check}, {.program = diagnostics, .original = of_original, .target = diagnostics});
    const double bytes = simulate::check_memory_of(job, programs.of_target(), *stock, diagnostics).total();
    diagnostics.throw_if_errors();
    const simulate::SimulatedProgram& program = programs.program;
    if (simulate::check_heights(job, program, programs.original ? &*programs.original : nullptr, diagnostics,
                                [&](const removal::HeightMap& machined) {
                                  simulate::suggest_workpiece(job, program, machined, diagnostics);
                                })) {
      feedmodel::check_range(program.moves_in_program(), job.program, job.machine, diagnostics);
      simulate::check_machine_collisions(job, program.text(), program.moves_in_program(), diagnostics);
      return bytes;
    }
  }
  Diagnostics of_rest;
  const double bytes = prepare(job, {}, of_rest).setup.target.memory.total();
  diagnostics = of_rest;
  return bytes;
}

/// What predict would say of the job before its cut, as far as it is not said yet. Returns the memory that it needs.
std::optional<double> add_what_predict_says(machine::Job job, const std::string& program, Diagnostics& found) {
  job.program = program;
  Diagnostics of_predict;
  std::vector<Diagnostic> said;
  std::optional<double> memory_bytes;
  try {
    memory_bytes = memory_where_ready(job, of_predict);
    said = of_predict.all();
  } catch (const InputError& refused) {
    said = refused.diagnostics();
  }
  for (const Diagnostic& d : said)
    if (std::ranges::none_of(found.all(), [&](const Diagnostic& f) {
          return f.check == d.check && f.message == d.message && f.location.line == d.location.line;
        }))
      found.add(d);
  return memory_bytes;
}

}  // namespace

std::vector<Diagnostic> in_order(std::vector<Diagnostic> list) {
  std::stable_sort(list.begin(), list.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.location.line, a.location.column) < std::pair(b.location.line, b.location.column);
  });
  return list;
}

std::string unit_text(const nc::Summary& s) {
  if (s.has_mm && s.has_inch) return "mm and inch";
  return s.has_inch ? "inch" : "mm";
}

CheckedProgram check_program(const nc::Program& text, const nc::InterpreterOptions& options,
                             const machine::Machine* machine, const machine::Job* job, Diagnostics& found,
                             const ProgramRead& read) {
  CheckedProgram checked{nc::interpret(text, options_of(options, machine, job), found), {}};
  found.throw_if_errors();
  if (read) read(checked.moves);
  if (machine) simulate::check_machine(*machine, text, checked.moves, found);
  if (machine && machine->kinematics.given()) {
    if (kinematics::has_rotary_motion(checked.moves, *machine))
      kinematics::check_offsets(text, checked.moves, kinematics::Asked::tip_control, found);
    kinematics::check_travel(*machine, text, checked.moves, found);
    kinematics::check_reference_points(*machine, text, checked.moves, found);
  }
  simulate::check_feeds(text, checked.moves, found);
  if (job)
    simulate::check_job(*job, text, checked.moves, found);
  else if (machine || is_to_cut(checked.moves))
    simulate::check_spindle(text, checked.moves, found);
  found.throw_if_errors();
  if (job) checked.memory_bytes = add_what_predict_says(*job, text.source.name(), found);
  found.throw_if_errors();
  checked.summary = nc::summarize(text, checked.moves);
  if (machine) checked.feed_meanings = kinematics::feed_meanings(checked.moves, *machine);
  return checked;
}

std::string check_json(const nc::Program& text, const nc::Summary& s, const Diagnostics& diagnostics,
                       std::optional<double> memory_bytes,
                       const std::vector<kinematics::FeedMeaningUse>& feed_meanings) {
  Json tools = Json::array(), found = Json::array();
  for (const auto& t : s.tools) tools.push_back(tool_json(t));
  for (const auto& d : diagnostics.all()) found.push_back(diagnostic_json(d));
  Json report = {{"program", text.source.name()},
                 {"language", nc::language_of(text).name},
                 {"language_shown_by", text.language_reason},
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
                   {"rotary", s.rotary},
                   {"tip_control", s.tip_control},
                   {"tilted_frame", s.tilted_frame},
                   {"dynamic_offset", s.dynamic_offset},
                   {"reference", s.reference}}},
                 {"cutting_length_mm", s.cutting_length_mm},
                 {"rapid_length_mm", s.rapid_length_mm},
                 {"dwell_s", s.dwell_s},
                 {"cutting_extents_mm", extents_json(s.cutting)},
                 {"rapid_extents_mm", extents_json(s.rapid)},
                 {"tools", tools},
                 {"warnings", diagnostics.warnings()},
                 {"diagnostics", found}};
  for (const kinematics::FeedMeaningUse& use : feed_meanings)
    report["feed_meanings"].push_back(
        {{"meaning", kinematics::kFeedMeaningTexts[static_cast<std::size_t>(use.meaning)].name},
         {"moves", use.moves},
         {"first_line", use.first_line}});
  if (memory_bytes) report["memory_GB"] = *memory_bytes / 1e9;
  return report.dump(2) + "\n";
}

}  // namespace camber::api
