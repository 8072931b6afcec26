#include "camber/check.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "api/job.h"
#include "api/prediction.h"
#include "api/program.h"
#include "api/rotary_program.h"
#include "base/folders.h"
#include "base/output_file.h"
#include "base/triangle_mesh.h"
#include "checks/height_survey.h"
#include "checks/machine_collisions.h"
#include "checks/setup_checks.h"
#include "feedmodel/cycle_time.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/control_options.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_program.h"
#include "kinematics/offset_check.h"
#include "kinematics/reference_check.h"
#include "kinematics/travel_check.h"
#include "machine/assumptions.h"
#include "machine/machine_presets.h"
#include "motion/job_checks.h"
#include "motion/machine_checks.h"
#include "plausibility/plausibility.h"
#include "report/check_summary.h"
#include "report/joined_json.h"
#include "report/mesh_file.h"
#include "report/planned_picture.h"

namespace camber {
namespace {

struct CheckAsked {
  const Program::Impl& program;
  const machine::Machine* machine = nullptr;  ///< null: none
  const machine::Job* job = nullptr;          ///< with its machine as `machine`; null: none
  CheckOptions options{};
};

struct Checked {
  nc::Interpretation moves;
  report::CheckSummary summary;
};

nc::InterpreterOptions options_as_read(nc::InterpreterOptions options, const machine::Machine* machine,
                                       const machine::Job* job) {
  if (job && !options.inch) options.inch = job->inch;
  if (job) {
    const auto radii = kinematics::reading_of(*job).given.tool_offsets;
    options.tool_offsets.insert(radii.begin(), radii.end());
  }
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

/// A program that calls no tool and names no spindle speed runs in air.
bool is_to_cut(const nc::Interpretation& moves) {
  return std::ranges::any_of(moves.states, [](const nc::ModalState& s) {
    return s.tool > 0 || s.spindle_speed_rpm > 0 || s.spindle != nc::SpindleDirection::stopped;
  });
}

/// Returns the job with voxels that show where a tool meets a box or cylinder, in a few seconds; an allowance needs
/// those of the job.
machine::Job coarsened(machine::Job job) {
  constexpr double kOfSide = 1.0 / 300, kMost = 4;
  if ((!job.stock.box && !job.stock.cylinder) || job.stock.allowance_mm > 0) return job;
  const machine::Box box = *checks::stock_box(job);
  double& voxel_mm = job.simulation.voxel_mm;
  voxel_mm = std::clamp(kOfSide * (box.max_mm - box.min_mm).maxCoeff(), voxel_mm, kMost * voxel_mm);
  return job;
}

/// Prepares the job as predict does up to its sweeps: a height map tells of clearance in seconds. Where none describes
/// the job, all of it.
double memory_where_ready(const machine::Job& job, Diagnostics& diagnostics) {
  const auto check = [&](const simulate::SimulatedProgram& program) {
    plausibility::check_program(job, program, diagnostics);
  };
  const std::optional<machine::Box> stock = checks::stock_box(job);
  std::optional<double> bytes;
  if (stock) {
    Diagnostics of_original;
    const simulate::Programs programs = simulate::read_programs(
        job, {.check = check}, {.program = diagnostics, .original = of_original, .target = diagnostics});
    bytes = simulate::check_memory_of(job, programs.of_target(), *stock, diagnostics).total();
    diagnostics.throw_if_errors();
    const simulate::SimulatedProgram& program = programs.program;
    if (simulate::check_heights(job, program, programs.original ? &*programs.original : nullptr, diagnostics,
                                [&](const removal::HeightMap& machined) {
                                  checks::suggest_workpiece(job, program, machined, diagnostics);
                                })) {
      feedmodel::check_range(program.moves_in_program(), job.program, job.machine, diagnostics);
      checks::check_machine_collisions(job, program.text(), program.moves_in_program(), diagnostics);
      return *bytes;
    }
  }
  Diagnostics of_rest;
  const double of_check = api::prepare(coarsened(job), {}, {}, of_rest).setup.target.memory.total();
  diagnostics = of_rest;
  return bytes.value_or(of_check);
}

/// Reports what predict would say of the job before its cut, as far as it is not said yet. Returns the memory that it
/// needs.
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

/// Sorts diagnostics by line and column.
std::vector<Diagnostic> in_order(std::vector<Diagnostic> list) {
  std::stable_sort(list.begin(), list.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.location.line, a.location.column) < std::pair(b.location.line, b.location.column);
  });
  return list;
}

Diagnostics collected(const std::vector<Diagnostic>& list) {
  Diagnostics out;
  for (const Diagnostic& d : list) out.add(d);
  return out;
}

/// Reads a program as the control of the machine does, where one is given. A job also has its tools, stock and part
/// checked, and then everything that predict checks before its cut. `read` is called with a program that could be read,
/// before it is checked against machine and job. Throws InputError.
Checked check_program(const CheckAsked& asked, Diagnostics& found,
                      const std::function<void(const nc::Interpretation&)>& read) {
  const nc::Program& text = asked.program.text;
  const machine::Machine* machine = asked.machine;
  const machine::Job* job = asked.job;
  Checked checked{nc::interpret(text, options_as_read(asked.program.options, machine, job), found), {.text = &text}};
  if (job) motion::assume_spindle(*job, text, checked.moves, found);
  found.throw_if_errors();
  read(checked.moves);
  if (machine) motion::check_machine(*machine, text, checked.moves, found);
  if (machine && machine->kinematics.given()) {
    if (kinematics::has_rotary_motion(checked.moves, *machine))
      kinematics::check_offsets(text, checked.moves, kinematics::Asked::tip_control, found);
    kinematics::check_travel(*machine, text, checked.moves, found);
    kinematics::check_reference_points(*machine, text, checked.moves, found);
  }
  motion::check_feeds(text, checked.moves, found);
  if (job)
    checks::check_job(*job, text, checked.moves, found);
  else if (machine || is_to_cut(checked.moves))
    motion::check_spindle(text, checked.moves, found);
  found.throw_if_errors();
  if (job) checked.summary.memory_bytes = add_what_predict_says(*job, text.source.name(), found);
  found.throw_if_errors();
  checked.summary.program = nc::summarize(text, checked.moves);
  if (machine) checked.summary.feed_meanings = kinematics::feed_meanings(checked.moves, *machine);
  return checked;
}

/// The path as the machine's control plans it, where a machine is known; the machine itself where rotary axes turn.
report::CheckPicture picture_of(const nc::Interpretation& moves, const machine::Machine* machine,
                                const machine::Job* job) {
  report::CheckPicture picture;
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
  if (job && !job->part.mesh.empty()) picture.part = machine::part_mesh(job->part);
  if (job && job->tools.size() == 1) picture.tool_diameter_mm = job->tools.begin()->second.diameter_mm;
  return picture;
}

/// Writes the path: that on the part where rotary axes of a known machine turn, else X, Y and Z.
void write_path(const std::string& path, const nc::Program& text, const nc::Interpretation& moves,
                const machine::Machine* machine) {
  report::PathPicture picture;
  if (machine && machine->kinematics.given() && kinematics::has_rotary_motion(moves, *machine))
    picture = report::tip_picture(kinematics::MachineProgram(text, moves, *machine), report::kMaxPathPoints);
  const bool in_part = !picture.points.empty();
  if (!in_part) picture = report::program_picture(moves, report::kMaxPathPoints);
  report::write_path_arrays(path, picture, in_part);
}

/// Writes the meshes of a job. One that cannot be read is left out: the check says why.
void write_meshes(const machine::Job& job, const std::string& name) {
  const auto write = [&](const char* end, const auto& read) {
    std::string text;
    try {
      if (const TriangleMesh mesh = read(); !mesh.triangles.empty()) text = stl_text(mesh);
    } catch (const InputError&) {
    }
    if (!text.empty()) write_file(name + end, text);
  };
  write("-part.stl", [&] { return job.part.mesh.empty() ? TriangleMesh{} : machine::part_mesh(job.part); });
  write("-blank.stl", [&] { return report::blank_mesh(job); });
}

/// The page also shows which axis leaves its travel, and where.
Checked check_and_draw(const CheckAsked& asked, Diagnostics& found) {
  const nc::Program& text = asked.program.text;
  report::CheckSummary before{.text = &text};
  report::CheckPicture picture;
  const auto write_page = [&](const report::CheckSummary& summary, const Diagnostics& ordered) {
    const std::string with = asked.job       ? "with the job " + asked.job->path
                             : asked.machine ? "on the machine " + asked.machine->path
                                             : std::string();
    write_file(asked.options.page, report::check_page(summary, with, ordered, picture));
  };
  try {
    Checked checked = check_program(asked, found, [&](const nc::Interpretation& moves) {
      if (!asked.options.path.empty()) write_path(asked.options.path, text, moves, asked.machine);
      if (asked.options.page.empty()) return;
      picture = picture_of(moves, asked.machine, asked.job);
      before.program = nc::summarize(text, moves);
    });
    if (!asked.options.page.empty()) write_page(checked.summary, collected(in_order(found.all())));
    return checked;
  } catch (const InputError& e) {
    if (picture.machine) write_page(before, collected(in_order(e.diagnostics())));
    throw;
  }
}

std::optional<Box> box_of(const nc::Extents& e) {
  if (e.empty()) return std::nullopt;
  return Box{{e.min_mm.x(), e.min_mm.y(), e.min_mm.z()}, {e.max_mm.x(), e.max_mm.y(), e.max_mm.z()}};
}

ToolUse tool_of(const nc::ToolUse& t) {
  return {t.tool, t.line, t.calls, t.cutting_moves, t.cutting_length_mm, t.rapid_length_mm, box_of(t.cutting)};
}

CheckResult result_of(const CheckAsked& asked, const report::CheckSummary& summary, const Diagnostics& found) {
  const nc::Summary& s = summary.program;
  CheckResult out{.blocks = s.blocks,
                  .blocks_with_words = s.blocks_with_words,
                  .rapids = s.rapids,
                  .lines = s.lines,
                  .arcs = s.arcs,
                  .dwells = s.dwells,
                  .rotary_moves = s.rotary,
                  .cutting_length_mm = s.cutting_length_mm,
                  .rapid_length_mm = s.rapid_length_mm,
                  .dwell_s = s.dwell_s,
                  .cutting = box_of(s.cutting),
                  .rapid = box_of(s.rapid)};
  for (const nc::ToolUse& t : s.tools) out.tools.push_back(tool_of(t));
  const std::vector<std::string> assumed = asked.job       ? machine::assumptions(*asked.job)
                                           : asked.machine ? machine::assumptions(*asked.machine)
                                                           : std::vector<std::string>();
  out.diagnostics = found.all();
  if (summary.memory_bytes) out.memory_GB = *summary.memory_bytes / 1e9;
  out.json = machine::with_assumptions(report::check_json(summary, found), assumed);
  out.printed = machine::assumptions_text(assumed) + report::check_text(summary, found);
  return out;
}

/// `before`: of the machine or the job. Messages are in the order of the file.
CheckResult checked_in_order(const CheckAsked& asked, const Diagnostics& before, const api::Run& run,
                             Checked& checked) {
  Diagnostics found = before;
  try {
    found.append(asked.program.found);
    checked = check_and_draw(asked, found);
    const Diagnostics ordered = collected(in_order(found.all()));
    run.settle_first(ordered);
    return result_of(asked, checked.summary, ordered);
  } catch (const InputError& e) {
    throw InputError(in_order(e.diagnostics()));
  }
}

CheckResult check_one(const CheckAsked& asked, const Diagnostics& before, const RunOptions& options) {
  CheckResult result;
  api::Run run(options);
  run.execute([&] {
    Checked checked;
    result = checked_in_order(asked, before, run, checked);
  });
  return result;
}

/// The rigid sweep of a job's program, saved to `path`: what a check of the next program starts from.
void save_swept_stock(const machine::Job& job, const std::string& path) {
  Diagnostics ignored;
  api::PreparedJob prepared = api::prepare(job, {}, {}, ignored);
  simulate::sweep_path(prepared.setup.target.blank, job, prepared.setup.program.path, 0);
  prepared.setup.target.blank.save(path);
}

std::string sheet_of(const machine::Job& job, const std::vector<Checked>& programs, const Diagnostics& found) {
  report::SetupSheet sheet{job, {}, {}};
  for (const Checked& p : programs)
    sheet.programs.push_back(
        {*p.summary.text, p.moves, p.summary.program, feedmodel::cycle_time(p.moves, job.machine)});
  sheet.warnings = api::texts_of(found);
  return report::setup_sheet_html(sheet);
}

}  // namespace

CheckResult v0::check(const Program& program, const RunOptions& run) { return check(program, CheckOptions(), run); }

CheckResult v0::check(const Program& program, const Machine& machine, const RunOptions& run) {
  return check(program, machine, CheckOptions(), run);
}

CheckResult v0::check(const Program& program, const Job& job, const RunOptions& run) {
  return check_one({program.impl(), &job.impl().job.machine, &job.impl().job}, job.impl().found, run);
}

CheckResult v0::check(const Program& program, const CheckOptions& options, const RunOptions& run) {
  return check_one({.program = program.impl(), .options = options}, {}, run);
}

CheckResult v0::check(const Program& program, const Machine& machine, const CheckOptions& options,
                      const RunOptions& run) {
  return check_one({.program = program.impl(), .machine = &machine.impl().machine, .options = options},
                   machine.impl().found, run);
}

CheckedJob v0::check_job(const std::string& job_path, const ReadOptions& read, const CheckOptions& options,
                         const RunOptions& run_options) {
  CheckedJob out;
  api::Run run(run_options);
  run.execute([&] {
    JobOfPrograms all = read_job_of_programs(job_path);
    if (!options.program.empty()) all.programs = {options.program};
    const TemporaryFolder folder;
    std::vector<Program> texts;
    std::vector<Checked> programs(all.programs.size());
    std::string stock;
    Diagnostics found;
    for (std::size_t i = 0; i < all.programs.size(); ++i) {
      CheckOptions own = options;
      if (i > 0) {
        // The blank of the next program is what the undeflected tools of this one leave.
        const std::string left = fmt::format("{}/{}.vdb", folder.path(), i);
        save_swept_stock(all.of_program(i - 1, stock).impl().job, left);
        stock = left;
        own.page.clear();
        own.path.clear();
      }
      const Job one = all.of_program(i, stock);
      if (i == 0 && !options.meshes.empty()) write_meshes(one.impl().job, options.meshes);
      texts.push_back(read_program(all.programs[i], read));
      const CheckAsked asked{texts.back().impl(), &one.impl().job.machine, &one.impl().job, own};
      out.programs.push_back(checked_in_order(asked, one.impl().found, run, programs[i]));
      for (const Diagnostic& d : out.programs.back().diagnostics) found.add(d);
    }
    std::vector<std::string> json;
    for (std::size_t i = 0; i < out.programs.size(); ++i) {
      json.push_back(out.programs[i].json);
      out.printed += i > 0 ? "\n" + report::check_text(programs[i].summary, collected(out.programs[i].diagnostics))
                           : out.programs[i].printed;
    }
    out.json =
        json.size() == 1 ? json.front() : report::join_results(all.job.assumed(), all.programs, json, all.programs);
    if (options.sheet) out.sheet = sheet_of(all.job.impl().job, programs, found);
    out.diagnostics = found.all();
  });
  return out;
}

}  // namespace camber
