#include "cli/check_command.h"

#include <memory>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "api/commands/check.h"
#include "api/commands/explain_kinematics.h"
#include "api/commands/program_sequence.h"
#include "base/folders.h"
#include "base/numbers.h"
#include "base/output_file.h"
#include "base/triangle_mesh.h"
#include "cli/check_page.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/pose_track.h"
#include "machine/assumptions.h"
#include "machine/job_file.h"
#include "nc/language.h"
#include "nc/program.h"
#include "report/path_arrays.h"
#include "report/planned_picture.h"
#include "report/setup_sheet.h"

namespace camber::cli {
namespace {

struct Checked {
  nc::Summary summary;
  CheckPicture picture;  ///< where a page is asked for
  std::vector<kinematics::FeedMeaningUse> feed_meanings{};
  std::optional<double> memory_bytes{};  ///< where a job is given
  std::vector<std::string> assumed{};    ///< of job or machine
  std::unique_ptr<nc::Program> text{};   ///< where it is, its moves' places are
  nc::Interpretation moves{};            ///< where a sheet is asked for
};

/// As the control of the machine plans it, where a machine is known; the machine itself where rotary axes turn.
CheckPicture picture_of(const nc::Interpretation& moves, const machine::Machine* machine, const machine::Job* job) {
  CheckPicture picture;
  const bool turns = !moves.rotary.empty();
  picture.path = machine && !turns ? report::planned_picture(moves, *machine, report::kMaxPicturePoints)
                                   : report::program_picture(moves, report::kMaxPicturePoints);
  if (!machine || !turns || !machine->kinematics.given()) return picture;
  picture.machine = *machine;
  if (moves.machine_origin_mm) {
    picture.track = kinematics::programmed_track(*machine, moves);
    picture.work_origin_mm = -*moves.machine_origin_mm;
  } else {
    // The offset moves the pictures alone, but nobody knows how far X, Y and Z are from the ends of their travel.
    nc::Interpretation placed = moves;
    placed.machine_origin_mm = Vec3::Zero();
    picture.track = kinematics::programmed_track(*machine, placed);
    for (machine::Axis& axis : picture.machine->axis) axis.travel_mm = machine::Axis{}.travel_mm;
    picture.offset_assumed = true;
  }
  if (job && !job->part.mesh.empty()) picture.part = read_mesh(job->part.mesh);
  if (job && job->tools.size() == 1) picture.tool_diameter_mm = job->tools.begin()->second.diameter_mm;
  return picture;
}

Checked read_and_summarize(const CheckCommand& command, const std::optional<machine::Job>& job, Diagnostics& found) {
  std::optional<machine::Machine> machine;
  if (job)
    machine = job->machine;
  else if (!command.machine.empty())
    machine = machine::read_machine(command.machine, found);
  Checked checked;
  checked.text = std::make_unique<nc::Program>(
      nc::read_program(SourceText::read(command.program), nc::language_asked_for(command.interpreter), found));
  const nc::Program& text = *checked.text;
  if (job)
    checked.assumed = machine::assumptions(*job);
  else if (machine)
    checked.assumed = machine::assumptions(*machine);
  bool shows_machine = false;
  const auto read = [&](const nc::Interpretation& moves) {
    if (!command.path.empty())
      report::write_path_arrays(command.path, report::program_picture(moves, report::kMaxPathPoints));
    if (command.report.empty()) return;
    checked.picture = picture_of(moves, machine ? &*machine : nullptr, job ? &*job : nullptr);
    checked.summary = nc::summarize(text, moves);
    shows_machine = checked.picture.machine.has_value();
  };
  try {
    api::CheckedProgram program = api::check_program(text, command.interpreter, machine ? &*machine : nullptr,
                                                     job ? &*job : nullptr, found, read);
    checked.summary = program.summary;
    checked.feed_meanings = program.feed_meanings;
    checked.memory_bytes = program.memory_bytes;
    if (!command.sheet.empty()) checked.moves = std::move(program.moves);
  } catch (const InputError& e) {
    // The page shows which axis leaves its travel, and where.
    Diagnostics ordered;
    for (auto& d : api::in_order(e.diagnostics())) ordered.add(std::move(d));
    if (shows_machine) write_file(command.report, check_page(command, checked.summary, ordered, checked.picture));
    throw;
  }
  return checked;
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
    out += fmt::format(kRow, fmt::format("T{}", t.tool), t.line, t.cutting_moves, feeds_text(t),
                       range_text(t.spindle_speed_rpm, 0), fmt::format("{:.1f}", t.cutting_length_mm), z);
  }
  return out;
}

}  // namespace

std::string check_report(const nc::Program& text, const nc::Summary& s, const Diagnostics& diagnostics,
                         std::optional<double> memory_bytes,
                         const std::vector<kinematics::FeedMeaningUse>& feed_meanings) {
  std::string out = fmt::format("{}: {} blocks, {} of them with words, {}\n", text.source.name(), s.blocks,
                                s.blocks_with_words, api::unit_text(s));
  out += fmt::format("language  {} ({})\n", nc::language_of(text).title, text.language_reason);
  out += fmt::format("moves     {} rapid, {} linear, {} arc, {} dwell", s.rapids, s.lines, s.arcs, s.dwells);
  const auto of_them = [&out](std::size_t count, const char* what) {
    if (count > 0) out += fmt::format("\n          {} of them {}", count, what);
  };
  of_them(s.canned, "by drilling cycles");
  of_them(s.cutter_radius, "under cutter radius compensation");
  of_them(s.high_speed_contouring, "in high speed contouring");
  of_them(s.rotary, "turning rotary axes");
  of_them(s.tip_control, "under tool-centre-point control");
  of_them(s.tilted_frame, "in a tilted frame (G68.2)");
  of_them(s.dynamic_offset, "under the dynamic work offset (G254)");
  of_them(s.reference, "to or from the reference point");
  out += fmt::format("\ncutting   {:.1f} mm\n        {}\n", s.cutting_length_mm, extents_text(s.cutting));
  out += fmt::format("rapid     {:.1f} mm\n        {}\n", s.rapid_length_mm, extents_text(s.rapid));
  if (s.dwells > 0) out += fmt::format("dwell     {} s\n", format_trimmed(s.dwell_s, 3));
  for (const kinematics::FeedMeaningUse& use : feed_meanings)
    out += fmt::format("F         {}: {} block{}, first in line {}\n",
                       kinematics::kFeedMeaningTexts[static_cast<std::size_t>(use.meaning)].text, use.moves,
                       use.moves == 1 ? "" : "s", use.first_line);
  out += tool_table(s.tools);
  if (memory_bytes) out += fmt::format("memory    about {:.2g} GB for predict\n", *memory_bytes / 1e9);
  const std::size_t warnings = diagnostics.warnings();
  out += fmt::format("\n{}\n",
                     warnings == 0 ? "no warnings" : fmt::format("{} warning{}", warnings, warnings == 1 ? "" : "s"));
  return out;
}

namespace {

/// By line and column; `found`: what was found of the job.
Checked checked_in_order(const CheckCommand& command, const std::optional<machine::Job>& job, Diagnostics found,
                         Diagnostics& ordered) {
  Checked checked;
  try {
    checked = read_and_summarize(command, job, found);
  } catch (const InputError& e) {
    throw InputError(api::in_order(e.diagnostics()));
  }
  for (auto& d : api::in_order(found.all())) ordered.add(std::move(d));
  return checked;
}

std::string json_of(const Checked& checked, const Diagnostics& ordered) {
  return machine::with_assumptions(
      api::check_json(*checked.text, checked.summary, ordered, checked.memory_bytes, checked.feed_meanings),
      checked.assumed);
}

std::string sheet_text(const machine::Job& job, const std::vector<Checked>& programs, const Diagnostics& found) {
  report::SetupSheet sheet{job, {}, {}};
  for (const Checked& p : programs)
    sheet.programs.push_back({*p.text, p.moves, p.summary, feedmodel::cycle_time(p.moves, job.machine)});
  for (const Diagnostic& d : found.all()) sheet.warnings.push_back(to_string(d));
  return report::setup_sheet_html(sheet);
}

}  // namespace

int run_check(const CheckCommand& given, Diagnostics& diagnostics, std::ostream& out,
              const std::function<void()>& before_output) {
  CheckCommand command = given;
  std::optional<machine::JobOfPrograms> all;
  Diagnostics of_job;
  if (!given.job.empty()) all = machine::read_job_of_programs(given.job, of_job);
  if (all && !given.program.empty()) all->programs = {given.program};
  const std::vector<std::string> names = all ? all->programs : std::vector{given.program};
  const TemporaryFolder folder;
  std::vector<Checked> programs;
  std::vector<std::string> results;
  std::string text, stock;
  for (std::size_t i = 0; i < names.size(); ++i) {
    command.program = names[i];
    if (i > 0) {
      // The blank of the next program is what the undeflected tools of this one leave.
      const std::string left = fmt::format("{}/{}.vdb", folder.path(), i);
      api::save_swept_stock(api::job_of_program(*all, i - 1, stock), left);
      stock = left;
      command.path.clear();
    }
    std::optional<machine::Job> own;
    if (all) own = api::job_of_program(*all, i, stock);
    Diagnostics ordered;
    programs.push_back(checked_in_order(command, own, i == 0 ? of_job : Diagnostics(), ordered));
    const Checked& checked = programs.back();
    results.push_back(json_of(checked, ordered));
    if (!command.report.empty() && i == 0)
      write_file(command.report, check_page(command, checked.summary, ordered, checked.picture));
    text += (i > 0 ? "\n" : machine::assumptions_text(checked.assumed)) +
            check_report(*checked.text, checked.summary, ordered, checked.memory_bytes, checked.feed_meanings);
    diagnostics.append(ordered);
  }
  if (!command.json.empty())
    write_file(command.json, results.size() == 1 ? results.front() : api::join_results(*all, results, names));
  if (!command.sheet.empty()) write_file(command.sheet, sheet_text(all->job, programs, diagnostics));
  if (before_output) before_output();
  out << text;
  return 0;
}

int run_explain_kinematics(const CheckCommand& command, Diagnostics& diagnostics, std::ostream& out) {
  const api::ExplainedKinematics explained = api::explain_kinematics(command.explain_kinematics, diagnostics);
  if (!command.json.empty()) write_file(command.json, api::explained_kinematics_json(explained));
  out << kinematics::to_text(explained.explanation, explained.machine);
  return 0;
}

}  // namespace camber::cli
