#include "nc/arc_moves.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::nc {

bool ArcMoves::other_centre_fits(const ArcWords& arc) const {
  ArcWords other = arc;
  other.absolute_centre = !arc.absolute_centre;
  const ArcResult fitting = make_arc(other);
  return fitting.error.empty() && fitting.radius_difference_mm < kArcRadiusWarningMm;
}

bool ArcMoves::arc_error(const ArcResult& result, const ArcWords& arc) {
  const std::size_t at = at_.request.motion_given ? at_.request.motion_word->offset : at_.words.offset();
  if (!result.error.empty()) {
    arcs_fit_absolute_ += other_centre_fits(arc);
    at_.error(at, "arc", result.error);
    return true;
  }
  if (result.radius_difference_mm < kArcRadiusWarningMm || arc.spiral) return false;
  std::string message = fmt::format("the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end",
                                    result.start_radius_mm, result.end_radius_mm);
  if (result.radius_difference_mm < kArcRadiusErrorMm) {
    at_.report.warning(at, "arc-radius",
                       message + fmt::format("; a difference below {:.3f} mm was expected", kArcRadiusWarningMm),
                       "arc-radius");
    return false;
  }
  message += fmt::format("; a difference below {:.2f} mm was expected", kArcRadiusErrorMm);
  if (other_centre_fits(arc)) {
    ++arcs_fit_absolute_;
    message += arc.absolute_centre ? " (with a centre from the start, G91.1, it would fit)"
                                   : " (with an absolute centre, G90.1, it would fit)";
  }
  at_.error(at, "arc-radius", std::move(message));
  return true;
}

void ArcMoves::move_on_arc() {
  modal_.check_unit();
  ArcWords arc;
  arc.plane = modal_.plane();
  arc.clockwise = modal_.motion() == MotionCode::clockwise;
  arc.absolute_centre = modal_.state().absolute_arc_centre;
  const char* g = modal_.spiral() ? (arc.clockwise ? "G2.1" : "G3.1") : arc.clockwise ? "G2" : "G3";
  rotary_.settle_axes_for("an arc", false);
  mover_.prepare_cutting(g, true);
  radius_.refuse_arc(g);
  const Vec3 end_mm = mover_.target();
  arc.start_mm = frames_.programmed();
  arc.end_mm = frames_.frame().plain ? end_mm : frames_.frame().to_program(end_mm);
  arc.i_mm = at_.words.scaled('I', modal_.unit_mm());
  arc.j_mm = at_.words.scaled('J', modal_.unit_mm());
  arc.k_mm = at_.words.scaled('K', modal_.unit_mm());
  arc.r_mm = at_.words.scaled('R', modal_.unit_mm());
  if (modal_.spiral()) {
    read_spiral_turns(arc);
  } else if (at_.words.has('P')) {
    const double turns = at_.words.value('P');
    arc.turns = turns == std::floor(turns) && turns >= 1 && turns < 1e6 ? static_cast<int>(turns) : 0;
    if (arc.turns == 0)
      at_.error(at_.words.offset_of('P'), "arc-turns",
                fmt::format("{} turns (P) on an arc; a whole number of one or more was expected", turns));
    arc.turns = std::max(arc.turns, 1);
  }
  if (!modal_.spiral()) read_spiral_words(arc);
  ArcResult result = make_arc(arc);
  if (modal_.spiral() && arc.r_mm) result.error = "a spiral with R leaves its centre open; I J K were expected";
  if (result.is_point) {
    motion_point(end_mm, g);
    return;
  }
  const auto in_moves =
      frames_.frame().plain || !result.error.empty() ? result.arc : from_program(frames_.frame(), result.arc);
  if (!in_moves)
    at_.error(at_.words.offset(), "scaling",
              "an arc under a scale that differs along its two axes would be an ellipse; one scale "
              "for both was expected");
  if (arc_error(result, arc) || !in_moves) {
    place_.position_mm = end_mm;
    mover_.settle_axes();
    return;
  }
  if (!arc.r_mm) ++arcs_fit_relative_;
  at_.out.arcs.push_back(*in_moves);
  Move& move = mover_.add_move(MoveKind::arc, end_mm);
  move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
  if (modal_.spiral()) move.editable = false;  // an arc in its place would need other words
  mover_.settle_axes();
  move.feed_mm_per_s = modal_.cutting_feed(length_mm(at_.out, move), g).value_or(0);
}

/// An arc so small that its centre coincides with an end to the last decimal: a line of that length.
void ArcMoves::motion_point(const Vec3& end_mm, const char* g) {
  const auto feed = modal_.cutting_feed((end_mm - place_.position_mm).norm(), g);
  Move& move = mover_.add_move(MoveKind::linear, end_mm);
  move.feed_mm_per_s = feed.value_or(0);
  move.editable = false;
  mover_.settle_axes();
}

/// G2.1, G3.1: the radius runs evenly from that of the start to that of the end; P full turns before the rest of one.
void ArcMoves::read_spiral_turns(ArcWords& arc) {
  arc.spiral = true;
  const double turns = at_.words.has('P') ? at_.words.value('P') : 0;
  if (turns != std::floor(turns) || turns < 0 || turns > 1e6) {
    at_.error(at_.words.offset_of('P'), "arc-turns",
              fmt::format("{} full turns (P) on a spiral; a whole number of zero or more was expected", turns));
    return;
  }
  arc.turns = static_cast<int>(turns) + 1;
}

/// L, and Q with it: an Archimedean spiral (in G17 with Z a conical one); or radii that differ where the control
/// takes that as a spiral.
void ArcMoves::read_spiral_words(ArcWords& arc) {
  if (arc.r_mm) return;
  if (!at_.words.has('L')) {
    const Dialect dialect = at_.dialect();
    if (dialect.spiral_radius_difference_mm <= 0 && dialect.spiral_radius_fraction <= 0) return;
    const ArcResult plain = make_arc(arc);
    const double larger = std::max(plain.start_radius_mm, plain.end_radius_mm);
    const double relative_mm = std::min(dialect.spiral_radius_fraction * larger, dialect.spiral_max_mm);
    arc.spiral = plain.error.empty() && plain.radius_difference_mm > kArcRadiusWarningMm &&
                 plain.radius_difference_mm <= std::max(dialect.spiral_radius_difference_mm, relative_mm);
    return;
  }
  const double turns = at_.words.value('L');
  if (!(turns > 0 && turns < 1e6)) {
    at_.error(at_.words.offset_of('L'), "arc-turns",
              fmt::format("{} turns (L) on an arc; a number greater than zero was expected", turns));
    return;
  }
  arc.spiral = true;
  arc.turns = static_cast<int>(std::ceil(turns));
  const ArcResult result = make_arc(arc);
  if (!at_.words.has('Q') || !result.error.empty()) return;
  const double end_mm =
      result.start_radius_mm + at_.words.value('Q') * modal_.unit_mm() * std::abs(result.arc.sweep_rad) / (2 * kPi);
  if (std::abs(end_mm - result.end_radius_mm) >= kArcRadiusErrorMm)
    at_.error(
        at_.words.offset_of('Q'), "arc-radius",
        fmt::format("the spiral ends at a radius of {:.4f} mm, with Q at {:.4f} mm; a difference below {:.2f} mm was "
                    "expected",
                    result.end_radius_mm, end_mm, kArcRadiusErrorMm));
}

bool ArcMoves::centres_look_absolute() const {
  return arcs_fit_absolute_ > 0 && arcs_fit_relative_ == 0 && !modal_.centre_mode_given();
}

}  // namespace camber::nc
