#include "simulate/rotary_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "feedmodel/control_options.h"
#include "feedmodel/joint_map.h"
#include "kinematics/machine_moves.h"
#include "kinematics/program_joints.h"
#include "kinematics/rotary_options.h"
#include "machine/machine_presets.h"
#include "simulate/moves_of_axes.h"

namespace camber::simulate {
namespace {

bool turns_frame(double g) {
  constexpr std::array kCodes{43.4, 43.5, 234.0, 68.2, 68.3, 68.4, 53.1, 53.6, 254.0};
  constexpr double kRounding = 1e-6;
  return std::ranges::any_of(kCodes, [&](double code) { return std::abs(g - code) < kRounding; });
}

class Reading {
 public:
  Reading(const nc::Program& text, const nc::Interpretation& moves, Diagnostics& diagnostics)
      : text_(text), moves_(moves), diagnostics_(diagnostics) {}

  void check_known() {
    for (const nc::Move& move : moves_.moves) {
      if (move.kind == nc::MoveKind::dwell || move.reference) continue;
      if (!moves_.machine_origin_mm)
        return error(move, "work-offset",
                     "where the tool is on the part depends on the work offset, which is not known; G10 L2 in the "
                     "program or [compensation] work_offset_mm (of G54) in the job was expected");
      const nc::ModalState& state = moves_.state_of(move);
      if (!state.tool_length_mm)
        return error(move, "tool-length",
                     fmt::format("where the tool is on the part depends on the length of tool T{}, which is not known; "
                                 "its value (G10 L1) in the program was expected",
                                 state.tool));
    }
  }

  void refuse_arcs(const kinematics::PartPath& path) {
    if (path.bent_arcs().empty()) return;
    const std::size_t more = path.bent_arcs().size() - 1;
    error(moves_.moves[path.bent_arcs().front()], "not-read",
          fmt::format("this arc{} is none on the part, as rotary axes turn it; lines, or tool-centre-point control, "
                      "were expected",
                      more > 0 ? fmt::format(", like {} more,", more) : std::string()));
  }

 private:
  void error(const nc::Move& move, const char* check, std::string message) {
    diagnostics_.add(
        text_.source.diagnostic(Severity::error, text_.blocks[move.block].offset, std::move(message), check));
  }

  const nc::Program& text_;
  const nc::Interpretation& moves_;
  Diagnostics& diagnostics_;
};

}  // namespace

namespace {

/// On a machine of a class: the part's zero lies at the machine's, and a tool is as long as it and its holder stand
/// out.
void assume_clamping(const machine::Job& job, nc::InterpreterOptions& options) {
  constexpr int kG54 = 54;
  options.work_offsets_mm[kG54] = Vec3::Zero();
  for (const auto& [number, tool] : job.tools) {
    double length_mm = tool.overhang_mm;
    for (const machine::HolderPart& part : tool.holder) length_mm += part.length_mm;
    options.tool_offsets[number].length_mm = length_mm;
  }
}

}  // namespace

nc::InterpreterOptions interpreter_options(const machine::Job& job, bool rotary_axes) {
  constexpr int kG54 = 54;
  nc::InterpreterOptions options = feedmodel::interpreter_options(job.machine, job.inch);
  if (!rotary_axes) return options;
  options.rotary_axes = kinematics::rotary_options(job.machine);
  if (machine::is_preset(job.machine.path)) assume_clamping(job, options);
  if (job.compensation.work_offset_mm) options.work_offsets_mm[kG54] = *job.compensation.work_offset_mm;
  return options;
}

bool names_rotary_axes(const machine::Machine& machine, const nc::Program& text) {
  if (!machine.kinematics.given()) return false;
  if (text.language != nc::LanguageId::iso) return true;  // planes and directions have words of their own there
  const int tip_control_m = feedmodel::dialect_of(machine.control.kind).tip_control_on_m;
  return std::ranges::any_of(text.words, [&](const nc::Word& word) {
    // NaN, an expression, is not 0.
    return (word.letter >= 'A' && word.letter <= 'C' && word.value != 0) ||
           (word.letter == 'G' && turns_frame(word.value)) ||
           (word.letter == 'M' && tip_control_m != 0 && word.value == tip_control_m);
  });
}

std::shared_ptr<const RotaryMotion> read_rotary_motion(const machine::Machine& machine, const nc::Program& text,
                                                       const nc::Interpretation& moves, Diagnostics& diagnostics) {
  Reading reading(text, moves, diagnostics);
  if (!feedmodel::has_rotary_motion(moves, machine)) return nullptr;
  reading.check_known();
  diagnostics.throw_if_errors();
  nc::Interpretation placed = moves;
  kinematics::place_lines(placed, machine);
  auto out = std::make_shared<const RotaryMotion>(machine, std::move(placed));
  reading.refuse_arcs(out->path());
  diagnostics.throw_if_errors();
  return out;
}

void refuse_rotary_motion(const RotaryMotion* rotary, const nc::Program& text, const std::string& what,
                          Diagnostics& diagnostics) {
  if (!rotary) return;
  const nc::Move& move = rotary->text().moves[rotary->text().rotary.front().move];
  diagnostics.add(text.source.diagnostic(
      Severity::error, text.blocks[move.block].offset,
      fmt::format("{}, but rotary axes turn here; a program of X, Y and Z alone was expected", what), "rotary-motion"));
}

nc::Interpretation moves_of_axes(const RotaryMotion& rotary, const machine::Machine& machine) {
  nc::Interpretation out = rotary.text();
  kinematics::place_moves(out, machine);
  return out;
}

feedmodel::FeedSummary predict_on_part(const RotaryMotion& rotary, const machine::Machine& machine,
                                       const PartSink& sink) {
  feedmodel::PartSamples on_part;
  return feedmodel::predict_joints(
      moves_of_axes(rotary, machine), machine,
      [&](std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints) {
        on_part.take(samples, joints);
        sink(on_part);
      });
}

}  // namespace camber::simulate
