#pragma once
// A polyline in a plane as a chain of few lines and arcs within a tolerance (docs/compress.md).
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/geometry.h"

namespace camber::repath {

// A line or an arc that replaces a stretch of a polyline, and its deviation.

/// From points[first] to points[last]. Both ends are points of the polyline.
struct Primitive {
  std::uint32_t first = 0, last = 0;
  bool arc = false;
  Vec2 center_from_start_mm = Vec2::Zero();  ///< as the program will say it: a whole number of increments
  double sweep_rad = 0;                      ///< counter-clockwise positive; +-2 pi: a full turn
  double deviation_mm = 0;                   ///< Hausdorff distance to the stretch, both ways (an upper bound)
};

/// Lines. The distance holds both ways: the polyline's distance to the line is greatest at a vertex (the distance to a
/// convex set is convex), and every point of the line is the foot of a point of the polyline, which runs from one end
/// to the other. Nothing where the polyline runs back along the line by more than `max_backwards_mm`.
std::optional<double> line_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                     double max_backwards_mm);

/// In space: `heights` is the third coordinate of each point. The same holds.
std::optional<double> line_deviation(std::span<const Vec2> points, std::span<const double> heights, std::uint32_t first,
                                     std::uint32_t last, double max_backwards_mm);

/// An arc as the control runs it: centre and, for ends whose radii differ, a radius between the two.
struct ArcShape {
  Vec2 center_mm = Vec2::Zero();
  double radius_mm = 0;             ///< mean of the radii at start and end
  double radius_difference_mm = 0;  ///< |end - start|
  int direction = 1;                ///< 1 counter-clockwise
};
ArcShape arc_shape(const Vec2& start, const Vec2& end, const Vec2& center_mm, int direction);

struct ArcFit {
  double deviation_mm = 0;
  double sweep_rad = 0;  ///< signed
};

/// Arcs. Greatest difference between the arc's radius and the polyline's distance from the centre, over the vertices
/// and the feet of the perpendiculars on the edges, and half the difference of the radii. As the polyline turns about
/// the centre from the arc's start to its end, every point of the arc has a point of the polyline on its ray: the
/// distance holds both ways. Nothing where a point is farther than `max_mm`, where the polyline turns back by more
/// than `max_backwards_mm` along the arc, passes an end of the arc by more than that, or turns by more than one turn.
std::optional<ArcFit> arc_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                    const ArcShape& arc, double max_mm, double max_backwards_mm);

/// How far the heights of the polyline, taken at its angle about the centre, are from those of a helix of constant
/// pitch from the first point to the last (controls move the third axis evenly with the angle). Greatest value over
/// whole edges: height is linear along an edge and the angle is not, so between its ends it is looked for where the
/// difference stands still, r^2 = pitch (from x to) / rise. With the arc's deviation beside it, hypot of the two bounds
/// the Hausdorff distance: points at one angle belong to each other. `sweep_rad` as arc_deviation says it.
double helix_deviation(std::span<const Vec2> points, std::span<const double> heights, std::uint32_t first,
                       std::uint32_t last, const Vec2& center_mm, double sweep_rad);

struct FitOptions {
  double tolerance_mm = 0.01;          ///< greater than zero
  double increment_mm = 0.001;         ///< of the centre's words
  bool arcs = true;                    ///< false: lines only
  std::uint32_t arc_points = 5;        ///< an arc stands for at least so many points, its ends among them
  double max_radius_mm = 5000;         ///< wider arcs are lines or nothing
  double radius_agreement_mm = 0.002;  ///< the radii at start and end of an arc differ by no more
  double corner_rad = 20 * kPi / 180;  ///< a vertex that turns by more, and alone, is a corner: no arc runs over it
  std::uint32_t width = 6;             ///< ends that are kept of each number of primitives; see docs/compress.md
  bool helices = false;                ///< in space: arcs whose third axis moves evenly with the angle
  bool tangent = true;                 ///< arcs use their room to meet their neighbours without a kink
  /// Where the path has no corner and no edge an arc meets an arc with a kink of no more than this, or an eighth of
  /// what the path itself turns there; a line it meets with no more than this, or 0.6 of that turn (a chord leaves its
  /// curve by half of it). Half a turn: not bounded. See repath/compress/block_joints.h.
  double max_kink_rad = 1 * kPi / 180;
  /// For controls that run arcs faster than lines: primitives that a millimetre of lines is worth. Zero: the fewest
  /// primitives, and among as many the shortest lines.
  double primitives_per_line_mm = 0;
};

/// A polyline, and the third coordinate of each point where it is one in space; else `heights` is empty. In space arcs
/// lie where the height stands still, or with FitOptions::helices are helices about the third axis.
/// `ends`, ascending: points over which nothing runs, as where the feed changes. Kinks are bounded there as elsewhere.
struct Polyline {
  std::span<const Vec2> points;
  std::span<const double> heights{};
  std::span<const std::uint32_t> ends{};
  bool arc_before = false,
       arc_behind = false;  ///< the first, the last segment is the tangent of an arc beside the path
  Vec3 at(std::size_t k) const { return {points[k].x(), points[k].y(), heights.empty() ? 0.0 : heights[k]}; }
};

/// All three coordinates of each point.
std::vector<Vec3> in_space(const Polyline& path);

class FitMemory;

/// The chain: first primitive from points.front(), last to points.back(), each from where the one before ends. Every
/// end is a point of the polyline, so nothing drifts. `points`: no two that follow each other are alike.
/// Time and memory grow linearly with the number of points.
/// `memory`: used again from path to path where given; never by two threads at once.
std::vector<Primitive> fit(const Polyline& path, const FitOptions& options, FitMemory* memory = nullptr);
inline std::vector<Primitive> fit(std::span<const Vec2> points, const FitOptions& options) {
  return fit(Polyline{points}, options);
}

/// Fits as fit() does, but tries every pair of points: the fewest primitives that this geometry allows, and among
/// chains of as many the one with the shortest lines. Kinks are not bounded. For tests: the time grows with the cube of
/// the number of points.
std::vector<Primitive> fit_exhaustively(const Polyline& path, const FitOptions& options);
inline std::vector<Primitive> fit_exhaustively(std::span<const Vec2> points, const FitOptions& options) {
  return fit_exhaustively(Polyline{points}, options);
}

/// The vertices that are corners: they turn by more than corner_rad, and more than twice as much as the path beside
/// them (a coarse circle turns everywhere alike). Turns are measured between legs of at least five tolerances.
std::vector<bool> corners_of(const Polyline& path, const FitOptions& options);
/// The vertices where primitives must end: corners, and Polyline::ends.
std::vector<bool> ends_of(const Polyline& path, const std::vector<bool>& corners);
double corner_leg_mm(const FitOptions& options);

/// The room of the arc from one point to another: the magnitude of its sweep lies between the two.
/// Nothing where no arc fits.
struct ArcRoom {
  double min_sweep_rad = 0, max_sweep_rad = 0;  ///< magnitudes
  double best_sweep_rad = 0;                    ///< goes through the points as well as it can (least squares)
  int direction = 1;
};

/// What fits between two points, whatever lies beside it: no arc where the line is straight to an increment.
struct TriedPrimitives {
  std::optional<Primitive> line, arc;
  std::optional<ArcRoom> room;  ///< as Fitter::arc_room(): not where the two points are one
  bool best_sweep = false;      ///< the arc has the room's best sweep
};

/// What was tried between pairs of points of one path, in room for a few thousand of them.
class FitMemory {
 public:
  void forget();
  /// What is kept of a pair; else makes it.
  template <class Make>
  const TriedPrimitives& at(std::uint32_t first, std::uint32_t last, Make make) {
    std::uint32_t& slot = slots_[(first * 67u + last) % kSlots];
    if (slot == 0) {
      kept_.push_back({first, last, make()});
      slot = static_cast<std::uint32_t>(kept_.size());
    }
    Kept& kept = kept_[slot - 1];
    if (kept.first != first || kept.last != last) kept = {first, last, make()};
    return kept.tried;
  }

 private:
  static constexpr std::uint32_t kSlots = 4096;  ///< a power of two, more than one window of a search asks for
  struct Kept {
    std::uint32_t first = 0, last = 0;
    TriedPrimitives tried;
  };
  std::vector<std::uint32_t> slots_;  ///< by a hash of the two points: 1 + index into kept_; 0 none
  std::vector<Kept> kept_;
};

/// Tries one line, one arc.
class Fitter {
 public:
  /// Returns the results of line(), arc_room() and arc(), which are kept for a while. Valid until the next call.
  const TriedPrimitives& tried(std::uint32_t first, std::uint32_t last) const;

  Fitter(const Polyline& path, const FitOptions& options, FitMemory* memory = nullptr);
  std::optional<Primitive> line(std::uint32_t first, std::uint32_t last) const;
  std::optional<Primitive> arc(std::uint32_t first, std::uint32_t last) const;
  /// Ends of lines from `first`, ascending: the next point and the last `max_ends` up to `end`. In space some of them
  /// may be none, the next point always is one.
  std::vector<std::uint32_t> line_ends(std::uint32_t first, std::uint32_t end, std::uint32_t max_ends) const;

  std::optional<ArcRoom> room(std::uint32_t first, std::uint32_t last) const;
  /// Returns what room() does; nothing where the stretch has too few points or is not flat.
  std::optional<ArcRoom> arc_room(std::uint32_t first, std::uint32_t last) const;
  /// The first that holds of the best sweep and others in the room.
  std::optional<Primitive> arc_in(std::uint32_t first, std::uint32_t last, const ArcRoom& room) const;
  /// The arc with the sweep (a magnitude), rounded to increments; nothing where it does not fit then.
  std::optional<Primitive> arc_with_sweep(std::uint32_t first, std::uint32_t last, int direction,
                                          double sweep_rad) const;

 private:
  TriedPrimitives try_out(std::uint32_t first, std::uint32_t last) const;
  std::optional<Primitive> full_turn(std::uint32_t first, std::uint32_t last) const;
  std::optional<Primitive> rounded_arc(std::uint32_t first, std::uint32_t last, int direction,
                                       const Vec2& center_mm) const;
  double area(std::uint32_t first, std::uint32_t last) const;
  bool flat(std::uint32_t first, std::uint32_t last) const;
  bool may_be_arc(std::uint32_t first, std::uint32_t last) const;  ///< points enough, and flat where it must be

  Polyline path_;
  std::span<const Vec2> points_;
  const FitOptions& options_;
  double backwards_mm_;
  std::vector<double> area_;          ///< twice the area swept from points[0], up to each point
  std::vector<double> length_;        ///< along the polyline up to each point
  std::vector<std::uint32_t> level_;  ///< in space: the point from which on each point's height stands still
  mutable FitMemory own_memory_;
  FitMemory* memory_;  ///< none: the fitter's own
};

}  // namespace camber::repath
