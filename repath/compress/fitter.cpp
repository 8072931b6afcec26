// One line, one arc: the pencil of arcs through two points.
#include <algorithm>
#include <array>
#include <cmath>

#include "repath/compress/fit.h"

namespace camber::repath {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRoundingMm = 1e-9;  ///< of sums of increments

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Centres on the perpendicular bisector of a chord: middle + t * across, radius sqrt(half^2 + t^2).
struct Pencil {
  Vec2 middle, across;  ///< across: unit, to the side that a short arc has its centre on
  double half = 0;
  double lowest = -kInfinity, highest = kInfinity;  ///< of t

  Vec2 center(double t) const { return middle + t * across; }

  /// | |p - c(t)| - r(t) | <= tolerance. With q = |p - m|^2 - half^2 - tolerance^2 and d = (p - m) . across both sides
  /// of it become |q - 2 t d| <= 2 tolerance sqrt(half^2 + t^2): for d beyond the tolerance t lies between the roots of
  /// 4 (d^2 - tol^2) t^2 - 4 q d t + q^2 - 4 tol^2 half^2. Points nearer to the chord say nothing.
  /// False where no t is left.
  bool admit(const Vec2& p, double tolerance) {
    const Vec2 v = p - middle;
    const double d = v.dot(across);
    if (d > tolerance) return false;  // the arc lies on the other side
    if (d > -1.0001 * tolerance) return true;
    const double q = v.squaredNorm() - half * half - tolerance * tolerance;
    const double a = d * d - tolerance * tolerance;
    const double root = tolerance * std::sqrt(q * q + 4 * half * half * a);
    lowest = std::max(lowest, (q * d - root) / (2 * a));
    highest = std::min(highest, (q * d + root) / (2 * a));
    return lowest <= highest;
  }
};

double sweep_of(double half, double t) { return 2 * std::atan2(half, t); }
double offset_of(double half, double sweep) { return half / std::tan(0.5 * sweep); }

}  // namespace

Fitter::Fitter(const Polyline& path, const FitOptions& options, FitMemory* memory)
    : path_(path), points_(path.points), options_(options), backwards_mm_(0.5 * options.tolerance_mm), memory_(memory) {
  (memory_ != nullptr ? *memory_ : own_memory_).forget();
  const auto points = points_;
  area_.resize(points.size());
  length_.resize(points.size());
  for (std::size_t k = 1; k < points.size(); ++k) {
    area_[k] = area_[k - 1] + cross(points[k - 1] - points[0], points[k] - points[0]);
    length_[k] = length_[k - 1] + (points[k] - points[k - 1]).norm();
  }
  level_.assign(path.heights.size(), 0);
  for (std::size_t k = 1; k < level_.size(); ++k)
    level_[k] = path.heights[k] == path.heights[k - 1] ? level_[k - 1] : static_cast<std::uint32_t>(k);
}

bool Fitter::flat(std::uint32_t first, std::uint32_t last) const { return level_.empty() || level_[last] <= first; }

/// Twice the area between the stretch and its chord; positive where it turns counter-clockwise.
double Fitter::area(std::uint32_t first, std::uint32_t last) const {
  return area_[last] - area_[first] - cross(points_[first] - points_[0], points_[last] - points_[0]);
}

std::optional<Primitive> Fitter::line(std::uint32_t first, std::uint32_t last) const {
  if (last == first + 1) return Primitive{.first = first, .last = last};
  const auto away = flat(first, last) ? line_deviation(points_, first, last, backwards_mm_)
                                      : line_deviation(points_, path_.heights, first, last, backwards_mm_);
  if (!away || *away > options_.tolerance_mm + kRoundingMm) return std::nullopt;
  return Primitive{.first = first, .last = last, .deviation_mm = *away};
}

namespace {

/// The wedge of directions from a place in a plane that pass every point within the tolerance.
class Wedge {
 public:
  explicit Wedge(double tolerance_mm) : tolerance_(tolerance_mm) {}

  bool holds(const Vec2& p) const {
    const double slack = -1e-12 * p.norm();
    return open_ || (cross(right_, p) >= slack && cross(p, left_) >= slack);
  }

  /// False where no direction is left.
  bool narrow(const Vec2& p) {
    const double distance = p.norm();
    if (distance <= tolerance_) return true;
    const double s = tolerance_ / distance, c = std::sqrt(1 - s * s);
    const Vec2 u = p / distance, turned(-u.y(), u.x());
    const Vec2 l = c * u + s * turned, r = c * u - s * turned;
    if (open_) {
      left_ = l, right_ = r, open_ = false;
      return true;
    }
    if (cross(left_, l) < 0) left_ = l;
    if (cross(right_, r) > 0) right_ = r;
    return cross(right_, left_) >= 0 && u.dot(left_) >= 0;
  }

 private:
  double tolerance_;
  Vec2 left_ = Vec2::Zero(), right_ = Vec2::Zero();  ///< unit borders
  bool open_ = true;                                 ///< no border yet
};

}  // namespace

/// The wedge narrows from point to point; a point in it is an end. In space a line that passes within the tolerance
/// does so in every projection: what lies in the wedges of all three planes may be an end.
std::vector<std::uint32_t> Fitter::line_ends(std::uint32_t first, std::uint32_t end, std::uint32_t max_ends) const {
  std::vector<std::uint32_t> ends{first + 1};
  const double tolerance = options_.tolerance_mm + kRoundingMm;
  const Vec3 start = path_.at(first);
  std::array<Wedge, 3> wedges{Wedge(tolerance), Wedge(tolerance), Wedge(tolerance)};
  const std::size_t planes = path_.heights.empty() ? 1 : 3;
  double farthest = 0;
  for (std::uint32_t k = first + 1; k <= end; ++k) {
    const Vec3 p = path_.at(k) - start;
    const double distance = p.norm();
    if (distance < farthest - backwards_mm_ - tolerance) break;
    farthest = std::max(farthest, distance);
    const std::array<Vec2, 3> seen{Vec2(p.x(), p.y()), Vec2(p.y(), p.z()), Vec2(p.z(), p.x())};
    bool inside = k > first + 1 && distance > 0, open = true;
    for (std::size_t i = 0; i < planes; ++i) {
      inside = inside && wedges[i].holds(seen[i]);
      open = wedges[i].narrow(seen[i]) && open;
    }
    if (inside) ends.push_back(k);
    if (!open) break;
  }
  // The next point stays: of the others a wedge is no proof, and there is always a line to it.
  if (ends.size() > max_ends + 1) ends.erase(ends.begin() + 1, ends.end() - max_ends);
  return ends;
}

std::optional<ArcRoom> Fitter::room(std::uint32_t first, std::uint32_t last) const {
  const Vec2 start = points_[first], end = points_[last], chord = end - start;
  const double length = chord.norm();
  if (length < options_.increment_mm * 0.5) return std::nullopt;
  const int direction = area(first, last) > 0 ? 1 : -1;
  Pencil pencil;
  pencil.middle = 0.5 * (start + end);
  pencil.across = direction * Vec2(-chord.y(), chord.x()) / length;
  pencil.half = 0.5 * length;
  const double tolerance = options_.tolerance_mm;
  // Those in the middle say most: they come first.
  const std::uint32_t count = last - first;
  for (const std::uint32_t k : {first + count / 2, first + count / 4, last - count / 4})
    if (!pencil.admit(points_[k], tolerance)) return std::nullopt;
  // Through the points: |v|^2 - half^2 = 2 t d, least squares.
  double upper = 0, lower = 0;
  for (std::uint32_t k = first; k < last; ++k) {
    const Vec2 v = points_[k] - pencil.middle;
    const double d = v.dot(pencil.across);
    upper += (v.squaredNorm() - pencil.half * pencil.half) * d;
    lower += 2 * d * d;
    if (k > first && !pencil.admit(points_[k], tolerance)) return std::nullopt;
    if (length_[k + 1] - length_[k] > tolerance && !pencil.admit(0.5 * (points_[k] + points_[k + 1]), tolerance))
      return std::nullopt;
  }
  const double widest =
      std::sqrt(std::max(0.0, options_.max_radius_mm * options_.max_radius_mm - pencil.half * pencil.half));
  const double lowest = std::max(pencil.lowest, -widest), highest = std::min(pencil.highest, widest);
  if (lowest > highest) return std::nullopt;
  const double through = lower > 0 ? std::clamp(upper / lower, lowest, highest) : highest;
  return ArcRoom{sweep_of(pencil.half, highest), sweep_of(pencil.half, lowest), sweep_of(pencil.half, through),
                 direction};
}

std::optional<Primitive> Fitter::rounded_arc(std::uint32_t first, std::uint32_t last, int direction,
                                             const Vec2& center_mm) const {
  const double step = options_.increment_mm;
  const Vec2 start = points_[first], wanted = (center_mm - start) / step;
  const Vec2 nearest(std::round(wanted.x()), std::round(wanted.y()));
  const double agreement = options_.radius_agreement_mm;
  // Nine centres about the wanted one; by how much their radii disagree and how far off they are.
  const Vec2 end = points_[last];
  std::array<double, 3> x{}, y{}, start_x{}, start_y{}, end_x{}, end_y{}, off_x{}, off_y{};
  for (std::size_t i = 0; i < 3; ++i) {
    constexpr std::array kSteps{0.0, -1.0, 1.0};
    const auto square = [](double v) { return v * v; };
    x[i] = step * (nearest.x() + kSteps[i]), y[i] = step * (nearest.y() + kSteps[i]);
    start_x[i] = square(start.x() - (start.x() + x[i])), start_y[i] = square(start.y() - (start.y() + y[i]));
    end_x[i] = square(end.x() - (start.x() + x[i])), end_y[i] = square(end.y() - (start.y() + y[i]));
    off_x[i] = square(x[i] + start.x() - center_mm.x()), off_y[i] = square(y[i] + start.y() - center_mm.y());
  }
  std::array<double, 9> badness{};
  for (std::size_t g = 0; g < 9; ++g)
    badness[g] = std::abs(std::sqrt(end_x[g / 3] + end_y[g % 3]) - std::sqrt(start_x[g / 3] + start_y[g % 3])) +
                 std::sqrt(off_x[g / 3] + off_y[g % 3]);
  // The three that agree best, equal ones in the order of the grid.
  for (int tries = 0; tries < 3; ++tries) {
    const auto least = static_cast<std::size_t>(std::min_element(badness.begin(), badness.end()) - badness.begin());
    badness[least] = kInfinity;
    const Vec2 from_start(x[least / 3], y[least % 3]);
    const ArcShape shape = arc_shape(start, points_[last], start + from_start, direction);
    if (shape.radius_difference_mm > agreement || shape.radius_mm > options_.max_radius_mm ||
        shape.radius_mm < 2 * options_.tolerance_mm)
      continue;
    const auto away = arc_deviation(points_, first, last, shape, options_.tolerance_mm + kRoundingMm, backwards_mm_);
    if (!away) continue;
    double deviation = away->deviation_mm;
    if (!flat(first, last))
      deviation =
          std::hypot(deviation, helix_deviation(points_, path_.heights, first, last, shape.center_mm, away->sweep_rad));
    if (deviation <= options_.tolerance_mm + kRoundingMm)
      return Primitive{first, last, true, from_start, away->sweep_rad, deviation};
  }
  return std::nullopt;
}

std::optional<Primitive> Fitter::arc_with_sweep(std::uint32_t first, std::uint32_t last, int direction,
                                                double sweep_rad) const {
  const Vec2 start = points_[first], end = points_[last], chord = end - start;
  const double length = chord.norm();
  const Vec2 across = direction * Vec2(-chord.y(), chord.x()) / length;
  return rounded_arc(first, last, direction, 0.5 * (start + end) + offset_of(0.5 * length, sweep_rad) * across);
}

bool Fitter::may_be_arc(std::uint32_t first, std::uint32_t last) const {
  return last - first + 1 >= options_.arc_points && (options_.helices || flat(first, last));
}

std::optional<ArcRoom> Fitter::arc_room(std::uint32_t first, std::uint32_t last) const {
  return may_be_arc(first, last) ? room(first, last) : std::nullopt;
}

std::optional<Primitive> Fitter::arc_in(std::uint32_t first, std::uint32_t last, const ArcRoom& room) const {
  const double span = room.max_sweep_rad - room.min_sweep_rad;
  if (auto fitted = arc_with_sweep(first, last, room.direction, room.best_sweep_rad)) return fitted;
  for (const double fraction : {0.5, 0.25, 0.75}) {
    if (auto fitted = arc_with_sweep(first, last, room.direction, room.min_sweep_rad + fraction * span)) return fitted;
    if (span < 1e-9) break;
  }
  return std::nullopt;
}

void FitMemory::forget() {
  slots_.assign(kSlots, 0);
  kept_.clear();
}

const TriedPrimitives& Fitter::tried(std::uint32_t first, std::uint32_t last) const {
  return (memory_ != nullptr ? *memory_ : own_memory_).at(first, last, [&] { return try_out(first, last); });
}

TriedPrimitives Fitter::try_out(std::uint32_t first, std::uint32_t last) const {
  TriedPrimitives out;
  out.line = line(first, last);
  if (!options_.arcs || (out.line && out.line->deviation_mm <= options_.increment_mm)) return out;
  if (points_[first] == points_[last]) {
    out.arc = arc(first, last);
    return out;
  }
  out.room = arc_room(first, last);
  if (!out.room) return out;
  out.arc = arc_with_sweep(first, last, out.room->direction, out.room->best_sweep_rad);
  out.best_sweep = out.arc.has_value();
  if (!out.arc) out.arc = arc_in(first, last, *out.room);
  return out;
}

std::optional<Primitive> Fitter::arc(std::uint32_t first, std::uint32_t last) const {
  if (points_[first] == points_[last]) return may_be_arc(first, last) ? full_turn(first, last) : std::nullopt;
  const auto room = arc_room(first, last);
  return room ? arc_in(first, last, *room) : std::nullopt;
}

/// The circle through the start that fits the others best: |p - s|^2 = 2 (p - s) . (c - s), least squares.
std::optional<Primitive> Fitter::full_turn(std::uint32_t first, std::uint32_t last) const {
  Eigen::Matrix2d m = Eigen::Matrix2d::Zero();
  Vec2 right = Vec2::Zero();
  for (std::uint32_t k = first + 1; k < last; ++k) {
    const Vec2 v = points_[k] - points_[first];
    m += 4 * v * v.transpose();
    right += 2 * v.squaredNorm() * v;
  }
  const double determinant = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  if (determinant <= 1e-12 * m.trace() * m.trace()) return std::nullopt;
  const Vec2 from_start((m(1, 1) * right.x() - m(0, 1) * right.y()) / determinant,
                        (m(0, 0) * right.y() - m(1, 0) * right.x()) / determinant);
  auto turn = rounded_arc(first, last, area(first, last) > 0 ? 1 : -1, points_[first] + from_start);
  if (!turn || std::abs(turn->sweep_rad) < 6) return std::nullopt;  // it must really go round
  turn->sweep_rad = std::copysign(2 * kPi, turn->sweep_rad);
  return turn;
}

}  // namespace camber::repath
