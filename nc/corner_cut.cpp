#include "nc/corner_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/plane_curves.h"

namespace camber::nc {
namespace {

constexpr double kTangentRad = 1e-6;   ///< blocks that turn by less have no corner
constexpr double kTooShortMm = 0.002;  ///< programs with three decimals make moves that are short by so much
constexpr double kStillMm = 1e-9;

/// A side of the corner: one of the two moves, in the plane. Times run from the corner: 0 there, length() at the other
/// end.
struct Side {
  PlaneCurve curve;
  double sense = 1;  ///< sense of a circle: 1 counter-clockwise
  double length = 0;
  Vec2 direction = Vec2::Zero();  ///< unit direction of the motion at the corner
};

/// A place on a side, and how much of the side lies between it and the corner.
struct Cut {
  Vec2 place = Vec2::Zero();
  double length = 0;
};

/// The side moved to its left.
PlaneCurve beside(const Side& side, double by) {
  PlaneCurve out = side.curve;
  out.point += by * left_of(side.direction);
  out.radius -= side.sense * by;
  return out;
}

Cut nearest_on(const Side& side, const Vec2& corner, const Vec2& place, double away) {
  if (!side.curve.circle) {
    const double along = (place - corner).dot(side.direction);
    return {corner + along * side.direction, away * along};
  }
  const Vec2 out = (place - side.curve.centre).normalized();
  const double turn = turn_from(out, corner - side.curve.centre, away * -side.sense);
  return {side.curve.centre + side.curve.radius * out, side.curve.radius * turn};
}

/// So far from the corner as the crow flies. `away`: -1 before the corner, 1 behind it.
std::optional<Cut> at_distance(const Side& side, const Vec2& corner, double distance, double away) {
  if (!side.curve.circle) return Cut{corner + away * distance * side.direction, distance};
  if (distance > 2 * side.curve.radius) return std::nullopt;
  const double turn = 2 * std::asin(distance / (2 * side.curve.radius)), signed_turn = away * side.sense * turn;
  const Vec2 out = corner - side.curve.centre;
  const double c = std::cos(signed_turn), s = std::sin(signed_turn);
  return Cut{side.curve.centre + Vec2(c * out.x() - s * out.y(), s * out.x() + c * out.y()), side.curve.radius * turn};
}

struct Rounding {
  Cut before, behind;
  Vec2 centre = Vec2::Zero();
};

/// The circle that touches both sides next to the corner; `left`: on the left of the motion.
std::optional<Rounding> rounding_at(const Side& before, const Side& behind, const Vec2& corner, double radius,
                                    bool left) {
  const double by = left ? radius : -radius;
  const PlaneCurve a = beside(before, by), b = beside(behind, by);
  if ((a.circle && a.radius <= kStillMm) || (b.circle && b.radius <= kStillMm)) return std::nullopt;
  std::optional<Rounding> best;
  for (const Vec2& centre : meetings(a, b)) {
    const Rounding found{nearest_on(before, corner, centre, -1), nearest_on(behind, corner, centre, 1), centre};
    if (found.before.length < -kTooShortMm || found.behind.length < -kTooShortMm) continue;
    if (!best || found.before.length + found.behind.length < best->before.length + best->behind.length) best = found;
  }
  return best;
}

/// A move in the coordinates of the text, in the plane of the corner.
struct TextMove {
  Vec3 start_mm, end_mm;
  std::optional<Arc> arc;
};

TextMove in_text(const Interpretation& program, const Move& move) {
  const Frame& frame = program.frame_of(move);
  TextMove out{frame.to_program(move.start_mm), frame.to_program(move.end_mm), std::nullopt};
  if (move.arc != Move::kNoArc) out.arc = to_program(frame, program.arcs[move.arc]);
  return out;
}

Side side_of(const TextMove& move, const PlaneAxes& axes, bool at_end) {
  const auto flat = [&](const Vec3& p) { return Vec2(p[axes.first], p[axes.second]); };
  const Vec2 start = flat(move.start_mm), end = flat(move.end_mm);
  Side side;
  if (!move.arc) {
    side.length = (end - start).norm();
    side.direction = side.length > kStillMm ? Vec2((end - start) / side.length) : Vec2(Vec2::Zero());
    side.curve = {false, at_end ? end : start, side.direction, Vec2::Zero(), 0};
    return side;
  }
  const Vec2 centre = flat(move.arc->center_mm), out = (at_end ? end : start) - centre;
  side.sense = move.arc->sweep_rad * move.arc->normal[axes.normal] < 0 ? -1 : 1;
  side.curve = {true, centre, Vec2::Zero(), centre, out.norm()};
  side.length = side.curve.radius * std::abs(move.arc->sweep_rad);
  side.direction = side.sense * left_of(out) / out.norm();
  return side;
}

}  // namespace

CornerCutResult cut_corner(Interpretation& program, const CornerCut& corner) {
  const auto fail = [](std::string message) { return CornerCutResult{.error = std::move(message), .between = {}}; };
  Move &a = program.moves[corner.before], &b = program.moves[corner.after];
  const Frame frame = program.frame_of(a);
  const PlaneAxes axes = axes_of(corner.plane);
  const TextMove text_a = in_text(program, a), text_b = in_text(program, b);
  const auto leaves_plane = [&](const TextMove& m) {
    return std::abs(m.end_mm[axes.normal] - m.start_mm[axes.normal]) > kStillMm;
  };
  if (leaves_plane(text_a) || leaves_plane(text_b))
    return fail(fmt::format("{} beside a move that leaves the plane {}; two moves in it were expected", corner.text,
                            corner.plane_name));
  const Side side_a = side_of(text_a, axes, true), side_b = side_of(text_b, axes, false);
  const bool still = side_a.length <= kStillMm || side_b.length <= kStillMm;
  if (still && corner.may_shrink) return {.error = {}, .between = {}, .shrunk = true};
  if (still)
    return fail(fmt::format("{} beside a move without length; two moves in the plane were expected", corner.text));
  const Vec2 at(text_a.end_mm[axes.first], text_a.end_mm[axes.second]);
  const double turn = angle_between(side_a.direction, side_b.direction);
  if (corner.size_mm == 0 || std::abs(turn) < kTangentRad) return {};  // nothing to round

  const auto cut_of = [&](double size) -> std::optional<Rounding> {
    if (corner.chamfer) {
      const auto from = at_distance(side_a, at, size, -1), to = at_distance(side_b, at, size, 1);
      return from && to ? std::optional(Rounding{*from, *to, Vec2::Zero()}) : std::nullopt;
    }
    if (std::abs(turn) >= kPi - kTangentRad) return std::nullopt;
    return rounding_at(side_a, side_b, at, size, turn > 0);
  };
  const auto fits = [&](const std::optional<Rounding>& r, double tolerance_mm) {
    return r && r->before.length <= side_a.length + tolerance_mm && r->behind.length <= side_b.length + tolerance_mm;
  };
  std::optional<Rounding> cut = cut_of(corner.size_mm);
  const bool shrunk = corner.may_shrink && !fits(cut, kTooShortMm);
  if (shrunk) {
    double low = 0, high = corner.size_mm;
    for (int i = 0; i < 60; ++i) {
      const double size = 0.5 * (low + high);
      (fits(cut_of(size), 0) ? low : high) = size;
    }
    cut = cut_of(low);
  }
  if (!cut) return fail(fmt::format("{} does not fit into the corner with the next block", corner.text));
  const auto too_long = [&](const Cut& c, const Side& side, const char* which) {
    if (c.length <= side.length + kTooShortMm) return std::string();
    return fmt::format("{} takes {:.4f} mm off the {} move, which is {:.4f} mm long; a longer move was expected",
                       corner.text, c.length, which, side.length);
  };
  for (const std::string& error : {too_long(cut->before, side_a, "first"), too_long(cut->behind, side_b, "second")})
    if (!error.empty()) return fail(error);

  const auto placed = [&](const Vec2& p) {
    Vec3 out = text_a.end_mm;
    out[axes.first] = p.x();
    out[axes.second] = p.y();
    return frame.from_program(out);
  };
  const auto shorten = [&](const Move& m, const Cut& c, const Side& side) {
    if (m.arc != Move::kNoArc) program.arcs[m.arc].sweep_rad *= std::max(0.0, 1 - c.length / side.length);
  };
  shorten(a, cut->before, side_a);
  shorten(b, cut->behind, side_b);
  Move between = a;
  between.start_mm = a.end_mm = placed(cut->before.place);
  between.end_mm = b.start_mm = placed(cut->behind.place);
  between.kind = MoveKind::linear;
  between.arc = Move::kNoArc;
  between.feed_given = false;
  if (!corner.chamfer) {
    Arc arc;
    arc.center_mm = text_a.end_mm;
    arc.center_mm[axes.first] = cut->centre.x();
    arc.center_mm[axes.second] = cut->centre.y();
    arc.normal = normal_of(corner.plane);
    const double sense = turn > 0 ? 1 : -1;
    arc.sweep_rad = sense * turn_from(cut->before.place - cut->centre, cut->behind.place - cut->centre, sense);
    const auto in_moves = from_program(frame, arc);
    if (!in_moves)
      return fail(
          fmt::format("{} under a scale that differs along its two axes would be an ellipse; one scale for "
                      "both was expected",
                      corner.text));
    program.arcs.push_back(*in_moves);
    between.kind = MoveKind::arc;
    between.arc = static_cast<std::uint32_t>(program.arcs.size() - 1);
  }
  return {.error = {}, .between = between, .shrunk = shrunk};
}

}  // namespace camber::nc
