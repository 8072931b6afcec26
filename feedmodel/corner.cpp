#include "feedmodel/corner.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "feedmodel/limits.h"

namespace camber::feedmodel {
namespace {

constexpr double kSameDirection = 1e-9;  // rad; below it rounding of the end points decides

}  // namespace

double speed_difference_limit(const Vec3& from, const Vec3& to, const Vec3& permitted_mm_per_s) {
  double limit = machine::kNoLimit;
  for (int i = 0; i < 3; ++i) {
    const double step = std::abs(to[i] - from[i]);
    if (step > kSameDirection) limit = std::min(limit, permitted_mm_per_s[i] / step);
  }
  return limit;
}

double angle_limit(const Vec3& from, const Vec3& to, double acceleration_mm_per_s2, double time_s) {
  const double change = (to - from).norm();  // = sqrt(2 (1 - cos theta)) without its loss of digits
  return change > kSameDirection ? acceleration_mm_per_s2 * time_s / change : machine::kNoLimit;
}

std::optional<Blend> blend_corner(const Vec3& from, const Vec3& to, const BlendOptions& options) {
  const Vec3 axis = from.cross(to);
  Blend blend;
  blend.turn_rad = std::atan2(axis.norm(), from.dot(to));
  if (blend.turn_rad < 1e-7 || blend.turn_rad > kPi - 1e-3 || options.tolerance_mm <= 0) return std::nullopt;
  const Vec3 normal = axis.normalized();
  const double half = (kPi - blend.turn_rad) / 2.0;
  const double by_tolerance = options.tolerance_mm / (1.0 / std::sin(half) - 1.0);
  const double by_room = options.room_mm * std::tan(half);
  blend.acceleration_mm_per_s2 = limit_in_plane(normal, options.acceleration_mm_per_s2);
  const double goal = std::min(options.goal_speed_mm_per_s, limit_in_plane(normal, options.velocity_mm_per_s));
  const double by_goal = goal * goal / (blend.acceleration_mm_per_s2 * std::cos(half));
  blend.radius_mm = std::min({by_tolerance, by_room, by_goal});
  blend.speed_mm_per_s =
      std::min(goal, arc_speed(blend.radius_mm, blend.acceleration_mm_per_s2, options.normal_fraction));
  if (std::isinf(blend.acceleration_mm_per_s2))
    blend = {
        .turn_rad = blend.turn_rad, .speed_mm_per_s = goal, .acceleration_mm_per_s2 = blend.acceleration_mm_per_s2};
  blend.trim_mm = blend.radius_mm / std::tan(half);
  return blend;
}

namespace {

bool may_follow(const nc::Move& run, const nc::Move& next) {
  return next.kind == nc::MoveKind::linear && !next.canned && next.state == run.state &&
         next.feed_mm_per_s == run.feed_mm_per_s;
}

double distance_to_line(const Vec3& point, const Vec3& from, const Vec3& to) {
  const Vec3 line = to - from;
  const double square = line.squaredNorm();
  const double u = square > 0 ? std::clamp((point - from).dot(line) / square, 0.0, 1.0) : 0.0;
  return (point - from - u * line).norm();
}

}  // namespace

double merge_tolerance_mm(const nc::ModalState& state, const machine::Control& control) {
  if (state.path_control != nc::PathControl::blend) return 0;
  if (state.merge_tolerance_mm >= 0) return state.merge_tolerance_mm;
  if (control.kind.g64_p_merges && state.blend_tolerance_mm >= 0) return state.blend_tolerance_mm;
  return control.merge_tolerance_mm;
}

std::size_t merged_run_end(std::span<const nc::Move> moves, std::size_t first, double tolerance_mm) {
  const nc::Move& run = moves[first];
  std::size_t end = first + 1;
  if (tolerance_mm <= 0 || run.kind != nc::MoveKind::linear || run.canned) return end;
  while (end < moves.size() && end - first < kMaxMergedLines && !moves[end - 1].exact_stop &&
         may_follow(run, moves[end])) {
    const bool fits = std::all_of(moves.begin() + first, moves.begin() + end, [&](const nc::Move& m) {
      return distance_to_line(m.end_mm, run.start_mm, moves[end].end_mm) <= tolerance_mm;
    });
    if (!fits) break;
    ++end;
  }
  return end;
}

}  // namespace camber::feedmodel
