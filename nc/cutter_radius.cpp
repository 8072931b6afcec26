#include "nc/cutter_radius.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "nc/plane_curves.h"

namespace camber::nc {
namespace {

constexpr double kSamePlaceMm = 1e-6;
constexpr double kTangentRad = 1e-4;   ///< corners that turn by less are none
constexpr double kTooShortMm = 0.002;  ///< programs with three decimals make lines that are short by so much
constexpr double kSpiralMm = 0.05;     ///< radii that differ by more make a spiral, as with kArcRadiusErrorMm

/// A programmed line or arc in the plane and its offset.
struct Element {
  std::size_t move = 0;
  bool arc = false;
  Vec2 start, end, centre = Vec2::Zero();
  double sense = 1;                         ///< arcs: 1 counter-clockwise
  double sweep = 0;                         ///< arcs: without sign
  Vec2 start_direction, end_direction;      ///< unit
  Vec2 offset_start, offset_end;            ///< beside start and end
  double start_radius = 0, end_radius = 0;  ///< arcs: of the offset
  double trim_start = 0, trim_end = 0;      ///< lengths that the corners take off (negative: add)
  Vec2 path_start, path_end;                ///< ends of the offset path, corners applied

  double radius() const { return 0.5 * (start_radius + end_radius); }
  double length() const { return arc ? radius() * sweep : (end - start).norm(); }
};

struct Piece {
  Vec2 end;
  bool arc = false;
  Vec2 centre = Vec2::Zero();
  double sweep = 0;  ///< signed sweep
};

class RadiusCompensation {
 public:
  RadiusCompensation(Interpretation& program, std::size_t first, const CutterRadius& cutter)
      : program_(program), first_(first), cutter_(cutter), axes_(axes_of(cutter.plane)) {
    offset_ = cutter.left ? cutter.radius_mm : -cutter.radius_mm;
  }

  CutterRadiusResult run() {
    collect();
    if (result_.problems.empty()) check_entry();
    if (result_.problems.empty()) make_corners();
    if (result_.problems.empty()) check_lengths();
    if (result_.problems.empty())
      write();
    else
      result_.end_mm = program_.moves.empty() ? Vec3(Vec3::Zero()) : program_.moves.back().end_mm;
    return std::move(result_);
  }

 private:
  Vec2 in_plane(const Vec3& p) const { return {p[axes_.first], p[axes_.second]}; }

  void problem(std::size_t move, std::string message) {
    result_.problems.push_back(
        {program_.moves[move].block,
         fmt::format("{} with a cutter radius of {:.4f} mm: {}", cutter_.name, std::abs(cutter_.radius_mm), message)});
  }

  // --- the programmed contour
  // -----------------------------------------------------------------------------------------

  void collect() {
    int without = 0;
    for (std::size_t m = first_; m < program_.moves.size(); ++m) {
      const Move& move = program_.moves[m];
      const bool flat =
          move.arc == Move::kNoArc && (in_plane(move.end_mm) - in_plane(move.start_mm)).norm() < kSamePlaceMm;
      if (move.kind == MoveKind::dwell || flat) {
        ++without;
        continue;
      }
      if (!elements_.empty() && without > cutter_.moves_without_plane_motion)
        problem(m, fmt::format("{} moves without motion in the plane stand before this one; the control looks {} ahead "
                               "and would gouge, at most {} was expected",
                               without, cutter_.moves_without_plane_motion, cutter_.moves_without_plane_motion));
      without = 0;
      if (move.arc == Move::kNoArc)
        add_line(m);
      else
        add_arc(m);
    }
  }

  void add_line(std::size_t m) {
    Element e;
    e.move = m;
    e.start = in_plane(program_.moves[m].start_mm);
    e.end = in_plane(program_.moves[m].end_mm);
    e.start_direction = e.end_direction = (e.end - e.start).normalized();
    e.offset_start = e.start + offset_ * left_of(e.start_direction);
    e.offset_end = e.end + offset_ * left_of(e.end_direction);
    elements_.push_back(e);
  }

  void add_arc(std::size_t m) {
    const Move& move = program_.moves[m];
    const Arc& arc = program_.arcs[move.arc];
    Element e;
    e.move = m;
    e.arc = true;
    e.start = in_plane(move.start_mm);
    e.end = in_plane(move.end_mm);
    e.centre = in_plane(arc.center_mm);
    e.sense = arc.sweep_rad * arc.normal[axes_.normal] < 0 ? -1 : 1;
    e.sweep = std::abs(arc.sweep_rad);
    const double start_radius = (e.start - e.centre).norm(), end_radius = (e.end - e.centre).norm();
    e.start_direction = e.sense * left_of(e.start - e.centre) / start_radius;
    e.end_direction = e.sense * left_of(e.end - e.centre) / end_radius;
    // Left of a counter-clockwise arc is its centre.
    e.start_radius = start_radius - e.sense * offset_;
    e.end_radius = end_radius - e.sense * offset_;
    e.offset_start = e.centre + e.start_radius * (e.start - e.centre) / start_radius;
    e.offset_end = e.centre + e.end_radius * (e.end - e.centre) / end_radius;
    if (std::abs(start_radius - end_radius) > kSpiralMm)
      problem(m, "a spiral has no offset of the same kind; an arc or a line was expected");
    else if (std::min(e.start_radius, e.end_radius) < kSamePlaceMm)
      problem(m, fmt::format("the cutter does not fit into the arc of radius {:.4f} mm; a larger arc or a smaller "
                             "cutter was expected",
                             0.5 * (start_radius + end_radius)));
    elements_.push_back(e);
  }

  void check_entry() {
    if (elements_.empty()) return;
    const Element& entry = elements_.front();
    if (entry.arc)
      problem(entry.move, "compensation begins on an arc; a straight entry move (G0, G1) was expected");
    else if (entry.length() <= std::abs(cutter_.radius_mm) && !(cutter_.entry_square_to_next && !cutter_.corner_lines))
      problem(entry.move,
              fmt::format("the entry move is {:.4f} mm long; more than the radius was expected", entry.length()));
  }

  // --- corners
  // ----------------------------------------------------------------------------------------------------------

  void make_corners() {
    corners_.resize(elements_.size());
    for (Element& e : elements_) {
      e.path_start = e.offset_start;
      e.path_end = e.offset_end;
    }
    if (elements_.empty()) return;
    elements_.front().path_start = elements_.front().start;
    for (std::size_t i = 0; i + 1 < elements_.size(); ++i) {
      Element &before = elements_[i], &after = elements_[i + 1];
      if (i == 0 && cutter_.entry_square_to_next) {
        before.path_end = after.offset_start;
        continue;
      }
      const double turn = angle_between(before.end_direction, after.start_direction);
      const double inside = offset_ > 0 ? turn : -turn;
      if (std::abs(turn) < kTangentRad)
        before.path_end = after.path_start = 0.5 * (before.offset_end + after.offset_start);
      else if (inside > 0 && inside < kPi - kTangentRad)
        cut_inside(before, after);
      else if (cutter_.corner_lines)
        lines_outside(i, before, after, std::abs(turn));
      else
        arc_outside(i, before, after, turn);
    }
  }

  /// The offsets end where they meet.
  void cut_inside(Element& before, Element& after) {
    std::optional<Vec2> best;
    double best_cost = 0, best_before = 0, best_after = 0;
    for (const Vec2& x : meetings(curve_at_end(before), curve_at_start(after))) {
      const double t_before = back_to(before, x), t_after = forward_to(after, x);
      if (t_before < -kTooShortMm || t_after < -kTooShortMm) continue;
      const double cost = t_before + t_after;
      if (best && cost >= best_cost) continue;
      best = x;
      best_cost = cost;
      best_before = t_before;
      best_after = t_after;
    }
    if (!best) {
      problem(after.move,
              "the inside corner before this move cannot be cut, the offset paths do not meet; a longer move or "
              "a smaller cutter was expected");
      return;
    }
    before.path_end = after.path_start = *best;
    before.trim_end = best_before;
    after.trim_start = best_after;
  }

  /// Length along the offset from x on to its end.
  static double back_to(const Element& e, const Vec2& x) {
    if (!e.arc) return (e.offset_end - x).dot(e.end_direction);
    return e.end_radius * turn_from(x - e.centre, e.offset_end - e.centre, e.sense);
  }
  /// Length along the offset from its start to x.
  static double forward_to(const Element& e, const Vec2& x) {
    if (!e.arc) return (x - e.offset_start).dot(e.start_direction);
    return e.start_radius * turn_from(e.offset_start - e.centre, x - e.centre, e.sense);
  }
  static PlaneCurve curve_at_end(const Element& e) {
    return {e.arc, e.offset_end, e.end_direction, e.centre, e.end_radius};
  }
  static PlaneCurve curve_at_start(const Element& e) {
    return {e.arc, e.offset_start, e.start_direction, e.centre, e.start_radius};
  }

  void arc_outside(std::size_t i, const Element& before, const Element& after, double turn) {
    // The path turns away from the tool's side; half a turn back goes round the end.
    if (offset_ > 0 && turn > 0) turn -= 2 * kPi;
    if (offset_ < 0 && turn < 0) turn += 2 * kPi;
    corners_[i].push_back({after.offset_start, true, before.end, turn});
  }

  void lines_outside(std::size_t i, Element& before, Element& after, double turn) {
    const double radius = std::abs(offset_);
    const bool meet = turn <= kPi / 2 + 1e-9;
    const double out = meet ? radius * std::tan(turn / 2) : radius;
    const Vec2 first = before.offset_end + out * before.end_direction;
    const Vec2 second = meet ? first : Vec2(after.offset_start - out * after.start_direction);
    auto& pieces = corners_[i];
    if (before.arc)
      pieces.push_back({first});
    else
      before.path_end = first;
    if (!meet) pieces.push_back({second});
    if (after.arc)
      pieces.push_back({after.offset_start});
    else
      after.path_start = second;
  }

  void check_lengths() {
    for (const Element& e : elements_) {
      const double needed = e.trim_start + e.trim_end;
      if (needed > e.length() + kTooShortMm)
        problem(e.move,
                fmt::format("the cutter gouges at the inside corners of this move: they take {:.4f} mm off its offset, "
                            "which is {:.4f} mm long; a longer move or a smaller cutter was expected",
                            needed, e.length()));
    }
  }

  // --- the cutter's path
  // ------------------------------------------------------------------------------------------------

  void write() {
    const std::vector<Move> old(program_.moves.begin() + static_cast<std::ptrdiff_t>(first_), program_.moves.end());
    program_.moves.resize(first_);
    if (!old.empty()) at_ = old.front().start_mm;
    std::size_t next = 0;
    for (std::size_t m = 0; m < old.size(); ++m) {
      if (next == elements_.size() || elements_[next].move != first_ + m) {
        push(old[m], in_plane(at_), old[m].end_mm[axes_.normal]);
        continue;
      }
      if (next > 0)
        for (const Piece& piece : corners_[next - 1]) push_piece(old[m], piece);
      push_element(old[m], elements_[next]);
      ++next;
    }
    result_.end_mm = at_;
  }

  Move& push(const Move& like, const Vec2& end, double height) {
    Move move = like;
    move.start_mm = at_;
    at_[axes_.first] = end.x();
    at_[axes_.second] = end.y();
    at_[axes_.normal] = height;
    move.end_mm = at_;
    if (!elements_.empty()) move.editable = false;
    program_.moves.push_back(move);
    return program_.moves.back();
  }

  void push_piece(const Move& before, const Piece& piece) {
    if ((piece.end - in_plane(at_)).norm() < kSamePlaceMm) return;
    Move like = before;
    like.exact_stop = false;
    like.arc = Move::kNoArc;
    const bool arc = piece.arc && like.feed_mm_per_s > 0;
    like.kind = arc ? MoveKind::arc : like.kind == MoveKind::rapid ? MoveKind::rapid : MoveKind::linear;
    const Vec3 start = at_;
    Move& move = push(like, piece.end, at_[axes_.normal]);
    if (!arc) return;
    Arc corner;
    corner.center_mm = start;
    corner.center_mm[axes_.first] = piece.centre.x();
    corner.center_mm[axes_.second] = piece.centre.y();
    corner.normal = normal_of(cutter_.plane);
    corner.sweep_rad = piece.sweep;
    program_.arcs.push_back(corner);
    move.arc = static_cast<std::uint32_t>(program_.arcs.size() - 1);
  }

  void push_element(const Move& old, const Element& e) {
    push(old, e.path_end, old.end_mm[axes_.normal]);
    if (!e.arc) return;
    Arc& arc = program_.arcs[old.arc];
    const double taken_rad = e.trim_start / e.start_radius + e.trim_end / e.end_radius;
    const double sign = arc.sweep_rad < 0 ? -1 : 1;
    arc.sweep_rad = sign * std::max(0.0, e.sweep - taken_rad);
  }

  Interpretation& program_;
  std::size_t first_;
  const CutterRadius& cutter_;
  PlaneAxes axes_;
  double offset_ = 0;  ///< to the left of the path, mm
  std::vector<Element> elements_;
  std::vector<std::vector<Piece>> corners_;  ///< between element i and the next
  CutterRadiusResult result_;
  Vec3 at_ = Vec3::Zero();
};

}  // namespace

CutterRadiusResult compensate_radius(Interpretation& program, std::size_t first, const CutterRadius& cutter) {
  return RadiusCompensation(program, first, cutter).run();
}

}  // namespace camber::nc
