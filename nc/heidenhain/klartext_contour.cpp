// Corners, approach and departure.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/corner_cut.h"
#include "nc/heidenhain/klartext_motion.h"
#include "nc/plane_curves.h"

namespace camber::nc::heidenhain {

/// RND R5 F100, CHF 2: at the end of the block before it.
void Contour::set_corner(const Statement& s, const BlockValues& b) {
  const bool chamfer = s.kind == Kind::chamfer;
  const char* name = chamfer ? "CHF" : "RND";
  if (!b.radius || *b.radius < 0)
    return at_.error(s.begin, "corner",
                     fmt::format("{} without a {}; {} was expected", name, chamfer ? "length" : "radius",
                                 chamfer ? "CHF 2" : "RND R2"));
  const bool moved = !at_.out.moves.empty() && !at_.out.moves.back().canned && !corner_.waits &&
                     (at_.out.moves.back().kind == MoveKind::linear || at_.out.moves.back().kind == MoveKind::arc);
  if (!moved)
    return at_.error(s.begin, "corner", fmt::format("{} behind a block that is no line or arc of the contour", name));
  corner_ = {};
  corner_.waits = true;
  corner_.chamfer = chamfer;
  corner_.size_mm = *b.radius * at_.unit_mm();
  if (b.feed.value) corner_.feed_mm_per_s = mm_per_s_from_mm_per_min(*b.feed.value * at_.unit_mm());
  corner_.move = at_.out.moves.size() - 1;
  corner_.offset = s.begin;
  corner_.text = text_of(s);
}

void Contour::after_move(std::size_t first) {
  const Move& move = at_.out.moves[first];
  if (approach_.waits) {
    if (move.kind == MoveKind::linear || move.kind == MoveKind::arc || move.kind == MoveKind::rapid)
      finish_approach(first);
    return;
  }
  if (!corner_.waits || first <= corner_.move) return;
  const Corner corner = std::exchange(corner_, {});
  const std::size_t before = corner.move;
  Move &a = at_.out.moves[before], &b = at_.out.moves[first];
  a.editable = b.editable = false;
  at_.relied_ends.add(std::span(at_.out.moves).first(before));
  if (first != before + 1 || (b.kind != MoveKind::linear && b.kind != MoveKind::arc) || b.canned || b.reference)
    return at_.error(
        corner.offset, "corner",
        fmt::format("{} is not followed by a line or an arc of the contour; L, C, CR or CT was expected", corner.text));
  if (!(at_.out.frame_of(a) == at_.out.frame_of(b)))
    return at_.error(corner.offset, "corner",
                     fmt::format("{} before a block in another frame; the same was expected", corner.text));
  const CornerCutResult cut = cut_corner(
      at_.out, {before, first, tools_.plane(), "of the tool axis", corner.chamfer, corner.size_mm, corner.text});
  if (!cut.error.empty()) return at_.error(corner.offset, "corner", cut.error);
  if (!cut.between) return;
  Move between = *cut.between;
  if (corner.feed_mm_per_s) between.feed_mm_per_s = *corner.feed_mm_per_s;
  at_.out.moves.insert(at_.out.moves.begin() + static_cast<std::ptrdiff_t>(first), between);
  for (auto e = at_.out.events.rbegin(); e != at_.out.events.rend() && e->before_move >= first; ++e)
    if (e->block == b.block) ++e->before_move;
}

/// LT, LN, CT, LCT and, with P in front, polar.
std::optional<Contour::Form> Contour::read_form(const Statement& s, bool& polar) {
  Cursor at = at_.cursor(s);
  std::string form = at.letters();
  polar = form.starts_with('P');
  if (polar) form.erase(0, 1);
  if (form == "LT") return Form::tangent_line;
  if (form == "LN") return Form::normal_line;
  if (form == "CT") return Form::arc;
  if (form == "LCT") return Form::line_and_arc;
  at_.error(s.begin, "approach",
            fmt::format("{} is no way to a contour; LT, LN, CT or LCT was expected", form.empty() ? "nothing" : form));
  return std::nullopt;
}

/// Where a line from `outside` runs onto the circle in its sense, or a line to there leaves it. In the plane of the
/// tool axis.
Vec3 Contour::tangent_point(const Vec3& centre, double radius, double sense, const Vec3& outside, bool arrives) const {
  const PlaneAxes axes = tools_.axes();
  const Vec2 c(centre[axes.first], centre[axes.second]);
  const Vec2 out(outside[axes.first] - c.x(), outside[axes.second] - c.y());
  const double distance = out.norm();
  const double open = std::acos(std::clamp(radius / distance, -1.0, 1.0));
  const double angle = std::atan2(out.y(), out.x()) + (arrives ? 1 : -1) * sense * open;
  Vec3 point = centre;
  point[axes.first] = c.x() + radius * std::cos(angle);
  point[axes.second] = c.y() + radius * std::sin(angle);
  return point;
}

/// APPR: the way is made when the next block says which direction the contour has at its start.
void Contour::start_approach(const Statement& s, const BlockValues& b, std::optional<double> feed_before) {
  bool polar = false;
  const auto form = read_form(s, polar);
  if (!form) return;
  Approach a;
  a.waits = true;
  a.form = *form;
  a.length_mm = b.length.value_or(0) * at_.unit_mm();
  a.radius_mm = b.radius.value_or(0) * at_.unit_mm();
  a.angle_rad = rad_from_deg(b.arc_angle.value_or(0));
  a.from_mm = mover_.programmed();
  a.start_mm = polar ? path_.polar_target(b) : mover_.target(b);
  a.rapid = b.feed.rapid;
  a.feed_mm_per_s = b.feed.rapid ? 0 : modes_.cutting_feed("APPR");
  // The way to PH: LCT at the feed of the block, the others as the block before it went (APPR in the manuals).
  const bool as_before = *form != Form::line_and_arc && !at_.out.moves.empty() && !b.feed.rapid &&
                         modes_.state().feed_mode != FeedMode::per_revolution;
  a.rapid_there = b.feed.rapid || (as_before && positioned_at_rapid());
  a.feed_there_mm_per_s = as_before && !a.rapid_there && feed_before ? *feed_before : a.feed_mm_per_s;
  a.offset = s.begin;
  a.block = at_.block;
  const bool line = *form == Form::tangent_line || *form == Form::normal_line;
  if (line && a.length_mm == 0)
    return at_.error(s.begin, "approach", "APPR on a line without its length; LEN was expected");
  if (!line && a.radius_mm == 0)
    return at_.error(s.begin, "approach", "APPR on an arc without its radius; R was expected");
  if (*form == Form::arc && a.angle_rad == 0)
    return at_.error(s.begin, "approach", "APPR CT without the angle of its arc; CCA was expected");
  mover_.prepare_cutting("APPR", 7);
  at_.relied_ends.add(at_.out.moves);
  if (b.compensation) compensation_.set(*b.compensation, s.begin);
  a.has_side = b.compensation ? *b.compensation == 1 || *b.compensation == 2 : compensation_.active();
  a.side = a.has_side && (b.compensation ? *b.compensation == 1 : compensation_.left()) ? 1 : -1;
  if (!a.has_side && (*form == Form::normal_line || *form == Form::arc))
    at_.warn(
        s.begin, "approach",
        "APPR LN or CT without RL or RR is read as with RR, as an iTNC 530 goes; later controls stop here; RL or RR "
        "was expected",
        "APPR");
  a.move = at_.out.moves.size();
  approach_ = a;
  mover_.stand_at(a.start_mm);
  mover_.settle(7);
}

/// Whether the last block that moved went at FMAX.
bool Contour::positioned_at_rapid() const {
  for (std::size_t i = at_.out.moves.size(); i-- > 0;)
    if (at_.out.moves[i].kind != MoveKind::dwell) return at_.out.moves[i].kind == MoveKind::rapid;
  return false;
}

/// `contour`: the first move of the contour.
void Contour::finish_approach(std::size_t contour) {
  Approach a = std::exchange(approach_, {});
  const PlaneAxes axes = tools_.axes();
  Vec3 along = frames_.frame().inverse * direction_at(at_.out, at_.out.moves[contour], 0);
  along[axes.normal] = 0;
  if (along.norm() < 1e-12)
    return at_.error(a.offset, "approach",
                     "APPR is followed by a block that does not move in the plane; a contour was expected");
  along.normalize();
  Vec3 left = Vec3::Zero();
  left[axes.first] = -along[axes.second];
  left[axes.second] = along[axes.first];
  // Without RL and RR an arc begins on the side from which the tool comes.
  if (!a.has_side && a.form == Form::line_and_arc) a.side = left.dot(a.from_mm - a.start_mm) >= 0 ? 1 : -1;
  compensation_.set_last(a.side > 0 ? 1 : 2);
  left *= a.side;
  std::vector<Move> way;
  const auto add = [&](const Vec3& to, std::optional<Arc> arc) {
    Move move = at_.out.moves[contour];
    move.block = a.block;
    move.editable = move.feed_given = false;
    move.start_mm = way.empty() ? frames_.frame().from_program(a.from_mm) : way.back().end_mm;
    move.end_mm = frames_.frame().from_program(to);
    const bool rapid = way.empty() ? a.rapid_there : a.rapid;
    move.feed_mm_per_s = rapid ? 0 : way.empty() ? a.feed_there_mm_per_s : a.feed_mm_per_s;
    move.kind = arc ? MoveKind::arc : rapid ? MoveKind::rapid : MoveKind::linear;
    move.arc = Move::kNoArc;
    if (arc) {
      at_.out.arcs.push_back(frames_.frame().plain ? *arc : from_program(frames_.frame(), *arc).value_or(*arc));
      move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
    }
    way.push_back(move);
  };
  if (a.form == Form::tangent_line || a.form == Form::normal_line) {
    const Vec3 way_in = a.form == Form::tangent_line ? along : Vec3(-left);
    add(a.start_mm - a.length_mm * way_in, std::nullopt);
    add(a.start_mm, std::nullopt);
  } else {
    // The arc lies on the side of the tool; a negative radius: on the other one.
    const double radius = std::abs(a.radius_mm), sense = a.side * (a.radius_mm > 0 ? 1 : -1);
    Arc arc;
    arc.normal = normal_of(tools_.plane());
    arc.center_mm = a.start_mm + radius * (a.radius_mm > 0 ? 1 : -1) * left;
    Vec3 begin = a.start_mm;
    double sweep = a.angle_rad;
    const auto relative = [&](const Vec3& p) {
      return Vec2(p[axes.first] - arc.center_mm[axes.first], p[axes.second] - arc.center_mm[axes.second]);
    };
    if (a.form == Form::arc) {
      const Vec2 end = relative(a.start_mm);
      const double c = std::cos(-sense * sweep), n = std::sin(-sense * sweep);
      begin[axes.first] = arc.center_mm[axes.first] + c * end.x() - n * end.y();
      begin[axes.second] = arc.center_mm[axes.second] + n * end.x() + c * end.y();
    } else {
      if (relative(a.from_mm).norm() <= radius)
        return at_.error(a.offset, "approach",
                         "APPR LCT from inside its own arc; a smaller radius or a start further away was expected");
      begin = tangent_point(arc.center_mm, radius, sense, a.from_mm, true);
      begin[axes.normal] = a.start_mm[axes.normal];
      sweep = turn_from(relative(begin), relative(a.start_mm), sense);
    }
    arc.sweep_rad = sense * sweep;
    add(begin, std::nullopt);
    add(a.start_mm, arc);
  }
  at_.out.moves[contour].start_mm = way.back().end_mm;
  at_.out.moves[contour].editable = false;
  at_.out.moves.insert(at_.out.moves.begin() + static_cast<std::ptrdiff_t>(contour), way.begin(), way.end());
  for (auto e = at_.out.events.rbegin(); e != at_.out.events.rend() && e->before_move >= contour; ++e)
    if (e->block == at_.out.moves[contour + way.size()].block) e->before_move += static_cast<std::uint32_t>(way.size());
}

/// DEP: along the tangent, across it, or on an arc; radius compensation ends behind it.
void Contour::depart(const Statement& s, const BlockValues& b) {
  bool polar = false;
  const auto form = read_form(s, polar);
  if (!form) return;
  if (corner_.waits) corner_ = {};
  const PlaneAxes axes = tools_.axes();
  const Vec3 along = mover_.last_direction(), from = mover_.programmed();
  if (along == Vec3::Zero()) return at_.error(s.begin, "approach", "DEP without a contour before it");
  at_.relied_ends.add_direction(at_.out.moves);
  at_.editable = false;
  Vec3 left = Vec3::Zero();
  const double side = compensation_.active() ? (compensation_.left() ? 1 : -1) : compensation_.last() == 2 ? -1 : 1;
  left[axes.first] = -along[axes.second];
  left[axes.second] = along[axes.first];
  left *= side;
  const double length = b.length.value_or(0) * at_.unit_mm(), radius = b.radius.value_or(0) * at_.unit_mm();
  const bool line = *form == Form::tangent_line || *form == Form::normal_line;
  if (line && length == 0) return at_.error(s.begin, "approach", "DEP on a line without its length; LEN was expected");
  if (!line && radius == 0) return at_.error(s.begin, "approach", "DEP on an arc without its radius; R was expected");
  Vec3 end = mover_.target(b);
  if (line) {
    end += length * (*form == Form::tangent_line ? along : left);
    mover_.line_to(end, 7, b);
  } else {
    const double size = std::abs(radius), sense = side * (radius > 0 ? 1 : -1);
    Arc arc;
    arc.normal = normal_of(tools_.plane());
    arc.center_mm = from + size * (radius > 0 ? 1 : -1) * left;
    const auto relative = [&](const Vec3& p) {
      return Vec2(p[axes.first] - arc.center_mm[axes.first], p[axes.second] - arc.center_mm[axes.second]);
    };
    Vec3 off = from;
    double sweep = rad_from_deg(b.arc_angle.value_or(0));
    if (*form == Form::arc) {
      if (sweep == 0) return at_.error(s.begin, "approach", "DEP CT without the angle of its arc; CCA was expected");
      const Vec2 start = relative(from);
      const double c = std::cos(sense * sweep), n = std::sin(sense * sweep);
      off[axes.first] = arc.center_mm[axes.first] + c * start.x() - n * start.y();
      off[axes.second] = arc.center_mm[axes.second] + n * start.x() + c * start.y();
    } else {
      if (polar) end = path_.polar_target(b);
      if (relative(end).norm() <= size)
        return at_.error(s.begin, "approach", "DEP LCT to a place inside its own arc; a smaller radius was expected");
      off = tangent_point(arc.center_mm, size, sense, end, false);
      off[axes.normal] = from[axes.normal];
      sweep = turn_from(relative(from), relative(off), sense);
    }
    arc.sweep_rad = sense * sweep;
    mover_.arc_to(off, arc, b, false);
    if (*form == Form::line_and_arc) {
      compensation_.end();
      mover_.line_to(end, 7, b);
    }
  }
  compensation_.end();
  for (std::size_t i = at_.out.moves.size(); i-- > 0 && at_.out.moves[i].block == at_.block;)
    at_.out.moves[i].editable = false;
}

void Contour::finish() {
  if (corner_.waits && !at_.report.has_errors())
    at_.error(corner_.offset, "corner",
              fmt::format("{} is not followed by a further block of the contour", corner_.text));
  if (approach_.waits && !at_.report.has_errors())
    at_.error(approach_.offset, "approach", "APPR is not followed by a block of the contour; L, C or CR was expected");
}

std::string Contour::text_of(const Statement& s) const {
  std::string_view text = at_.file().source.text();
  text = text.substr(s.begin, s.end - s.begin);
  text = text.substr(0, text.find_first_of("\r\n;"));
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

}  // namespace camber::nc::heidenhain
