#include "compensate/shift_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace camber::compensate {

namespace {

constexpr double kFullTurn = 1e-6;  // rad

bool is_full_turn(const nc::Arc& arc) { return std::abs(std::abs(arc.sweep_rad) - 2 * kPi) < kFullTurn; }

constexpr int kPiecesOfFullTurn = 3;

/// Pieces of a move that is not split: of an arc as many as it takes to tell its radius.
int pieces_of_whole(const nc::Interpretation& program, const nc::Move& move) {
  if (move.kind != nc::MoveKind::arc) return 1;
  return is_full_turn(program.arcs[move.arc]) ? kPiecesOfFullTurn : 2;
}

int pieces_of(double length_mm, double spacing_mm, double shortest_mm) {
  const int wanted = std::max(1, static_cast<int>(std::ceil(length_mm / spacing_mm - 1e-9)));
  if (shortest_mm <= 0) return wanted;
  return std::max(1, static_cast<int>(std::min<double>(wanted, std::floor(length_mm / shortest_mm + 1e-9))));
}

/// Along Z alone, in the text as well.
bool is_plunge(const nc::Interpretation& program, const nc::Move& move) {
  constexpr double kSamePlaceMm = 1e-9;
  const Vec3 way = move.end_mm - move.start_mm;
  return move.kind == nc::MoveKind::linear && program.frame_of(move).shift_only &&
         std::hypot(way.x(), way.y()) < kSamePlaceMm;
}

}  // namespace

ShiftPath::ShiftPath(const nc::Interpretation& program, const std::vector<bool>& selected, double spacing_mm,
                     double block_time_s, const std::vector<bool>& whole)
    : program_(&program), first_of_move_(program.moves.size(), kNone) {
  bool open = false;
  for (std::uint32_t m = 0; m < program.moves.size(); ++m) {
    const nc::Move& move = program.moves[m];
    const double length = selected[m] ? nc::length_mm(program, move) : 0;
    if (!selected[m] || length <= 0) {
      // A move that goes nowhere does not break a chain; one that is not ours does.
      if (!selected[m] && nc::length_mm(program, move) > 0) open = false;
      continue;
    }
    if (!open) {
      chains_.push_back({points_.size(), 1});
      points_.push_back({.move = m, .fraction = 0, .along_mm = 0, .place_mm = move.start_mm, .fixed = true});
      open = true;
    }
    first_of_move_[m] = points_.size() - 1;
    if (!move.editable) points_.back().fixed = true;
    const double along = points_.back().along_mm;
    const bool several_turns = move.kind == nc::MoveKind::arc && std::abs(program.arcs[move.arc].sweep_rad) > 6.4;
    const bool is_whole = std::isinf(spacing_mm) || (!whole.empty() && whole[m]);
    const int pieces = several_turns ? 1
                       : is_whole    ? pieces_of_whole(program, move)
                                     : pieces_of(length, spacing_mm, move.feed_mm_per_s * block_time_s);
    const bool plunge = is_plunge(program, move);
    for (int i = 1; i <= pieces; ++i) {
      const double u = static_cast<double>(i) / pieces;
      points_.push_back({.move = m,
                         .fraction = u,
                         .along_mm = along + u * length,
                         .place_mm = nc::point_at(program, move, u),
                         .fixed = !move.editable,
                         .plunge = plunge && move.editable});
      ++chains_.back().count;
    }
  }
}

ShiftPath::PointInterval ShiftPath::find(std::uint32_t move, double fraction) const {
  assert(contains(move));
  std::size_t i = first_of_move_[move];
  double from = 0;
  while (i + 2 < points_.size() && points_[i + 1].move == move && points_[i + 1].fraction < fraction) {
    ++i;
    from = points_[i].fraction;
  }
  const double to = points_[i + 1].fraction;
  return {i, std::clamp((fraction - from) / (to - from), 0.0, 1.0)};
}

Vec3 ShiftPath::shift_at(const PointInterval& place) const {
  return (1 - place.upper_fraction) * points_[place.lower].shift_mm +
         place.upper_fraction * points_[place.lower + 1].shift_mm;
}

std::vector<Vec3> ShiftPath::shifts() const {
  std::vector<Vec3> out;
  out.reserve(points_.size());
  for (const auto& p : points_) out.push_back(p.shift_mm);
  return out;
}

void ShiftPath::set_shifts(std::span<const Vec3> shifts) {
  assert(shifts.size() == points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) points_[i].shift_mm = shifts[i];
}

void ShiftPath::keep_plunges() {
  for (const ShiftChain& chain : chains_)
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i)
      if (points_[i].plunge) points_[i].shift_mm.head<2>() = points_[i - 1].shift_mm.head<2>();
}

namespace {

/// Returns the indices of `path` that must stay so that no other point strays from the polyline (Douglas-Peucker).
void keep_strays(const std::vector<Vec3>& path, std::size_t a, std::size_t b, double tolerance,
                 std::vector<std::size_t>& kept) {
  double worst = tolerance;
  std::size_t at = 0;
  const Vec3 chord = path[b] - path[a];
  for (std::size_t i = a + 1; i < b; ++i) {
    const double u = std::clamp((path[i] - path[a]).dot(chord) / std::max(chord.squaredNorm(), 1e-18), 0.0, 1.0);
    const double stray = (path[i] - path[a] - u * chord).norm();
    if (stray <= worst) continue;
    worst = stray;
    at = i;
  }
  if (at == 0) return;
  keep_strays(path, a, at, tolerance, kept);
  kept.push_back(at);
  keep_strays(path, at, b, tolerance, kept);
}

/// Centre of the arc from a to b that lies nearest to the wished one: its projection on the plane halfway.
Vec3 agreeing_centre(const nc::Arc& arc, const Vec3& start, const Vec3& end, const Vec3& wished) {
  Vec3 across = end - start;
  across -= across.dot(arc.normal) * arc.normal;
  if (across.norm() < 1e-9) return wished;
  across.normalize();
  const Vec3 middle = 0.5 * (start + end);
  return wished - (wished - middle).dot(across) * across;
}

}  // namespace

namespace {

constexpr double kNearHalfTurn = 0.35;  // rad; beyond it a last decimal of R is under six of the centre's
constexpr double kMaxSweep = 5.5;       // rad, of one piece of an arc that is not shifted evenly

/// Centre of the circle through three points in the plane across `normal`; nothing where they lie on a line.
std::optional<Vec3> circle_centre(const Vec3& normal, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto flat = [&](const Vec3& v) { return Vec3(v - v.dot(normal) * normal); };
  const Vec3 ab = flat(b - a), ac = flat(c - a);
  const Vec3 across = ab.cross(ac);
  const double twice = 2 * across.squaredNorm();
  if (twice < 1e-18) return std::nullopt;
  return a + (ab.squaredNorm() * ac.cross(across) + ac.squaredNorm() * across.cross(ab)) / twice;
}

bool all_on_circle(const nc::Arc& arc, const std::vector<Vec3>& points, std::size_t a, std::size_t b,
                   const Vec3& centre, double tolerance_mm) {
  const auto flat = [&](const Vec3& v) { return Vec3(v - v.dot(arc.normal) * arc.normal); };
  const double radius = flat(points[a] - centre).norm(), sense = arc.sweep_rad > 0 ? 1 : -1;
  double before = 0;
  for (std::size_t i = a; i <= b; ++i) {
    const Vec3 from = flat(points[a] - centre), to = flat(points[i] - centre);
    if (std::abs(to.norm() - radius) > tolerance_mm) return false;
    double turned = sense * std::atan2(from.cross(to).dot(arc.normal), from.dot(to));
    while (turned < before - kPi) turned += 2 * kPi;
    if (i > a && turned <= before) return false;
    before = turned;
    const double fraction = static_cast<double>(i - a) / static_cast<double>(b - a);
    const double level = (points[a] + fraction * (points[b] - points[a]) - points[i]).dot(arc.normal);
    if (std::abs(level) > tolerance_mm) return false;
  }
  return true;
}

/// Centre of the circle that all points of a full turn lie on within the tolerance, the last as near to the first;
/// nothing where there is none. The arc ends where it starts.
std::optional<Vec3> full_turn_centre(const nc::Arc& arc, std::vector<Vec3> points, double tolerance_mm) {
  const std::size_t end = points.size() - 1;
  Vec3 gap = points[end] - points[0];
  gap -= gap.dot(arc.normal) * arc.normal;
  const bool whole_alone = end == static_cast<std::size_t>(kPiecesOfFullTurn);  // no points to split it at
  if (end < 3 || (!whole_alone && gap.norm() > tolerance_mm)) return std::nullopt;
  const auto centre = circle_centre(arc.normal, points[0], points[end / 3], points[2 * end / 3]);
  points.pop_back();
  if (!centre || !all_on_circle(arc, points, 0, end - 1, *centre, tolerance_mm)) return std::nullopt;
  return centre;
}

/// Centre of an arc from points[a] to points[b] that passes those between within the tolerance, also along the normal,
/// in the sense of `arc`; nothing where there is none. Two neighbours always have one.
std::optional<Vec3> piece_centre(const nc::Arc& arc, const std::vector<Vec3>& points, std::size_t a, std::size_t b,
                                 const Vec3& wished, double tolerance_mm) {
  // Full turns close on themselves, however their ends are shifted; the line between them says nothing of the centre.
  const bool closes = a == 0 && b + 1 == points.size() && std::abs(std::remainder(arc.sweep_rad, 2 * kPi)) < kFullTurn;
  if (closes) return wished;
  if (b == a + 1) return agreeing_centre(arc, points[a], points[b], wished);
  const auto centre = circle_centre(arc.normal, points[a], points[(a + b) / 2], points[b]);
  if (!centre || !all_on_circle(arc, points, a, b, *centre, tolerance_mm)) return std::nullopt;
  return centre;
}

}  // namespace

void ShiftPath::edit_arc(std::size_t first, std::size_t last, double tolerance_mm, nc::MoveEdit& edit) const {
  const nc::Arc& arc = program_->arcs[program_->moves[edit.move].arc];
  std::vector<Vec3> shifted;
  for (std::size_t i = first; i <= last; ++i) shifted.push_back(points_[i].place_mm + points_[i].shift_mm);
  const double step_rad = std::abs(arc.sweep_rad) / static_cast<double>(last - first);
  const std::size_t most = std::max<std::size_t>(1, static_cast<std::size_t>(kMaxSweep / std::max(step_rad, 1e-9)));
  const auto piece = [&](std::size_t a, std::size_t b) {
    const Vec3 wished = arc.center_mm + 0.5 * (points_[first + a].shift_mm + points_[first + b].shift_mm);
    return piece_centre(arc, shifted, a, b, wished, tolerance_mm);
  };
  bool evenly = true;
  for (std::size_t i = first; i < last; ++i)
    evenly = evenly && (points_[i + 1].shift_mm - points_[i].shift_mm).norm() < 1e-9;
  const std::size_t end = shifted.size() - 1;
  // R tells the centre of half a turn only to a square root: a last decimal of R moves it by hundreds of them.
  const auto can_be_said = [&](std::size_t a, std::size_t b) {
    return !arc.by_radius || b == a + 1 || std::abs(static_cast<double>(b - a) * step_rad - kPi) >= kNearHalfTurn;
  };
  const auto centre_of = [&](std::size_t a, std::size_t b) -> std::optional<Vec3> {
    if (!can_be_said(a, b)) return std::nullopt;
    return evenly ? std::optional<Vec3>(arc.center_mm + points_[first].shift_mm) : piece(a, b);
  };
  if (!evenly && is_full_turn(arc))
    if (const auto centre = full_turn_centre(arc, shifted, tolerance_mm)) {
      edit.center_mm = *centre;
      return;
    }
  if (!can_be_said(0, end)) {
    const auto centre = evenly ? std::optional<Vec3>(arc.center_mm + points_[first].shift_mm) : piece(0, end);
    if (centre) {  // two pieces of one circle
      edit.via.push_back({shifted[end / 2], *centre});
      edit.center_mm = *centre;
      return;
    }
  }
  for (std::size_t a = 0; a < end;) {
    std::size_t b = evenly ? end : std::min(a + most, end);
    std::optional<Vec3> centre;
    while (!(centre = centre_of(a, b))) --b;
    if (b == end) {
      edit.center_mm = *centre;
    } else {
      edit.via.push_back({shifted[b], *centre});
    }
    a = b;
  }
}

nc::MoveEdit ShiftPath::edit_of(std::size_t first, std::size_t last, const std::vector<bool>& kept,
                                double tolerance_mm) const {
  const ControlPoint& end = points_[last];
  nc::MoveEdit edit;
  edit.move = end.move;
  edit.end_mm = end.place_mm + end.shift_mm;
  const nc::Move& move = program_->moves[end.move];
  if (move.kind == nc::MoveKind::arc) {
    edit_arc(first, last, tolerance_mm, edit);
    return edit;
  }
  for (std::size_t i = first + 1; i < last; ++i)
    if (kept[i]) edit.via.push_back({points_[i].place_mm + points_[i].shift_mm});
  return edit;
}

/// Arcs have one feed, that of their end; a line's pieces have their own.
void ShiftPath::set_feeds(std::size_t first, std::size_t last, const std::vector<bool>& kept,
                          nc::MoveEdit& edit) const {
  const nc::Move& move = program_->moves[edit.move];
  edit.feed_mm_per_s = points_[last].feed_fraction * move.feed_mm_per_s;
  if (move.kind == nc::MoveKind::arc) return;
  std::size_t via = 0;
  for (std::size_t i = first + 1; i < last; ++i)
    if (kept[i]) edit.via[via++].feed_mm_per_s = points_[i].feed_fraction * move.feed_mm_per_s;
}

namespace {
constexpr double kNothing_mm = 0.0002;  // a move whose shifts are all smaller is left as it is
}

std::vector<bool> ShiftPath::ends_of_moves() const {
  std::vector<bool> out(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i)
    out[i] = points_[i].fixed || points_[i].fraction >= 1 || points_[i].fraction <= 0 ||
             program_->moves[points_[i].move].kind == nc::MoveKind::arc;
  return out;
}

void ShiftPath::keep_feed_changes(std::vector<bool>& kept) const {
  for (const ShiftChain& chain : chains_)
    for (std::size_t i = chain.from + 1; i + 1 < chain.from + chain.count; ++i)
      if (points_[i].move == points_[i + 1].move && points_[i].feed_fraction != points_[i + 1].feed_fraction)
        kept[i] = true;
}

void ShiftPath::keep_strays(double tolerance_mm, std::vector<bool>& kept) const {
  for (const ShiftChain& chain : chains_) {
    std::size_t last = chain.from;
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i) {
      if (!kept[i]) continue;
      if (i > last + 1) {
        std::vector<Vec3> path;
        for (std::size_t k = last; k <= i; ++k) path.push_back(points_[k].place_mm + points_[k].shift_mm);
        std::vector<std::size_t> strays;
        compensate::keep_strays(path, 0, path.size() - 1, tolerance_mm, strays);
        for (const std::size_t k : strays) kept[last + k] = true;
      }
      last = i;
    }
  }
}

ShiftPath ShiftPath::thinned(const std::vector<bool>& kept) const {
  assert(std::ranges::equal(ends_of_moves(), kept, [](bool end, bool keep) { return keep || !end; }));
  ShiftPath out = *this;
  out.points_.clear();
  out.chains_.clear();
  std::vector<std::size_t> now(points_.size());
  for (const ShiftChain& chain : chains_) {
    ShiftChain thin{out.points_.size(), 0};
    for (std::size_t i = chain.from; i < chain.from + chain.count; ++i) {
      now[i] = out.points_.size();
      if (!kept[i]) continue;
      out.points_.push_back(points_[i]);
      ++thin.count;
    }
    out.chains_.push_back(thin);
  }
  for (std::size_t& first : out.first_of_move_)
    if (first != kNone) first = now[first];
  return out;
}

std::vector<nc::MoveEdit> ShiftPath::edits(double tolerance_mm) const {
  std::vector<bool> kept = ends_of_moves();
  keep_strays(tolerance_mm, kept);
  return edits(kept, tolerance_mm);
}

std::vector<nc::MoveEdit> ShiftPath::edits(const std::vector<bool>& kept, double tolerance_mm) const {
  std::vector<nc::MoveEdit> out;
  for (const ShiftChain& chain : chains_) {
    const std::size_t end = chain.from + chain.count;
    for (std::size_t first = chain.from; first + 1 < end;) {
      std::size_t last = first + 1;
      while (last + 1 < end && points_[last + 1].move == points_[first + 1].move) ++last;
      bool shifted = false, slowed = false;
      for (std::size_t i = first; i <= last; ++i) shifted = shifted || points_[i].shift_mm.norm() > kNothing_mm;
      for (std::size_t i = first + 1; i <= last; ++i) slowed = slowed || points_[i].feed_fraction != 1;
      if (shifted || slowed) out.push_back(edit_of(first, last, kept, tolerance_mm));
      if (slowed) set_feeds(first, last, kept, out.back());
      first = last;
    }
  }
  return out;
}

double ShiftPath::largest_shift_mm() const {
  double largest = 0;
  for (const auto& p : points_) largest = std::max(largest, p.shift_mm.norm());
  return largest;
}

std::size_t ShiftPath::cut_to(double max_shift_mm) {
  std::size_t limited = 0;
  for (auto& p : points_) {
    const double shift = p.shift_mm.norm();
    if (shift <= max_shift_mm) continue;
    p.shift_mm *= max_shift_mm / shift;
    ++limited;
  }
  keep_plunges();
  return limited;
}

}  // namespace camber::compensate
