// Words with a comma at the end of a block: ,R rounds and ,C chamfers its corner with the next one, ,A gives its angle.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/block_interpreter.h"
#include "nc/plane_curves.h"

namespace camber::nc {
namespace {

constexpr double kTangentRad = 1e-6;   ///< blocks that turn by less have no corner
constexpr double kTooShortMm = 0.002;  ///< programs with three decimals make moves that are short by so much
constexpr double kStillMm = 1e-9;

/// One of the two moves at a corner, in the plane. Times run from the corner: 0 there, length() at the other end.
struct Side {
  PlaneCurve curve;
  double sense = 1;  ///< of a circle: 1 counter-clockwise
  double length = 0;
  Vec2 direction = Vec2::Zero();  ///< of the motion at the corner, unit
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

void BlockInterpreter::corner_error(std::size_t offset, std::string message) {
  error(offset, "corner-word", std::move(message));
}

/// ,A: the end on a line of that angle, where the block names one coordinate of the plane.
Vec3 BlockInterpreter::target_at_angle(const Vec3& start, Vec3 end) {
  const auto& words = words_.corner_words();
  const auto word = std::ranges::find(words, 'a', &Word::letter);
  if (word == words.end() || motion_ != Motion::linear || frame_.polar) return end;
  const PlaneAxes axes = axes_of(plane_);
  constexpr char kAxisLetters[] = "XYZ";
  const bool first = words_.has(kAxisLetters[axes.first]), second = words_.has(kAxisLetters[axes.second]);
  if (first == second) {
    corner_error((*word)->offset,
                 fmt::format(",A in a block with {} of {} and {}; one of them was expected", first ? "both" : "none",
                             kAxisLetters[axes.first], kAxisLetters[axes.second]));
    return end;
  }
  const double angle = rad_from_deg((*word)->value * whole_number_scale_of(**word));
  const double across = first ? std::cos(angle) : std::sin(angle), along = first ? std::sin(angle) : std::cos(angle);
  const int given = first ? axes.first : axes.second, open = first ? axes.second : axes.first;
  if (std::abs(across) < 1e-6) {
    corner_error((*word)->offset,
                 fmt::format("a line at {} degrees does not lead to another {}", (*word)->value, kAxisLetters[given]));
    return end;
  }
  end[open] = start[open] + (end[given] - start[given]) * along / across;
  editable_ = false;
  return end;
}

/// What the words of the block ask for, once it has moved.
void BlockInterpreter::read_corner_words(std::size_t moves_before) {
  for (const Word* word : words_.corner_words()) {
    const std::string text = program_->source.text().substr(word->offset, word->length);
    if (!options_.dialect_or_default().corner_words) {
      corner_error(word->offset, fmt::format("{} is no word of a {} program; a letter and a number were expected", text,
                                             options_.dialect_or_default().title));
      continue;
    }
    const bool moved = out_.moves.size() > moves_before && !out_.moves.back().canned &&
                       (out_.moves.back().kind == MoveKind::linear || out_.moves.back().kind == MoveKind::arc);
    if (!moved) {
      if (!request_.trouble)
        corner_error(word->offset, fmt::format("{} in a block without a cut; G1, G2 or G3 was expected", text));
      continue;
    }
    if (word->letter == 'a') continue;
    if (corner_.waits) {
      corner_error(word->offset, fmt::format("{} and {} in one block; one of them was expected", corner_.text, text));
      continue;
    }
    if (word->value < 0) {
      corner_error(word->offset, fmt::format("{} is negative; zero or more was expected", text));
      continue;
    }
    corner_ = {true,
               word->letter == 'c',
               word->value * unit_mm() * whole_number_scale_of(*word),
               out_.moves.size() - 1,
               word->offset,
               text};
  }
}

/// The corner that waits lies before the first move that the block has made.
void BlockInterpreter::finish_corner(std::size_t moves_before) {
  if (!corner_.waits) return;
  std::size_t next = moves_before;
  while (next < out_.moves.size() && out_.moves[next].kind == MoveKind::dwell) ++next;
  if (next == out_.moves.size()) return;
  const Corner corner = std::exchange(corner_, {});
  if (corner.move >= moves_before) return;
  put_corner(corner, corner.move, next);
}

/// Cuts both moves short and puts a line or an arc between them.
void BlockInterpreter::put_corner(const Corner& corner, std::size_t before, std::size_t after) {
  const auto fail = [&](std::string message) { corner_error(corner.offset, std::move(message)); };
  Move &a = out_.moves[before], &b = out_.moves[after];
  a.editable = b.editable = false;
  if ((b.kind != MoveKind::linear && b.kind != MoveKind::arc) || b.canned || b.reference || leaving_ ||
      !std::ranges::all_of(out_.rotary, [&](const RotaryTarget& t) { return t.move < before; }))
    return fail(fmt::format(
        "{} is not followed by a line or an arc of its kind; G1, G2 or G3 in the plane was expected", corner.text));
  if (state_.feed_mode == FeedMode::inverse_time)
    return fail(fmt::format("{} in inverse time (G93) is not supported", corner.text));
  const PlaneAxes axes = axes_of(plane_);
  const Frame frame = out_.frame_of(a);
  if (!(out_.frame_of(b) == frame) || out_.state_of(a).plane_g != out_.state_of(b).plane_g)
    return fail(fmt::format("{} before a block in another plane or frame; the same was expected", corner.text));
  const TextMove text_a = in_text(out_, a), text_b = in_text(out_, b);
  const auto leaves_plane = [&](const TextMove& m) {
    return std::abs(m.end_mm[axes.normal] - m.start_mm[axes.normal]) > kStillMm;
  };
  if (leaves_plane(text_a) || leaves_plane(text_b))
    return fail(fmt::format("{} beside a move that leaves the plane G{}; two moves in it were expected", corner.text,
                            state_.plane_g));
  const Side side_a = side_of(text_a, axes, true), side_b = side_of(text_b, axes, false);
  if (side_a.length <= kStillMm || side_b.length <= kStillMm)
    return fail(fmt::format("{} beside a move without length; two moves in the plane were expected", corner.text));
  const Vec2 at(text_a.end_mm[axes.first], text_a.end_mm[axes.second]);
  const double turn = angle_between(side_a.direction, side_b.direction);
  if (corner.size_mm == 0 || std::abs(turn) < kTangentRad) return;  // nothing to round

  std::optional<Rounding> cut;
  if (corner.chamfer) {
    const auto from = at_distance(side_a, at, corner.size_mm, -1), to = at_distance(side_b, at, corner.size_mm, 1);
    if (from && to) cut = Rounding{*from, *to, Vec2::Zero()};
  } else if (std::abs(turn) < kPi - kTangentRad) {
    cut = rounding_at(side_a, side_b, at, corner.size_mm, turn > 0);
  }
  if (!cut) return fail(fmt::format("{} does not fit into the corner with the next block", corner.text));
  const auto too_long = [&](const Cut& c, const Side& side, const char* which) {
    if (c.length <= side.length + kTooShortMm) return false;
    fail(fmt::format("{} takes {:.4f} mm off the {} move, which is {:.4f} mm long; a longer move was expected",
                     corner.text, c.length, which, side.length));
    return true;
  };
  if (too_long(cut->before, side_a, "first") || too_long(cut->behind, side_b, "second")) return;

  const auto placed = [&](const Vec2& p) {
    Vec3 out = text_a.end_mm;
    out[axes.first] = p.x();
    out[axes.second] = p.y();
    return frame.from_program(out);
  };
  const auto shorten = [&](const Move& m, const Cut& c, const Side& side) {
    if (m.arc != Move::kNoArc) out_.arcs[m.arc].sweep_rad *= std::max(0.0, 1 - c.length / side.length);
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
    arc.normal = normal_of(plane_);
    const double sense = turn > 0 ? 1 : -1;
    arc.sweep_rad = sense * turn_from(cut->before.place - cut->centre, cut->behind.place - cut->centre, sense);
    const auto in_moves = from_program(frame, arc);
    if (!in_moves)
      return fail(
          fmt::format("{} under a scale that differs along its two axes would be an ellipse; one scale for "
                      "both was expected",
                      corner.text));
    out_.arcs.push_back(*in_moves);
    between.kind = MoveKind::arc;
    between.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
  }
  out_.moves.insert(out_.moves.begin() + static_cast<std::ptrdiff_t>(after), between);
  for (auto e = out_.events.rbegin(); e != out_.events.rend() && e->before_move >= after; ++e) ++e->before_move;
  if (radius_.active && radius_.first_move >= after) ++radius_.first_move;
}

}  // namespace camber::nc
