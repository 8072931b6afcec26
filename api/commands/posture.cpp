#include "api/commands/posture.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "api/commands/new_program.h"
#include "api/commands/rotary_program.h"
#include "base/json.h"
#include "base/units.h"
#include "checks/plausibility.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "repath/post.h"

namespace camber::api {
namespace {

constexpr std::array<std::string_view, 4> kModes{"chosen", "normal", "lead-tilt", "seed"};
constexpr std::array<std::string_view, 4> kWritten{"tip", "tilted", "dynamic", "joints"};

int tool_of(const PostureCommand& command) {
  if (command.tool) return *command.tool;
  if (command.job->tools.size() == 1) return command.job->tools.begin()->first;
  fail_on_file(command.job->path,
               "the job has several tools; --tool with the number of the finishing tool was expected", "no-tool");
}

/// As asked for, else as the control has it; a head that turns has no G254.
nc::OneDirection written_as(const PostureCommand& command) {
  const machine::Machine& machine = command.job->machine;
  if (!command.options.indexed) return nc::OneDirection::tip;
  if (command.written) return *command.written;
  const nc::OneDirection usual = nc::five_axis_words(kinematics::dialect_of(machine.control.kind)).one_direction;
  const auto axes = kinematics::rotary_options(machine);
  const bool table = std::ranges::all_of(axes, &nc::RotaryOption::on_table);
  return usual == nc::OneDirection::dynamic && !table ? nc::OneDirection::joints : usual;
}

/// The tip's program in joint coordinates; lines still map to the blocks of the given program.
void to_joints(const PostureCommand& command, PosturedProgram& program, Diagnostics& diagnostics) {
  const machine::Machine& machine = command.job->machine;
  const kinematics::MachineProgram tip =
      read_new_program(machine, command.output, program.postured.text, command.interpreter);
  repath::Posted posted =
      repath::post(tip.text(), tip.commanded(), machine, {.target = repath::PostTarget::joints}, diagnostics);
  diagnostics.throw_if_errors();
  for (std::uint32_t& block : posted.block_of_line) block = program.postured.block_of_line[block];
  program.postured.text = std::move(posted.text);
  program.postured.block_of_line = std::move(posted.block_of_line);
}

/// The moves of the new program.
nc::Interpretation moves_of(const PosturedProgram& program, const PostureCommand& command) {
  return read_new_program(command.job->machine, command.output, program.postured.text, command.interpreter)
      .moves_in_program();
}

/// Time on the machine, and what the checks of travel and of collisions with its bodies say.
void read_again(const PostureCommand& command, PosturedProgram& program, Diagnostics& diagnostics) {
  const nc::Interpretation moves = moves_of(program, command);
  program.time_s = feedmodel::cycle_time(moves, command.job->machine).all.time.total_s();
  machine::Job job = *command.job;
  job.tools.at(program.postured.tool).overhang_mm = program.postured.figures.overhang_mm;
  check_new_program(job.machine, &job, *command.text, moves, program.postured.block_of_line, diagnostics);
}

/// From that of the job down to the least that is tried; without a step, that of the job.
std::vector<double> overhangs_of(const machine::Job& job, int number, double step_mm) {
  const auto tool = job.tools.find(number);
  if (tool == job.tools.end() || step_mm <= 0) return {};
  const double given = tool->second.overhang_mm, least = posture::least_overhang_mm(tool->second);
  std::vector<double> out{given};
  for (int i = 1; given - i * step_mm >= least - 1e-9; ++i) out.push_back(given - i * step_mm);
  return out;
}

bool clear(const posture::Postured& row) { return !row.blocked_move && row.figures.unclear == 0; }

/// The first row of the least expected error.
std::size_t least_error(const std::vector<PosturedProgram>& rows) {
  const auto error_um = [](const PosturedProgram& row) { return row.postured.figures.error_um; };
  return static_cast<std::size_t>(std::ranges::min_element(rows, {}, error_um) - rows.begin());
}

Json figures_json(const PosturedProgram& program) {
  const posture::PostureFigures& f = program.postured.figures;
  return {{"overhang_mm", f.overhang_mm},
          {"points", f.points},
          {"contacts", f.contacts},
          {"unclear", f.unclear},
          {"rotary_motion_deg", f.rotary_motion_deg},
          {"mean_angle_deg", deg_from_rad(f.mean_angle_rad)},
          {"max_angle_deg", deg_from_rad(f.max_angle_rad)},
          {"compliance_um_per_N", f.compliance_um_per_N},
          {"lag_um", f.lag_um},
          {"error_um", f.error_um},
          {"time_s", program.time_s}};
}

}  // namespace

PosturedOverhangs posture_programs(const PostureCommand& command, Diagnostics& diagnostics) {
  kinematics::ReadingOptions options{.given = command.interpreter, .rotary = kinematics::RotaryWords::always};
  if (!options.given.inch) options.given.inch = command.job->inch;
  const nc::Interpretation moves = kinematics::read_moves(*command.text, command.job->machine, options, diagnostics);
  diagnostics.throw_if_errors();
  checks::check_job_values(*command.job, diagnostics);
  diagnostics.throw_if_errors();
  const int tool = tool_of(command);
  const nc::OneDirection written = written_as(command);
  std::vector<posture::Postured> made =
      posture::make_postures({.job = command.job,
                              .program = command.text,
                              .moves = &moves,
                              .tool = tool,
                              .overhangs_mm = overhangs_of(*command.job, tool, command.overhang_step_mm),
                              .step_mm = command.step_mm,
                              .options = command.options,
                              .written = written},
                             diagnostics);
  diagnostics.throw_if_errors();
  made.erase(std::find_if_not(made.begin() + 1, made.end(), clear), made.end());
  if (!clear(made[0])) made.resize(1);
  const double given_time_s = feedmodel::cycle_time(moves, command.job->machine).all.time.total_s();
  PosturedOverhangs overhangs;
  std::vector<PosturedProgram>& out = overhangs.rows;
  out.resize(made.size());
  std::vector<Diagnostics> found(made.size());
  tbb::parallel_for(std::size_t{0}, made.size(), [&](std::size_t row) {
    out[row].postured = std::move(made[row]);
    out[row].written = written;
    out[row].given_time_s = given_time_s;
    if (out[row].postured.unclear_move) out[row].unclear_line = moves.moves[*out[row].postured.unclear_move].block + 1;
    if (out[row].postured.blocked_move) {
      out[row].blocked_line = moves.moves[*out[row].postured.blocked_move].block + 1;
      return;
    }
    if (written == nc::OneDirection::joints) to_joints(command, out[row], found[row]);
    read_again(command, out[row], found[row]);
  });
  overhangs.chosen = command.least_error ? least_error(out) : out.size() - 1;
  for (const Diagnostic& d : found[overhangs.chosen].all()) diagnostics.add(d);
  diagnostics.throw_if_errors();
  return overhangs;
}

kinematics::PoseTrack posture_track(const PosturedProgram& program, const PostureCommand& command) {
  return kinematics::programmed_track(command.job->machine, moves_of(program, command));
}

std::string posture_text(const PosturedProgram& program, const PostureCommand& command) {
  const posture::PostureFigures& f = program.postured.figures;
  const posture::PostureFigures& before = program.postured.upright;
  std::string out = fmt::format("points    {}, {} of them on the part; {} nearer than {:g} mm\n", f.points, f.contacts,
                                f.unclear, command.options.clearance_mm);
  out += fmt::format("before    {:.1f} degrees from the normal; overhang {:g} mm, {:.3f} um for each N; {:.1f} s\n",
                     deg_from_rad(before.mean_angle_rad), before.overhang_mm, before.compliance_um_per_N,
                     program.given_time_s);
  out += fmt::format("tool      {:.1f} degrees from the normal, at most {:.1f}; rotary axes turn {:.0f} degrees\n",
                     deg_from_rad(f.mean_angle_rad), deg_from_rad(f.max_angle_rad), f.rotary_motion_deg);
  out +=
      fmt::format("overhang  {:g} mm: {:.3f} um normal to the part for each N\n", f.overhang_mm, f.compliance_um_per_N);
  if (command.options.indexed) {
    const Vec3& axis = program.postured.axes.front();
    out += fmt::format("direction I{:.4f} J{:.4f} K{:.4f} for all moves, written as {}\n", axis.x(), axis.y(), axis.z(),
                       kWritten[static_cast<std::size_t>(program.written)]);
  }
  if (before.lag_um > 0 || f.lag_um > 0)
    out += fmt::format("axes      late by {:.1f} um normal to the part, before {:.1f}\n", f.lag_um, before.lag_um);
  out +=
      fmt::format("error     about {:.1f} um, before {:.1f}; camber predict says where\n", f.error_um, before.error_um);
  out += fmt::format("time      {:.1f} s\n", program.time_s);
  return out;
}

std::string overhang_text(const PosturedOverhangs& overhangs) {
  std::string out = fmt::format("{:>12} {:>10} {:>10} {:>10} {:>12} {:>8}\n", "overhang mm", "um/N", "error um",
                                "angle deg", "rotary deg", "time s");
  for (const PosturedProgram& row : overhangs.rows) {
    const posture::PostureFigures& f = row.postured.figures;
    out +=
        fmt::format("{:>12.1f} {:>10.3f} {:>10.1f} {:>10.1f} {:>12.0f} {:>8.1f}\n", f.overhang_mm,
                    f.compliance_um_per_N, f.error_um, deg_from_rad(f.mean_angle_rad), f.rotary_motion_deg, row.time_s);
  }
  const posture::PostureFigures& least = overhangs.rows[least_error(overhangs.rows)].postured.figures;
  const posture::PostureFigures &shortest = overhangs.rows.back().postured.figures,
                                &chosen = overhangs.program().postured.figures;
  if (least.overhang_mm > chosen.overhang_mm)
    out += fmt::format("the least error is that of {:g} mm; --least-error writes its program\n", least.overhang_mm);
  else if (chosen.overhang_mm > shortest.overhang_mm)
    out += fmt::format("the program is that of {:g} mm, which has the least error; {:g} mm are clear, too\n",
                       chosen.overhang_mm, shortest.overhang_mm);
  return out;
}

std::string posture_json(const PosturedOverhangs& overhangs, const PostureCommand& command) {
  const PosturedProgram& program = overhangs.program();
  Json report = figures_json(program);
  report["mode"] = kModes[static_cast<std::size_t>(command.options.mode)];
  if (command.options.indexed) {
    report["mode"] = "indexed";
    report["written"] = kWritten[static_cast<std::size_t>(program.written)];
    if (!program.postured.axes.empty()) {
      const Vec3& axis = program.postured.axes.front();
      report["direction"] = {axis.x(), axis.y(), axis.z()};
    }
  }
  report["clearance_mm"] = command.options.clearance_mm;
  const posture::PostureFigures& before = program.postured.upright;
  report["before"] = {{"overhang_mm", before.overhang_mm},
                      {"mean_angle_deg", deg_from_rad(before.mean_angle_rad)},
                      {"max_angle_deg", deg_from_rad(before.max_angle_rad)},
                      {"compliance_um_per_N", before.compliance_um_per_N},
                      {"lag_um", before.lag_um},
                      {"error_um", before.error_um},
                      {"time_s", program.given_time_s}};
  if (program.blocked_line > 0) report["blocked_line"] = program.blocked_line;
  if (program.unclear_line > 0) report["unclear_line"] = program.unclear_line;
  if (command.overhang_step_mm > 0 && clear(program.postured))
    for (const PosturedProgram& row : overhangs.rows) report["overhangs"].push_back(figures_json(row));
  return report.dump(2) + "\n";
}

}  // namespace camber::api
