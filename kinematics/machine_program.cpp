#include "kinematics/machine_program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "kinematics/control_options.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/offset_check.h"
#include "kinematics/program_joints.h"
#include "machine/machine_presets.h"
#include "nc/language.h"
#include "nc/tool_names.h"

namespace camber::kinematics {
namespace {

constexpr int kG54 = 54;

bool turns_frame(double g) {
  constexpr std::array kCodes{43.4, 43.5, 234.0, 68.2, 68.3, 68.4, 53.1, 53.6, 254.0};
  constexpr double kRounding = 1e-6;
  return std::ranges::any_of(kCodes, [&](double code) { return std::abs(g - code) < kRounding; });
}

bool names_rotary_axes(const machine::Machine& machine, const nc::Program& text) {
  if (!machine.kinematics.given()) return false;
  if (text.language != nc::LanguageId::iso) return true;  // planes and directions have words of their own there
  const int tip_control_m = dialect_of(machine.control.kind).tip_control_on_m;
  return std::ranges::any_of(text.words, [&](const nc::Word& word) {
    // NaN, an expression, is not 0.
    return (word.letter >= 'A' && word.letter <= 'C' && word.value != 0) ||
           (word.letter == 'G' && turns_frame(word.value)) ||
           (word.letter == 'M' && tip_control_m != 0 && word.value == tip_control_m);
  });
}

bool stays(const nc::RotaryTarget& target) {
  const Vec3 upright = target.is_direction ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::Zero());
  return target.time_s == 0 && target.end == upright;
}

/// Every rotary word is 0 and nothing but tool-centre-point control is asked for: X, Y and Z are those of a program of
/// three axes, and so is what is cut. Moves to machine coordinates count as rotary motion.
bool never_turns(const machine::Machine& machine, const nc::Interpretation& moves) {
  const bool on_axes = std::ranges::all_of(
      moves.states, [](const nc::ModalState& state) { return state.work_frame == nc::WorkFrame::machine; });
  return on_axes && moves.machine_targets.empty() && machine.kinematics.tool_axis.normalized() == Vec3::UnitZ() &&
         std::ranges::all_of(moves.rotary, stays);
}

/// Gives the lines the starts and ends that the machine gives them, where it is known that they differ from those
/// programmed (ProgramJoints::start_mm). Frames stay as they are.
void place_lines(nc::Interpretation& program, const machine::Machine& machine) {
  constexpr double kSame_mm = 1e-6;
  struct Placed {
    std::size_t move;
    Vec3 start_mm, end_mm;
  };
  std::vector<Placed> placed;
  for (ProgramJoints joints(machine, program); !joints.done();) {
    joints.next();
    const nc::Move& move = program.moves[joints.index()];
    if (move.kind == nc::MoveKind::dwell || move.arc != nc::Move::kNoArc || move.reference) continue;
    const Vec3 start = joints.start_mm().value_or(move.start_mm), end = joints.end_mm().value_or(move.end_mm);
    if ((start - move.start_mm).norm() > kSame_mm || (end - move.end_mm).norm() > kSame_mm)
      placed.push_back({joints.index(), start, end});
  }
  for (const Placed& p : placed) program.moves[p.move].start_mm = p.start_mm, program.moves[p.move].end_mm = p.end_mm;
}

/// reading_of() has placed the part: where G53, SUPA and M91 lead is not known.
bool zero_is_guessed(const machine::Machine& machine, const nc::InterpreterOptions& given) {
  const auto offset = given.work_offsets_mm.find(kG54);
  return machine::is_preset(machine.path) && offset != given.work_offsets_mm.end() && offset->second == Vec3::Zero();
}

void say_at(const MachineProgram& program, const nc::Move& move, const char* check, std::string message,
            Diagnostics& diagnostics) {
  const nc::Program& text = program.text();
  diagnostics.add(text.source.diagnostic(Severity::error, text.blocks[move.block].offset, std::move(message), check));
}

}  // namespace

ReadingOptions reading_of(const machine::Job& job) {
  ReadingOptions out;
  out.given.inch = job.inch;
  for (const auto& [number, tool] : job.tools)
    nc::set_cutter_radius(out.given.tool_offsets, number, tool.diameter_mm / 2);
  if (machine::is_preset(job.machine.path)) {
    // On a machine of a class: the part's zero lies at the machine's, and a tool is as long as it and its holder stand
    // out.
    out.work_offsets_mm[kG54] = Vec3::Zero();
    for (const auto& [number, tool] : job.tools) {
      double length_mm = tool.overhang_mm;
      for (const machine::HolderPart& part : tool.holder) length_mm += part.length_mm;
      out.tool_offsets[number].length_mm = length_mm;
    }
  }
  if (job.compensation.work_offset_mm) out.work_offsets_mm[kG54] = *job.compensation.work_offset_mm;
  return out;
}

/// The views of a program in which rotary axes turn: its moves by program, axes and part.
struct MachineProgram::Views {
  machine::Machine machine;
  std::once_flag program_once, part_once, axes_once;
  nc::Interpretation in_program, in_part, of_axes;
  std::optional<PartPath> path;  ///< of in_program

  explicit Views(const machine::Machine& on) : machine(on) {}
};

MachineProgram::MachineProgram(nc::Program text, nc::Interpretation commanded)
    : text_(std::make_shared<const nc::Program>(std::move(text))),
      commanded_(std::make_shared<const nc::Interpretation>(std::move(commanded))) {}

MachineProgram::MachineProgram(nc::Program text, nc::Interpretation commanded, const machine::Machine& machine)
    : MachineProgram(std::move(text), std::move(commanded)) {
  if (has_rotary_motion(*commanded_, machine)) views_ = std::make_shared<Views>(machine);
}

void MachineProgram::give_up_text() {
  text_ = std::make_shared<const nc::Program>(
      nc::Program{.source = SourceText(text_->source.name(), {}), .blocks = {}, .words = {}, .macro = {}, .parts = {}});
}

const nc::Interpretation& MachineProgram::placed() const {
  std::call_once(views_->program_once, [&] {
    views_->in_program = *commanded_;
    place_lines(views_->in_program, views_->machine);
  });
  return views_->in_program;
}

const PartPath* MachineProgram::part_path() const {
  if (!views_) return nullptr;
  std::call_once(views_->part_once, [&] {
    views_->path.emplace(views_->machine, moves_in_program());
    views_->in_part = views_->path->moves_in_part();
  });
  return &*views_->path;
}

const nc::Interpretation& MachineProgram::on_part() const {
  part_path();
  return views_->in_part;
}

const nc::Interpretation& MachineProgram::moves_of_axes() const {
  if (!views_) return *commanded_;
  std::call_once(views_->axes_once, [&] {
    views_->of_axes = *commanded_;
    place_moves(views_->of_axes, views_->machine);
  });
  return views_->of_axes;
}

ToolPose MachineProgram::pose_at(std::uint32_t move, double u) const {
  const PartPath* path = part_path();
  return path ? path->pose_at(move, u) : nc::pose_at(*commanded_, commanded_->moves[move], u);
}

nc::Interpretation read_moves(const nc::Program& text, const machine::Machine& machine, const ReadingOptions& options,
                              Diagnostics& diagnostics) {
  nc::InterpreterOptions given = interpreter_options(machine, options.given);
  const bool where_named = options.rotary == RotaryWords::where_named;
  if (options.rotary == RotaryWords::always || (where_named && names_rotary_axes(machine, text))) {
    given.rotary_axes = rotary_options(machine);
    for (const auto& [number, offset_mm] : options.work_offsets_mm) given.work_offsets_mm[number] = offset_mm;
    for (const auto& [number, offset] : options.tool_offsets) given.tool_offsets[number] = offset;
  }
  nc::Interpretation moves = nc::interpret(text, given, diagnostics);
  if (zero_is_guessed(machine, given))
    for (nc::MachineTarget& target : moves.machine_targets)
      target.end_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  if (where_named && never_turns(machine, moves)) moves.rotary.clear();
  return moves;
}

MachineProgram open_program(SourceText source, const machine::Machine& machine, const ReadingOptions& options,
                            Diagnostics& diagnostics) {
  const auto language = options.language ? options.language : nc::language_asked_for(options.given);
  nc::Program text = nc::read_program(std::move(source), language, diagnostics);
  nc::Interpretation moves = read_moves(text, machine, options, diagnostics);
  return {std::move(text), std::move(moves), machine};
}

void check_on_part(const MachineProgram& program, Diagnostics& diagnostics) {
  if (!program.turns()) return;
  check_offsets(program.text(), program.commanded(), Asked::part, diagnostics);
  diagnostics.throw_if_errors();
  const std::vector<std::uint32_t>& bent = program.part_path()->bent_arcs();
  if (bent.empty()) return;
  say_at(
      program, program.commanded().moves[bent.front()], "not-read",
      fmt::format("this arc{} is none on the part, as rotary axes turn it; lines, or tool-centre-point control, were "
                  "expected",
                  bent.size() > 1 ? fmt::format(", like {} more,", bent.size() - 1) : std::string()),
      diagnostics);
  diagnostics.throw_if_errors();
}

void refuse_rotary_motion(const MachineProgram& program, const std::string& what, Diagnostics& diagnostics) {
  if (!program.turns()) return;
  const nc::Interpretation& moves = program.commanded();
  say_at(program, moves.moves[moves.rotary.front().move], "rotary-motion",
         fmt::format("{}, but rotary axes turn here; a program of X, Y and Z alone was expected", what), diagnostics);
}

std::vector<bool> turning_moves(const MachineProgram& program) {
  std::vector<bool> out;
  if (const PartPath* path = program.part_path())
    for (std::uint32_t m = 0; m < program.moves_in_part().moves.size(); ++m) out.push_back(path->turn_rad(m) > 0);
  return out;
}

std::vector<nc::MoveEdit> edits_of_text(const MachineProgram& program, std::vector<nc::MoveEdit> edits) {
  const PartPath* path = program.part_path();
  if (!path) return edits;
  for (nc::MoveEdit& edit : edits) {
    const auto turn_back = [&](std::optional<Vec3>& place) {
      if (place) place = path->text_mm(edit.move, *place);
    };
    assert(edit.via.empty() || path->turn_rad(edit.move) == 0);
    for (nc::ViaPoint& via : edit.via) {
      via.point_mm = path->text_mm(edit.move, via.point_mm).value_or(via.point_mm);
      turn_back(via.center_mm);
    }
    turn_back(edit.end_mm);
    turn_back(edit.center_mm);
  }
  return edits;
}

}  // namespace camber::kinematics
