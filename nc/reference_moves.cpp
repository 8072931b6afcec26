#include "nc/reference_moves.h"

#include <limits>

#include <fmt/format.h>

namespace camber::nc {

/// G28.1, G30.1: where the tool stands is the reference point from now on.
void ReferenceMoves::store_reference(const Code& code) {
  if (!at_.dialect().stores_reference_points) {
    at_.error(
        code.word->offset, "unknown-g",
        fmt::format("{} is not a G code of a {} program that Camber knows", at_.code_text(code), at_.dialect().title));
    at_.request.skip_motion = true;
    return;
  }
  stored_reference_[code.tenths == 281 ? 0 : 1] = StoredReference{place_.position_mm, rotary_.angles_rad()};
}

void ReferenceMoves::go_to_reference() {
  modal_.check_unit();
  at_.words.use("P");
  std::array<bool, 3> goes{};
  for (std::size_t axis = 0; axis < 3; ++axis) goes[axis] = at_.words.has(kAxisLetters[axis]);
  const bool none = !goes[0] && !goes[1] && !goes[2] && !rotary_.target();
  const std::uint8_t turns = rotary_.target() ? rotary_.target()->given : 0;
  const Vec3 via = mover_.target();
  const Vec3 old_via = reference_via_mm_.value_or(place_.position_mm);
  reference_via_mm_ = via;
  for (int axis = 0; axis < 3; ++axis)
    if (!goes[static_cast<std::size_t>(axis)]) (*reference_via_mm_)[axis] = old_via[axis];
  std::size_t point = 0;
  if (at_.words.has('P') && at_.request.reference_word->value == 30) {
    const double p = at_.words.value('P');
    if (p != 2 && p != 3 && p != 4) {
      at_.error(at_.words.offset_of('P'), "reference",
                fmt::format("G30 P{} is not a reference point; P2, P3 or P4 was expected", p));
      return;
    }
    point = static_cast<std::size_t>(p) - 1;
  } else if (at_.request.reference_word->value == 30) {
    point = 1;
  }
  if (via != place_.position_mm || (rotary_.target() && rotary_.target()->end != rotary_.angles_rad())) {
    mover_.add_move(MoveKind::rapid, via);
    mover_.settle_axes();
  }
  const auto stored = point < stored_reference_.size() ? stored_reference_[point] : std::nullopt;
  rotary_.turn_home(none, turns, stored ? stored->rotary_rad : Vec3(Vec3::Zero()));
  Vec3 home = place_.position_mm, machine_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::uint8_t given = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!none && !goes[axis]) continue;
    if (stored) {
      home[static_cast<Eigen::Index>(axis)] = stored->place_mm[static_cast<Eigen::Index>(axis)];
      continue;
    }
    home[static_cast<Eigen::Index>(axis)] = 0;
    place_.axis[axis] = AxisPlace::reference;
    given = static_cast<std::uint8_t>(given | 1U << axis);
    if (const auto& at = at_.options.reference_points_mm[point]) {
      machine_mm[static_cast<Eigen::Index>(axis)] = (*at)[static_cast<Eigen::Index>(axis)];
      frames_.settle_machine_axis(axis, (*at)[static_cast<Eigen::Index>(axis)], home);
    }
  }
  rotary_.add_machine_target(machine_mm, given);
  Move& move = mover_.add_move(MoveKind::rapid, home);
  if (stored) return;
  move.reference_point = static_cast<std::uint8_t>(point & 3U);
  for (unsigned axis = 0; axis < 3; ++axis)
    if (none || goes[axis]) move.reference_axes = static_cast<std::uint8_t>((move.reference_axes | 1U << axis) & 7U);
}

/// G29: through the intermediate point of the last G28 or G30 to the point of the block.
void ReferenceMoves::return_from_reference() {
  modal_.check_unit();
  if (!reference_via_mm_) {
    at_.error(at_.words.offset(), "reference", "G29 without a G28 or G30 before; its intermediate point was expected");
    at_.words.use("XYZ");
    return;
  }
  rotary_.settle_axes_for("G29", false);
  Vec3 via = place_.position_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) via[axis] = (*reference_via_mm_)[axis];
  const Vec3 start = place_.position_mm;
  if (modal_.state().incremental) place_.position_mm = via;  // increments count from the intermediate point
  const Vec3 end = mover_.target();
  place_.position_mm = start;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis]) && place_.axis[axis] == AxisPlace::reference)
      place_.axis[axis] = AxisPlace::known;
  mover_.add_move(MoveKind::rapid, via).reference = true;
  mover_.add_move(MoveKind::rapid, end);
  mover_.settle_axes();
}

void ReferenceMoves::go_in_machine_frame() {
  if (!at_.words.has_any("XYZ") && !rotary_.target()) return;
  modal_.check_unit();
  if (modal_.is_arc() || modal_.cycle_g() != 0) {
    at_.error(at_.words.offset(), "machine-frame", "G53 goes with G0 or G1; another motion is active");
    return;
  }
  Vec3 end = place_.position_mm, machine_mm = Vec3::Zero();
  std::uint8_t given = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!at_.words.has(kAxisLetters[axis])) continue;
    machine_mm[static_cast<Eigen::Index>(axis)] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
    given = static_cast<std::uint8_t>(given | 1U << axis);
    frames_.settle_machine_axis(axis, machine_mm[static_cast<Eigen::Index>(axis)], end);
  }
  rotary_.add_machine_target(machine_mm, given);
  std::optional<double> feed;
  if (modal_.motion() == MotionCode::linear) feed = modal_.cutting_feed((end - place_.position_mm).norm(), "G1");
  Move& move = mover_.add_move(modal_.motion() == MotionCode::linear ? MoveKind::linear : MoveKind::rapid, end);
  move.feed_mm_per_s = feed.value_or(0);
}

}  // namespace camber::nc
