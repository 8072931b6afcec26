#include "kinematics/feed_meaning.h"

#include <cmath>

#include "base/units.h"
#include "kinematics/machine_program.h"
#include "kinematics/program_joints.h"

namespace camber::kinematics {
namespace {

constexpr double kNoLengthMm = 1e-9;

}  // namespace

FeedMeaning feed_meaning(const nc::Interpretation& program, const nc::Move& move, const Vec3& turn_rad,
                         const machine::Control& control) {
  const nc::ModalState& state = program.state_of(move);
  if (state.feed_mode == nc::FeedMode::inverse_time) return FeedMeaning::inverse;
  const bool turns = !turn_rad.isZero(0);
  if (turns && nc::length_mm(program, move) < kNoLengthMm) return FeedMeaning::degrees;
  if (state.tip_control != nc::TipControl::off) return FeedMeaning::tip;
  return turns && control.rotary_feed == machine::RotaryFeed::joints ? FeedMeaning::joints : FeedMeaning::linear;
}

double feed_along_path(const nc::Interpretation& program, const nc::Move& move, const Vec3& turn_rad,
                       double inverse_time_s, const machine::Control& control) {
  const double linear_mm = nc::length_mm(program, move), turn_deg = deg_from_rad(turn_rad.norm());
  const double length = linear_mm < kNoLengthMm ? turn_deg : linear_mm;
  if (inverse_time_s > 0) return length / inverse_time_s;
  const double unit_mm = program.state_of(move).inch ? kMmPerInch : 1;
  switch (feed_meaning(program, move, turn_rad, control)) {
    case FeedMeaning::degrees:  // F is in degrees, whichever unit lengths have
      return move.feed_mm_per_s / unit_mm;
    case FeedMeaning::joints:  // a degree counts as a millimetre or as an inch, as lengths do
      return move.feed_mm_per_s * linear_mm / std::hypot(linear_mm, turn_deg * unit_mm);
    case FeedMeaning::linear:
    case FeedMeaning::tip:
    case FeedMeaning::inverse:
      break;
  }
  return move.feed_mm_per_s;
}

std::optional<double> programmed_time_s(const nc::Interpretation& program, const nc::Move& move, const Vec3& turn_rad,
                                        double inverse_time_s, const machine::Control& control) {
  const double linear_mm = nc::length_mm(program, move);
  const double length = linear_mm < kNoLengthMm ? deg_from_rad(turn_rad.norm()) : linear_mm;
  const double speed = feed_along_path(program, move, turn_rad, inverse_time_s, control);
  if (length <= 0 || speed <= 0) return std::nullopt;
  return length / speed;
}

std::vector<double> tip_feeds_mm_per_s(const MachineProgram& program, const machine::Machine& machine) {
  std::vector<double> out;
  for (const nc::Move& move : program.moves_in_part().moves) out.push_back(move.feed_mm_per_s);
  if (!program.turns()) return out;
  ProgramJoints joints(machine, program.commanded());
  while (!joints.done()) {
    const MoveJoints& now = joints.next();
    if (!now.turns()) continue;
    const auto m = static_cast<std::uint32_t>(joints.index());
    const auto time_s = programmed_time_s(program.commanded(), program.commanded().moves[m],
                                          now.end_rad - now.start_rad, now.g93_time_s, machine.control);
    out[m] = time_s ? program.part_path()->length_mm(m) / *time_s : 0;
  }
  return out;
}

std::vector<FeedMeaningUse> feed_meanings(const nc::Interpretation& program, const machine::Machine& machine) {
  if (!machine.kinematics.given() || program.rotary.empty()) return {};
  std::array<FeedMeaningUse, kFeedMeaningTexts.size()> uses;
  ProgramJoints joints(machine, program);
  while (!joints.done()) {
    const MoveJoints& now = joints.next();
    const nc::Move& move = program.moves[joints.index()];
    if (move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc) continue;
    const FeedMeaning meaning = feed_meaning(program, move, now.end_rad - now.start_rad, machine.control);
    FeedMeaningUse& use = uses[static_cast<std::size_t>(meaning)];
    use.meaning = meaning;
    if (use.moves++ == 0) use.first_line = move.block + 1;
  }
  std::vector<FeedMeaningUse> out;
  for (const FeedMeaningUse& use : uses)
    if (use.moves > 0) out.push_back(use);
  return out;
}

}  // namespace camber::kinematics
