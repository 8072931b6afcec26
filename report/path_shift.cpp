// How far a changed program's path lies from the path of the given program.
#include <algorithm>
#include <cmath>

#include "report/path_rows.h"

namespace camber::report {
namespace {

constexpr double kArcChord_mm = 0.0001;  // arcs are taken as chords within a tenth of a micrometre
constexpr double kPiece_mm = 0.5;        // of lines
constexpr double kReach_mm = 2.0;        // both ways along the path from where the next place is expected
constexpr double kReachFraction = 0.05;  // of the way to it

/// A path: corners, on lines at most kPiece_mm apart, and the length up to each.
struct Polyline {
  std::vector<Vec3> corner;
  std::vector<double> length_mm;

  void add(const Vec3& p) {
    length_mm.push_back(corner.empty() ? 0 : length_mm.back() + (p - corner.back()).norm());
    corner.push_back(p);
  }
};

Polyline polyline_of(const nc::Interpretation& program) {
  Polyline out;
  for (const auto& move : program.moves) {
    if (move.reference) continue;
    if (out.corner.empty()) out.add(move.start_mm);
    if (move.kind == nc::MoveKind::arc && move.arc != nc::Move::kNoArc) {
      const nc::Arc& arc = program.arcs[move.arc];
      const Vec3 spoke = move.start_mm - arc.center_mm;
      const double radius = (spoke - spoke.dot(arc.normal) * arc.normal).norm();
      const double step_rad = 2 * std::acos(std::clamp(1 - kArcChord_mm / std::max(radius, 1e-6), 0.0, 1.0));
      const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(arc.sweep_rad) / std::max(step_rad, 1e-4))));
      for (int i = 1; i < steps; ++i) out.add(nc::point_at(program, move, static_cast<double>(i) / steps));
    }
    const Vec3 from = out.corner.back();
    const int pieces = std::max(1, static_cast<int>(std::ceil((move.end_mm - from).norm() / kPiece_mm)));
    for (int i = 1; i <= pieces; ++i) out.add(from + static_cast<double>(i) / pieces * (move.end_mm - from));
  }
  return out;
}

struct Found {
  double at_mm = 0;  ///< along the polyline
  double distance_mm = 0;
};

/// Nearest places of a polyline to points that follow each other.
class Follower {
 public:
  explicit Follower(const Polyline& path) : path_(path) {}

  /// `moved_mm`: how far the point lies from the one before.
  Found nearest(const Vec3& p, double moved_mm) {
    const double expected = at_mm_ + moved_mm, reach = kReach_mm + kReachFraction * moved_mm;
    const auto begin = path_.length_mm.begin();
    auto i = static_cast<std::size_t>(std::lower_bound(begin, path_.length_mm.end(), expected - reach) - begin);
    i = std::min(i > 0 ? i - 1 : 0, path_.corner.size() - 2);
    Found best{expected, std::numeric_limits<double>::infinity()};
    for (; i + 1 < path_.corner.size() && (path_.length_mm[i] <= expected + reach || std::isinf(best.distance_mm));
         ++i) {
      const Vec3 along = path_.corner[i + 1] - path_.corner[i];
      const double square = along.squaredNorm();
      const double u = square > 0 ? std::clamp((p - path_.corner[i]).dot(along) / square, 0.0, 1.0) : 0.0;
      const double d = (path_.corner[i] + u * along - p).norm();
      if (d < best.distance_mm) best = {path_.length_mm[i] + u * (path_.length_mm[i + 1] - path_.length_mm[i]), d};
    }
    at_mm_ = best.at_mm;
    return best;
  }

 private:
  const Polyline& path_;
  double at_mm_ = 0;
};

/// A path's distance from another in the middle of each of its pieces.
struct Shifts {
  std::vector<double> at_mm, distance_mm;

  double interpolated(double place_mm) const {
    const auto above = std::upper_bound(at_mm.begin(), at_mm.end(), place_mm);
    if (above == at_mm.end()) return distance_mm.back();
    if (above == at_mm.begin()) return distance_mm.front();
    const auto i = static_cast<std::size_t>(above - at_mm.begin());
    const double u = (place_mm - at_mm[i - 1]) / (at_mm[i] - at_mm[i - 1]);
    return (1 - u) * distance_mm[i - 1] + u * distance_mm[i];
  }
};

/// Middles, not corners: a corner that was moved along the next line still lies on the old path.
Shifts shifts_of(const Polyline& path, const Polyline& from) {
  Follower follower(from);
  Shifts out;
  double before_mm = 0;
  for (std::size_t i = 0; i + 1 < path.corner.size(); ++i) {
    if (path.length_mm[i + 1] <= path.length_mm[i]) continue;
    const double at_mm = 0.5 * (path.length_mm[i] + path.length_mm[i + 1]);
    out.at_mm.push_back(at_mm);
    out.distance_mm.push_back(
        follower.nearest(0.5 * (path.corner[i] + path.corner[i + 1]), at_mm - before_mm).distance_mm);
    before_mm = at_mm;
  }
  return out;
}

}  // namespace

void add_shifts(std::vector<PathRow>& rows, const nc::Interpretation& program, const nc::Interpretation& as_given) {
  const Polyline path = polyline_of(program), given = polyline_of(as_given);
  if (path.corner.size() < 2 || given.corner.size() < 2 || rows.empty()) return;
  const Shifts shifts = shifts_of(path, given);
  if (shifts.at_mm.empty()) return;
  Follower follower(path);
  Vec3 before = rows.front().command_mm;
  for (PathRow& row : rows) {
    const double at_mm = follower.nearest(row.command_mm, (row.command_mm - before).norm()).at_mm;
    before = row.command_mm;
    if (row.cutting) row.shift_um = 1000 * shifts.interpolated(at_mm);
  }
}

}  // namespace camber::report
