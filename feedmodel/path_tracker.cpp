#include "feedmodel/path_tracker.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace camber::feedmodel {
namespace {

/// A later place wins if it is nearer by more than this; less is rounding.
constexpr double kNearerMm = 1e-9;

/// So far from the path the place is lost (a control may cut a corner between rapids widely): search up to the command.
constexpr double kLostMm = 1.0;

double fraction_on_line(const nc::Move& move, const Vec3& point_mm) {
  const Vec3 line = move.end_mm - move.start_mm;
  const double square = line.squaredNorm();
  return square > 0 ? (point_mm - move.start_mm).dot(line) / square : 1.0;
}

/// Returns, of the turns on which the point's angle lies, the one nearest to the start of the search.
double fraction_on_arc(const nc::Move& move, const nc::Arc& arc, const Vec3& point_mm, double from_u) {
  const auto in_plane = [&](Vec3 v) -> Vec3 { return v - arc.normal * arc.normal.dot(v); };
  const Vec3 start = in_plane(move.start_mm - arc.center_mm), at = in_plane(point_mm - arc.center_mm);
  double angle = std::atan2(arc.normal.dot(start.cross(at)), start.dot(at));
  const double turn = std::copysign(2 * kPi, arc.sweep_rad);
  // Bring the angle to within half a turn of where the search begins.
  angle += turn * std::round((from_u * arc.sweep_rad - angle) / turn);
  return angle / arc.sweep_rad;
}

}  // namespace

PathPlace closest_on_move(const nc::Interpretation& program, std::uint32_t index, const Vec3& point_mm, double from_u,
                          double to_u) {
  const nc::Move& move = program.moves[index];
  double u = 1.0;
  if (move.kind == nc::MoveKind::arc) {
    u = fraction_on_arc(move, program.arcs[move.arc], point_mm, from_u);
  } else if (move.kind != nc::MoveKind::dwell) {
    u = fraction_on_line(move, point_mm);
  }
  u = std::clamp(u, from_u, std::max(from_u, to_u));
  return {index, u, (nc::point_at(program, move, u) - point_mm).norm()};
}

PathPlace PathTracker::search_all(const TimedSample& sample, PathPlace best) const {
  for (std::uint32_t move = place_.move; move <= sample.move; ++move) {
    if (program_.moves[move].reference) continue;
    const PathPlace here = closest(move, sample, move == place_.move ? place_.u : 0.0);
    if (here.distance_mm < best.distance_mm - kNearerMm) best = here;
  }
  return best;
}

PathPlace PathTracker::operator()(const TimedSample& sample) {
  if (!started_) {
    place_ = {0, 0, (nc::point_at(program_, program_.moves.front(), 0) - sample.position_mm).norm()};
    last_position_mm_ = sample.position_mm;
    started_ = true;
  }
  if (program_.moves[sample.move].reference) {  // its way is not the programmed one
    place_ = {sample.move, 0, 0};
    last_position_mm_ = sample.position_mm;
    return place_;
  }
  while (place_.move < sample.move && program_.moves[place_.move].reference) place_ = {place_.move + 1, 0, 0};
  const double went_mm = (sample.position_mm - last_position_mm_).norm();
  double room_mm = options_.search_mm + went_mm + 2.0 * (sample.command_mm - sample.position_mm).norm();
  last_position_mm_ = sample.position_mm;
  PathPlace best = closest(place_.move, sample, place_.u);
  if (place_.move < sample.move) room_mm -= (1.0 - place_.u) * length_of(place_.move);
  for (std::uint32_t move = place_.move + 1; move <= sample.move && room_mm > 0; ++move) {
    if (program_.moves[move].reference) continue;
    const PathPlace here = closest(move, sample, 0.0);
    if (here.distance_mm < best.distance_mm - kNearerMm) best = here;
    room_mm -= length_of(move);
  }
  if (best.distance_mm > kLostMm) best = search_all(sample, best);
  place_ = best;
  return best;
}

}  // namespace camber::feedmodel
