// The namespace posture comes before the function of that name: clang takes it in no other order.
#include "posture/posture_program.h"

#include "camber/posture.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include <tbb/parallel_for.h>

#include "api/job.h"
#include "api/new_program.h"
#include "api/program.h"
#include "api/rotary_program.h"
#include "api/run.h"
#include "base/units.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "plausibility/plausibility.h"
#include "repath/post/post_processing.h"
#include "report/posture_summary.h"

namespace camber {
namespace {

/// The arguments of posture(), their words read.
struct PostureCommand {
  const nc::Program* text = nullptr;
  std::string output;  ///< name of the new program in messages
  const machine::Job* job = nullptr;
  nc::InterpreterOptions interpreter;
  std::optional<int> tool{};
  double step_mm = 1;
  posture::PostureOptions options;
  std::optional<nc::OneDirection> written{};
  double overhang_step_mm = 0;
  bool least_error = false;
};

int tool_of(const PostureCommand& command) {
  if (command.tool) return *command.tool;
  if (command.job->tools.size() == 1) return command.job->tools.begin()->first;
  fail_on_file(command.job->path,
               "the job has several tools; --tool with the number of the finishing tool was expected", "no-tool");
}

/// The words asked for, else those of the control; a head that turns has no G254.
nc::OneDirection written_as(const PostureCommand& command) {
  const machine::Machine& machine = command.job->machine;
  if (!command.options.indexed) return nc::OneDirection::tip;
  if (command.written) return *command.written;
  const nc::Dialect& dialect = nc::dialect_of_text(*command.text, kinematics::dialect_of(machine.control.kind));
  const nc::OneDirection usual = nc::five_axis_words(dialect).one_direction;
  const auto axes = kinematics::rotary_options(machine);
  const bool table = std::ranges::all_of(axes, &nc::RotaryOption::on_table);
  return usual == nc::OneDirection::dynamic && !table ? nc::OneDirection::joints : usual;
}

/// The tip's program in joint coordinates; lines still map to the blocks of the given program.
void to_joints(const PostureCommand& command, report::PosturedProgram& program, Diagnostics& diagnostics) {
  const machine::Machine& machine = command.job->machine;
  const kinematics::MachineProgram tip =
      api::read_new_program(machine, command.output, program.postured.text, command.interpreter);
  repath::Posted posted =
      repath::post(tip.text(), tip.commanded(), machine, {.target = repath::PostTarget::joints}, diagnostics);
  diagnostics.throw_if_errors();
  for (std::uint32_t& block : posted.block_of_line) block = program.postured.block_of_line[block];
  program.postured.text = std::move(posted.text);
  program.postured.block_of_line = std::move(posted.block_of_line);
}

/// The moves of the new program.
nc::Interpretation new_moves(const report::PosturedProgram& program, const PostureCommand& command) {
  return api::read_new_program(command.job->machine, command.output, program.postured.text, command.interpreter)
      .moves_in_program();
}

/// Time on the machine, and what the checks of travel and of collisions with its bodies say.
void read_again(const PostureCommand& command, report::PosturedProgram& program, Diagnostics& diagnostics) {
  const nc::Interpretation moves = new_moves(program, command);
  program.time_s = feedmodel::cycle_time(moves, command.job->machine).all.time.total_s();
  machine::Job job = *command.job;
  job.tools.at(program.postured.tool).overhang_mm = program.postured.figures.overhang_mm;
  api::check_new_program(job.machine, &job, *command.text, moves, program.postured.block_of_line, diagnostics);
}

/// Lists the overhangs to try, from the job's down to the least; empty without a step.
std::vector<double> overhangs_of(const machine::Job& job, int number, double step_mm) {
  const auto tool = job.tools.find(number);
  if (tool == job.tools.end() || step_mm <= 0) return {};
  const double given = tool->second.overhang_mm, least = posture::least_overhang_mm(tool->second);
  std::vector<double> out{given};
  for (int i = 1; given - i * step_mm >= least - 1e-9; ++i) out.push_back(given - i * step_mm);
  return out;
}

/// Throws InputError: what make_postures() says, and the checks of travel and of collisions with the machine's bodies
/// of the chosen program, at the given blocks.
report::PosturedOverhangs posture_programs(const PostureCommand& command, Diagnostics& diagnostics) {
  kinematics::ReadingOptions options{.given = command.interpreter, .rotary = kinematics::RotaryWords::always};
  if (!options.given.inch) options.given.inch = command.job->inch;
  const nc::Interpretation moves = kinematics::read_moves(*command.text, command.job->machine, options, diagnostics);
  diagnostics.throw_if_errors();
  plausibility::check_job_values(*command.job, diagnostics);
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
  made.erase(std::find_if_not(made.begin() + 1, made.end(), report::clear), made.end());
  if (!report::clear(made[0])) made.resize(1);
  const double given_time_s = feedmodel::cycle_time(moves, command.job->machine).all.time.total_s();
  report::PosturedOverhangs overhangs;
  std::vector<report::PosturedProgram>& out = overhangs.rows;
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
  overhangs.chosen = command.least_error ? report::least_error(out) : out.size() - 1;
  for (const Diagnostic& d : found[overhangs.chosen].all()) diagnostics.add(d);
  diagnostics.throw_if_errors();
  return overhangs;
}

constexpr std::array<std::string_view, 4> kPostureModes{"chosen", "normal", "lead-tilt", "seed"};
constexpr std::array<std::string_view, 4> kWrittenAs{"tip", "tilted", "dynamic", "joints"};

template <typename Enum>
Enum word_of(const std::array<std::string_view, 4>& words, const std::string& word, const char* what) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == word) return static_cast<Enum>(i);
  std::string all;
  for (const std::string_view w : words) all += (all.empty() ? "" : ", ") + std::string(w);
  throw std::invalid_argument(std::string(what) + ": " + word + "; one of " + all + " was expected");
}

posture::PostureOptions rules_of(const PostureOptions& options) {
  posture::PostureOptions out;
  out.mode = word_of<posture::Mode>(kPostureModes, options.mode, "mode");
  out.indexed = options.indexed;
  out.clearance_mm = options.clearance_mm;
  out.stock = options.stock;
  out.lead_rad = rad_from_deg(options.lead_deg);
  out.tilt_rad = rad_from_deg(options.tilt_deg);
  out.max_tilt_rad = rad_from_deg(options.max_tilt_deg);
  out.least_angle_rad = rad_from_deg(options.least_angle_deg);
  return out;
}

PostureFigures figures_of(const report::PosturedProgram& program) {
  const posture::PostureFigures& f = program.postured.figures;
  return {.overhang_mm = f.overhang_mm,
          .points = f.points,
          .contacts = f.contacts,
          .unclear = f.unclear,
          .rotary_motion_deg = f.rotary_motion_deg,
          .mean_angle_deg = deg_from_rad(f.mean_angle_rad),
          .max_angle_deg = deg_from_rad(f.max_angle_rad),
          .compliance_um_per_N = f.compliance_um_per_N,
          .lag_um = f.lag_um,
          .error_um = f.error_um,
          .time_s = program.time_s};
}

}  // namespace

PostureResult v0::posture(const Program& program, const Job& job, const PostureOptions& options,
                          const RunOptions& run_options) {
  PostureResult result;
  PostureCommand command{.text = &program.impl().text,
                         .output = options.output.empty() ? program.path() : options.output,
                         .job = &job.impl().job,
                         .interpreter = program.impl().options,
                         .tool = options.tool,
                         .step_mm = options.step_mm,
                         .options = rules_of(options),
                         .overhang_step_mm = options.overhang_step_mm,
                         .least_error = options.least_error};
  if (!options.write_as.empty()) command.written = word_of<nc::OneDirection>(kWrittenAs, options.write_as, "write_as");
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = job.impl().found;
    found.append(program.impl().found);
    const report::PosturedOverhangs overhangs = posture_programs(command, found);
    run.settle_first(found);
    const report::PosturedProgram& chosen = overhangs.program();
    const report::PostureAsked asked{program.path(), command.job, command.options, options.overhang_step_mm};
    result.success = report::clear(chosen.postured);
    result.blocked_line = chosen.blocked_line;
    result.unclear_line = chosen.unclear_line;
    result.text = chosen.postured.text;
    result.figures = figures_of(chosen);
    if (options.overhang_step_mm > 0 && result.success)
      for (const report::PosturedProgram& row : overhangs.rows) result.overhangs.push_back(figures_of(row));
    result.diagnostics = found.all();
    result.json = report::posture_json(overhangs, asked);
    if (chosen.blocked_line > 0) return;
    result.printed = report::posture_text(overhangs, asked);
    if (options.page)
      result.page = report::posture_page(
          overhangs, asked, kinematics::programmed_track(command.job->machine, new_moves(chosen, command)).samples,
          api::texts_of(found));
  });
  return result;
}

}  // namespace camber
