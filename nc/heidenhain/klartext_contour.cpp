// Corners, approach and departure, radius compensation.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/heidenhain/klartext.h"
#include "nc/plane_curves.h"

namespace camber::nc::heidenhain {

// --- RND, CHF

/// RND R5 F100, CHF 2: at the end of the block before it.
void Klartext::set_corner(const Statement& s, const BlockValues& b) {
  const bool chamfer = s.kind == Kind::chamfer;
  const char* name = chamfer ? "CHF" : "RND";
  if (!b.radius || *b.radius < 0)
    return error(s.begin, "corner",
                 fmt::format("{} without a {}; {} was expected", name, chamfer ? "length" : "radius",
                             chamfer ? "CHF 2" : "RND R2"));
  const bool moved = !out_.moves.empty() && !out_.moves.back().canned && !corner_.waits &&
                     (out_.moves.back().kind == MoveKind::linear || out_.moves.back().kind == MoveKind::arc);
  if (!moved)
    return error(s.begin, "corner", fmt::format("{} behind a block that is no line or arc of the contour", name));
  corner_ = {};
  corner_.waits = true;
  corner_.chamfer = chamfer;
  corner_.size_mm = *b.radius * unit_mm();
  if (b.feed) corner_.feed_mm_per_s = mm_per_s_from_mm_per_min(*b.feed * unit_mm());
  corner_.move = out_.moves.size() - 1;
  corner_.offset = s.begin;
  corner_.text = text_of(s);
}

/// `first`: of the moves that the block has made.
void Klartext::after_contour_move(std::size_t first) {
  const Move& move = out_.moves[first];
  if (approach_.waits) {
    if (move.kind == MoveKind::linear || move.kind == MoveKind::arc || move.kind == MoveKind::rapid)
      finish_approach(first);
    return;
  }
  if (!corner_.waits || first <= corner_.move) return;
  const Pending corner = std::exchange(corner_, {});
  const std::size_t before = corner.move;
  Move &a = out_.moves[before], &b = out_.moves[first];
  a.editable = b.editable = false;
  relied_ends_.add(std::span(out_.moves).first(before));
  if (first != before + 1 || (b.kind != MoveKind::linear && b.kind != MoveKind::arc) || b.canned || b.reference)
    return error(
        corner.offset, "corner",
        fmt::format("{} is not followed by a line or an arc of the contour; L, C, CR or CT was expected", corner.text));
  if (!(out_.frame_of(a) == out_.frame_of(b)))
    return error(corner.offset, "corner",
                 fmt::format("{} before a block in another frame; the same was expected", corner.text));
  const CornerCutResult cut = cut_corner(out_, {before, first, plane_of_axis(tool_axis_), "of the tool axis",
                                                corner.chamfer, corner.size_mm, corner.text});
  if (!cut.error.empty()) return error(corner.offset, "corner", cut.error);
  if (!cut.between) return;
  Move between = *cut.between;
  if (corner.feed_mm_per_s) between.feed_mm_per_s = *corner.feed_mm_per_s;
  out_.moves.insert(out_.moves.begin() + static_cast<std::ptrdiff_t>(first), between);
  for (auto e = out_.events.rbegin(); e != out_.events.rend() && e->before_move >= first; ++e)
    if (e->block == b.block) ++e->before_move;
}

// --- APPR, DEP

/// LT, LN, CT, LCT and, with P in front, polar.
std::optional<Klartext::Form> Klartext::read_form(const Statement& s, bool& polar) {
  Cursor at = cursor(s);
  std::string form = at.letters();
  polar = form.starts_with('P');
  if (polar) form.erase(0, 1);
  if (form == "LT") return Form::tangent_line;
  if (form == "LN") return Form::normal_line;
  if (form == "CT") return Form::arc;
  if (form == "LCT") return Form::line_and_arc;
  error(s.begin, "approach",
        fmt::format("{} is no way to a contour; LT, LN, CT or LCT was expected", form.empty() ? "nothing" : form));
  return std::nullopt;
}

/// Where a line from `outside` runs onto the circle in its sense, or a line to there leaves it. In the plane of the
/// tool axis.
Vec3 Klartext::tangent_point(const Vec3& centre, double radius, double sense, const Vec3& outside, bool arrives) const {
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
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
void Klartext::start_approach(const Statement& s, const BlockValues& b, std::optional<double> feed_before) {
  bool polar = false;
  const auto form = read_form(s, polar);
  if (!form) return;
  Approach a;
  a.waits = true;
  a.form = *form;
  a.length_mm = b.length.value_or(0) * unit_mm();
  a.radius_mm = b.radius.value_or(0) * unit_mm();
  a.angle_rad = rad_from_deg(b.arc_angle.value_or(0));
  a.from_mm = programmed();
  a.start_mm = polar ? polar_target(b) : target(b);
  a.rapid = b.rapid;
  a.feed_mm_per_s = b.rapid ? 0 : cutting_feed("APPR");
  // The way to PH: LCT at the feed of the block, the others as the block before it went (APPR in the manuals).
  const bool as_before =
      *form != Form::line_and_arc && !out_.moves.empty() && !b.rapid && state_.feed_mode != FeedMode::per_revolution;
  a.rapid_there = b.rapid || (as_before && positioned_at_rapid());
  a.feed_there_mm_per_s = as_before && !a.rapid_there && feed_before ? *feed_before : a.feed_mm_per_s;
  a.offset = s.begin;
  a.block = block_;
  const bool line = *form == Form::tangent_line || *form == Form::normal_line;
  if (line && a.length_mm == 0)
    return error(s.begin, "approach", "APPR on a line without its length; LEN was expected");
  if (!line && a.radius_mm == 0) return error(s.begin, "approach", "APPR on an arc without its radius; R was expected");
  if (*form == Form::arc && a.angle_rad == 0)
    return error(s.begin, "approach", "APPR CT without the angle of its arc; CCA was expected");
  prepare_cutting("APPR", 7);
  relied_ends_.add(out_.moves);
  if (b.compensation) set_compensation(*b.compensation, s.begin);
  a.has_side = b.compensation ? *b.compensation == 1 || *b.compensation == 2 : radius_.active;
  a.side = a.has_side && (b.compensation ? *b.compensation == 1 : radius_.left) ? 1 : -1;
  if (!a.has_side && (*form == Form::normal_line || *form == Form::arc))
    warn(s.begin, "approach",
         "APPR LN or CT without RL or RR is read as with RR, as an iTNC 530 goes; later controls stop here; RL or RR "
         "was expected",
         "APPR");
  a.move = out_.moves.size();
  approach_ = a;
  position_mm_ = end_in_moves(a.start_mm, 7);
  settle(7);
}

/// Whether the last block that moved went at FMAX.
bool Klartext::positioned_at_rapid() const {
  for (std::size_t i = out_.moves.size(); i-- > 0;)
    if (out_.moves[i].kind != MoveKind::dwell) return out_.moves[i].kind == MoveKind::rapid;
  return false;
}

/// `contour`: the first move of the contour.
void Klartext::finish_approach(std::size_t contour) {
  Approach a = std::exchange(approach_, {});
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  Vec3 along = frame_.inverse * direction_at(out_, out_.moves[contour], 0);
  along[axes.normal] = 0;
  if (along.norm() < 1e-12)
    return error(a.offset, "approach",
                 "APPR is followed by a block that does not move in the plane; a contour was expected");
  along.normalize();
  Vec3 left = Vec3::Zero();
  left[axes.first] = -along[axes.second];
  left[axes.second] = along[axes.first];
  // Without RL and RR an arc begins on the side from which the tool comes.
  if (!a.has_side && a.form == Form::line_and_arc) a.side = left.dot(a.from_mm - a.start_mm) >= 0 ? 1 : -1;
  last_compensation_ = a.side > 0 ? 1 : 2;
  left *= a.side;
  std::vector<Move> way;
  const auto add = [&](const Vec3& to, std::optional<Arc> arc) {
    Move move = out_.moves[contour];
    move.block = a.block;
    move.editable = move.feed_given = false;
    move.start_mm = way.empty() ? frame_.from_program(a.from_mm) : way.back().end_mm;
    move.end_mm = frame_.from_program(to);
    const bool rapid = way.empty() ? a.rapid_there : a.rapid;
    move.feed_mm_per_s = rapid ? 0 : way.empty() ? a.feed_there_mm_per_s : a.feed_mm_per_s;
    move.kind = arc ? MoveKind::arc : rapid ? MoveKind::rapid : MoveKind::linear;
    move.arc = Move::kNoArc;
    if (arc) {
      out_.arcs.push_back(frame_.plain ? *arc : from_program(frame_, *arc).value_or(*arc));
      move.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
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
    arc.normal = normal_of(plane_of_axis(tool_axis_));
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
        return error(a.offset, "approach",
                     "APPR LCT from inside its own arc; a smaller radius or a start further away was expected");
      begin = tangent_point(arc.center_mm, radius, sense, a.from_mm, true);
      begin[axes.normal] = a.start_mm[axes.normal];
      sweep = turn_from(relative(begin), relative(a.start_mm), sense);
    }
    arc.sweep_rad = sense * sweep;
    add(begin, std::nullopt);
    add(a.start_mm, arc);
  }
  out_.moves[contour].start_mm = way.back().end_mm;
  out_.moves[contour].editable = false;
  out_.moves.insert(out_.moves.begin() + static_cast<std::ptrdiff_t>(contour), way.begin(), way.end());
  for (auto e = out_.events.rbegin(); e != out_.events.rend() && e->before_move >= contour; ++e)
    if (e->block == out_.moves[contour + way.size()].block) e->before_move += static_cast<std::uint32_t>(way.size());
}

/// DEP: along the tangent, across it, or on an arc; radius compensation ends behind it.
void Klartext::depart(const Statement& s, const BlockValues& b) {
  bool polar = false;
  const auto form = read_form(s, polar);
  if (!form) return;
  if (corner_.waits) corner_ = {};
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  const Vec3 along = last_direction(), from = programmed();
  if (along == Vec3::Zero()) return error(s.begin, "approach", "DEP without a contour before it");
  relied_ends_.add_direction(out_.moves);
  editable_ = false;
  Vec3 left = Vec3::Zero();
  const double side = radius_.active ? (radius_.left ? 1 : -1) : last_compensation_ == 2 ? -1 : 1;
  left[axes.first] = -along[axes.second];
  left[axes.second] = along[axes.first];
  left *= side;
  const double length = b.length.value_or(0) * unit_mm(), radius = b.radius.value_or(0) * unit_mm();
  const bool line = *form == Form::tangent_line || *form == Form::normal_line;
  if (line && length == 0) return error(s.begin, "approach", "DEP on a line without its length; LEN was expected");
  if (!line && radius == 0) return error(s.begin, "approach", "DEP on an arc without its radius; R was expected");
  Vec3 end = target(b);
  if (line) {
    end += length * (*form == Form::tangent_line ? along : left);
    line_to(end, 7, b);
  } else {
    const double size = std::abs(radius), sense = side * (radius > 0 ? 1 : -1);
    Arc arc;
    arc.normal = normal_of(plane_of_axis(tool_axis_));
    arc.center_mm = from + size * (radius > 0 ? 1 : -1) * left;
    const auto relative = [&](const Vec3& p) {
      return Vec2(p[axes.first] - arc.center_mm[axes.first], p[axes.second] - arc.center_mm[axes.second]);
    };
    Vec3 off = from;
    double sweep = rad_from_deg(b.arc_angle.value_or(0));
    if (*form == Form::arc) {
      if (sweep == 0) return error(s.begin, "approach", "DEP CT without the angle of its arc; CCA was expected");
      const Vec2 start = relative(from);
      const double c = std::cos(sense * sweep), n = std::sin(sense * sweep);
      off[axes.first] = arc.center_mm[axes.first] + c * start.x() - n * start.y();
      off[axes.second] = arc.center_mm[axes.second] + n * start.x() + c * start.y();
    } else {
      if (polar) end = polar_target(b);
      if (relative(end).norm() <= size)
        return error(s.begin, "approach", "DEP LCT to a place inside its own arc; a smaller radius was expected");
      off = tangent_point(arc.center_mm, size, sense, end, false);
      off[axes.normal] = from[axes.normal];
      sweep = turn_from(relative(from), relative(off), sense);
    }
    arc.sweep_rad = sense * sweep;
    arc_to(off, arc, b, false);
    if (*form == Form::line_and_arc) {
      end_compensation();
      line_to(end, 7, b);
    }
  }
  end_compensation();
  for (std::size_t i = out_.moves.size(); i-- > 0 && out_.moves[i].block == block_;) out_.moves[i].editable = false;
}

// --- RL, RR, R0

void Klartext::set_compensation(int code, std::size_t offset) {
  last_compensation_ = code == 0 ? last_compensation_ : code;
  if (code == 0) return end_compensation();
  if (code > 2) {
    warn(offset, "no-effect", "R+ and R- (compensation of one axis) are read without effect", "R+");
    return;
  }
  const bool left = code == 1;
  if (radius_.active) {
    if (radius_.left != left)
      error(offset, "cutter-radius",
            fmt::format("{} while {} is active; R0 was expected before", left ? "RL" : "RR", left ? "RR" : "RL"));
    return;
  }
  const auto radius = tool_radius_mm();
  if (!radius)
    warn(offset, "radius-unknown",
         fmt::format("no radius is given for tool {}; {} takes 0, as in a program of the cutter centre", state_.tool,
                     left ? "RL" : "RR"),
         fmt::format("radius {}", state_.tool));
  radius_ = {true, left, radius.value_or(0), out_.moves.size(), offset, plane_of_axis(tool_axis_)};
  state_.cutter_radius = radius.value_or(0) != 0;
  state_changed_ = true;
  if (!state_.cutter_radius || not_editable_told_) return;
  not_editable_told_ = true;
  warn(offset, "not-editable",
       fmt::format(
           "the path under {} is computed here, cutter radius {:.4f} mm; compensation leaves these moves unchanged",
           left ? "RL" : "RR", std::abs(*radius)));
}

void Klartext::end_compensation() {
  if (!radius_.active) return;
  const Compensation radius = std::exchange(radius_, {});
  state_.cutter_radius = false;
  state_changed_ = true;
  if (radius.radius_mm == 0 || radius.first_move >= out_.moves.size()) return;
  const PlaneAxes axes = axes_of(radius.plane);
  const Frame& frame = out_.frame_of(out_.moves[radius.first_move]);
  const Vec3 a = frame.linear.col(axes.first), b = frame.linear.col(axes.second);
  const double facing = a[axes.first] * b[axes.second] - a[axes.second] * b[axes.first];
  if (std::abs(a[axes.normal]) > 1e-12 || std::abs(b[axes.normal]) > 1e-12)
    return error(radius.offset, "cutter-radius",
                 fmt::format("{} in a tilted plane is not supported; the path of the cutter's centre (R0) was expected",
                             radius.left ? "RL" : "RR"));
  CutterRadius cutter;
  cutter.radius_mm = radius.radius_mm;
  cutter.left = radius.left == (facing > 0);
  cutter.plane = radius.plane;
  cutter.corner_lines = false;         // outside corners on arcs
  cutter.entry_square_to_next = true;  // the first point is reached square to the contour
  cutter.moves_without_plane_motion = 1000;
  cutter.name = radius.left ? "RL" : "RR";
  const CutterRadiusResult result = compensate_radius(out_, radius.first_move, cutter);
  for (const CutterRadiusProblem& problem : result.problems)
    error(
        file().blocks.size() > problem.block && &file() == &main_ ? main_.blocks[problem.block].offset : radius.offset,
        "cutter-radius", problem.message);
  beside_mm_ = result.end_mm - position_mm_;
  leaving_ = result.problems.empty() && beside_mm_ != Vec3::Zero();
}

}  // namespace camber::nc::heidenhain
