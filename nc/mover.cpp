#include "nc/mover.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc {

Move& Mover::add_move(MoveKind kind, const Vec3& end_mm) {
  Move move;
  move.start_mm = place_.position_mm;
  move.end_mm = end_mm;
  move.block = at_.block;
  move.state = modal_.state_index();
  move.kind = kind;
  move.editable = at_.editable && !frames_.frame().polar;
  move.exact_stop = at_.request.exact_stop;
  modal_.give_feed_to(move);
  move.reference = kind != MoveKind::dwell && place_.unknown();
  if (radius_.leaving()) radius_.leave_contour(move);
  const bool turns = !at_.options.rotary_axes.empty() && kind != MoveKind::dwell;
  if (turns) rotary_.begin_move(move);
  place_.position_mm = end_mm;
  at_.out.moves.push_back(move);
  if (turns) rotary_.add_rotary_target(at_.out.moves.size() - 1);
  return at_.out.moves.back();
}

/// The axis words of the block, and an angle (,A), counted from `start`, a point in the same coordinates.
Vec3 Mover::target_from(const Vec3& start) {
  Vec3 end = start;
  for (int axis = 0; axis < 3; ++axis) {
    if (!at_.words.has(kAxisLetters[axis])) continue;
    const double value = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
    end[axis] = modal_.state().incremental ? end[axis] + value : value;
  }
  return at_.words.corner_words().empty() ? end : target_at_angle(start, end);
}

Vec3 Mover::target() {
  if (frames_.frame().plain && !frames_.frame().polar) return target_from(place_.position_mm);
  Vec3 end = frames_.frame().from_program(programmed_target());
  if (!frames_.frame().shift_only) return end;
  for (int axis = 0; axis < 3; ++axis)
    if (!at_.words.has(kAxisLetters[axis]) && !frames_.frame().polar && at_.words.corner_words().empty())
      end[axis] = place_.position_mm[axis];
  return end;
}

Vec3 Mover::programmed_target() {
  const Vec3 start = frames_.programmed();
  return frames_.frame().polar ? frames_.polar_target(start) : target_from(start);
}

void Mover::settle_axes() {
  if (modal_.state().incremental) return;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) place_.axis[axis] = AxisPlace::known;
}

/// ,A: the end on a line of that angle, where the block names one coordinate of the plane.
Vec3 Mover::target_at_angle(const Vec3& start, Vec3 end) {
  const auto& words = at_.words.corner_words();
  const auto word = std::ranges::find(words, 'a', &Word::letter);
  if (word == words.end() || modal_.motion() != MotionCode::linear || frames_.frame().polar) return end;
  const PlaneAxes axes = axes_of(modal_.plane());
  const bool first = at_.words.has(kAxisLetters[axes.first]), second = at_.words.has(kAxisLetters[axes.second]);
  if (first == second) {
    at_.error((*word)->offset, "corner-word",
              fmt::format(",A in a block with {} of {} and {}; one of them was expected", first ? "both" : "none",
                          kAxisLetters[axes.first], kAxisLetters[axes.second]));
    return end;
  }
  const double angle = rad_from_deg((*word)->value * whole_numbers_.scale_of(**word));
  const double across = first ? std::cos(angle) : std::sin(angle), along = first ? std::sin(angle) : std::cos(angle);
  const int given = first ? axes.first : axes.second, open = first ? axes.second : axes.first;
  if (std::abs(across) < 1e-6) {
    at_.error((*word)->offset, "corner-word",
              fmt::format("a line at {} degrees does not lead to another {}", (*word)->value, kAxisLetters[given]));
    return end;
  }
  end[open] = start[open] + (end[given] - start[given]) * along / across;
  at_.editable = false;
  at_.relied_ends.add(at_.out.moves);
  return end;
}

/// A cutting move needs a place to start from: axes that were never programmed are taken to stand at zero. `arc`: its
/// centre counts from the start, so that axes that the block itself places need one too.
void Mover::prepare_cutting(const char* what, bool arc) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool placed = at_.words.has(kAxisLetters[axis]) && !modal_.state().incremental;
    if (place_.axis[axis] == AxisPlace::known) continue;
    const char letter = kAxisLetters[axis];
    if (placed && !(arc && place_.axis[axis] == AxisPlace::never)) {
      if (place_.axis[axis] == AxisPlace::never)
        at_.report.warning(at_.words.offset(), "start-unknown",
                           fmt::format("{} to {} from a place that the program has not given; the move is ignored for "
                                       "material removal",
                                       what, letter),
                           "from nowhere");
      continue;
    }
    if (place_.axis[axis] == AxisPlace::never) {
      at_.report.warning(
          at_.words.offset(), "start-unknown",
          fmt::format("{} before {} was programmed; the tool is assumed to be at {}0", what, letter, letter));
      place_.axis[axis] = AxisPlace::known;
    } else {
      at_.report.warning(
          at_.words.offset(), "at-reference",
          fmt::format("{} while {} is at the reference point; the move is ignored for material removal", what, letter));
    }
  }
  if (first_cut_offset_ == 0) first_cut_offset_ = modal_.state().work_offset;
  if (modal_.state().work_offset != first_cut_offset_ &&
      !(frames_.offset_known(modal_.state().work_offset) && frames_.offset_known(first_cut_offset_)))
    at_.report.warning(
        at_.words.offset(), "work-offsets",
        "the program cuts in more than one work offset; their distance is not known, and all are treated as one frame");
}

}  // namespace camber::nc
