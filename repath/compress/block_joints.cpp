#include "repath/compress/block_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "repath/compress/corners.h"
#include "repath/compress/tangent.h"

namespace camber::repath {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRoundingRad = 1e-9;
/// An edge below the angle of corners: the rule of resegment for what it keeps.
constexpr double kEdgeRad = 5 * kPi / 180;
constexpr double kEdgeTimesBeside = 3;
/// The fraction of what the program turns at a point to which its chords tell the direction there.
constexpr double kFractionOfArcs = 0.125, kFractionOfLines = 0.6;
constexpr double kTimesOfBlocks = 2;
constexpr double kAlwaysSharpRad = 60 * kPi / 180;  ///< also where the path turns as much beside it; as in resegment
constexpr double kClimb = 0.5;                      ///< of the bound: slopes that differ by more

double wrapped(double angle) { return std::abs(angle) <= kPi ? angle : std::remainder(angle, 2 * kPi); }

bool rises(const Polyline& path, const Primitive& p) {
  return !path.heights.empty() && path.heights[p.last] != path.heights[p.first];
}

/// Steepness of a primitive along the third axis, rad.
double slope_rad(const Polyline& path, const Primitive& p) {
  if (!rises(path, p)) return 0;
  const double flat = p.arc ? p.center_from_start_mm.norm() * std::abs(p.sweep_rad)
                            : (path.points[p.last] - path.points[p.first]).norm();
  return std::atan2(path.heights[p.last] - path.heights[p.first], flat);
}

}  // namespace

std::vector<bool> edges_of(const Polyline& path, const FitOptions& options) {
  return corners_of(in_space(path),
                    {.min_turn_rad = kEdgeRad, .times_beside = kEdgeTimesBeside, .leg_mm = corner_leg_mm(options)});
}

std::vector<Kink> kinks_beside_arcs(const Polyline& path, const FitOptions& options, std::span<const Primitive> chain) {
  const std::vector<bool> corners = corners_of(path, options), edges = edges_of(path, options);
  const std::vector<double> kinks = kinks_of(path, chain);
  std::vector<Kink> out;
  for (std::size_t k = 0; k < kinks.size(); ++k)
    if ((chain[k].arc || chain[k + 1].arc) && !corners[chain[k].last])
      out.push_back({kinks[k], chain[k].last, edges[chain[k].last]});
  return out;
}

double chord_angle_rad(std::span<const Vec2> points, const Primitive& p) {
  Vec2 chord = points[p.last] - points[p.first];
  if (chord.norm() == 0) {
    chord = Vec2(p.center_from_start_mm.y(), -p.center_from_start_mm.x());
    if (p.sweep_rad > 0) chord = -chord;
  }
  return std::atan2(chord.y(), chord.x());
}

PieceJoints::PieceJoints(const Polyline& path, const FitOptions& options, const std::vector<bool>& corners)
    : path_(path),
      corners_(corners),
      max_kink_rad_(options.max_kink_rad),
      increment_mm_(options.increment_mm),
      bounded_(options.arcs && options.max_kink_rad < kPi) {
  if (!bounded_) return;
  const std::vector<Vec3> points = in_space(path);
  turn_ = turns_of(points, corner_leg_mm(options));
  blocks_turn_ = turns_of(points, 0);
  edges_ = edges_of(path, options);
}

double PieceJoints::max_kink_rad(const Primitive& before, const Primitive& p) const {
  const std::uint32_t at = p.first;
  if (!bounded_ || at == 0 || at + 1 == corners_.size() || corners_[at] ||
      std::min(turn_[at], blocks_turn_[at]) > kAlwaysSharpRad || (is_block(before) && is_block(p)))
    return kInfinity;
  const bool arc_before = before.arc || (path_.arc_before && at == 1);
  const bool arc_behind = p.arc || (path_.arc_behind && at + 2 == corners_.size());
  if (!arc_before && !arc_behind)
    return rises(path_, before) || rises(path_, p) ? kInfinity
                                                   : std::max(max_kink_rad_, kTimesOfBlocks * blocks_turn_[at]);
  // Where a level path begins to climb it turns there, and what joins there turns as much.
  const bool climbs = std::abs(slope_rad(path_, p) - slope_rad(path_, before)) > kClimb * max_kink_rad_;
  // Beside an arc of the program a line may turn as the block did that lay there.
  const bool as_drawn = !before.arc && !p.arc;
  const double fraction = edges_[at] || climbs || as_drawn ? 1
                          : arc_before && arc_behind       ? kFractionOfArcs
                                                           : kFractionOfLines;
  return std::max(max_kink_rad_, fraction * std::min(turn_[at], blocks_turn_[at]));
}

double PieceJoints::chord_angle_rad(const Primitive& p) const {
  if (path_.points[p.first] == path_.points[p.last]) return repath::chord_angle_rad(path_.points, p);
  constexpr std::uint32_t kSlots = 1024;
  if (angles_.empty()) angles_.resize(kSlots);
  KeptAngle& kept = angles_[(p.first * 67u + p.last) % kSlots];
  if (kept.first != p.first || kept.last != p.last) kept = {p.first, p.last, repath::chord_angle_rad(path_.points, p)};
  return kept.angle_rad;
}

/// Returns the angle by which rounding of the centre may turn the direction at an end.
double PieceJoints::rounding_rad(const Primitive& p) const {
  return p.arc ? 0.5 * increment_mm_ / p.center_from_start_mm.norm() : 0;
}

std::optional<Sweeps> PieceJoints::behind(const Primitive& before, const Sweeps& of_before, const Primitive& p,
                                          const Sweeps& of_p) const {
  const double most = max_kink_rad(before, p);
  if (most == kInfinity) return of_p;
  const double climb = slope_rad(path_, p) - slope_rad(path_, before);
  if (std::abs(climb) > most) return std::nullopt;
  const double fraction = before.arc && p.arc ? fraction_tried_ : 1;
  const double room =
      std::max(0.0, fraction * std::sqrt(most * most - climb * climb) - rounding_rad(before) - rounding_rad(p));
  // Directions behind the joint less the direction of the chord before it.
  const double chords = wrapped(chord_angle_rad(p) - chord_angle_rad(before));
  const double low = 0.5 * of_before.low_rad - room, high = 0.5 * of_before.high_rad + room;
  // Sweeps of p whose begin, chords - s / 2, lies between the two, in one of the turns in which it may be meant.
  std::optional<Sweeps> out;
  for (const double turn : {0.0, 2 * kPi, -2 * kPi}) {
    const Sweeps some{std::max(of_p.low_rad, 2 * (chords + turn - high)),
                      std::min(of_p.high_rad, 2 * (chords + turn - low))};
    if (some.low_rad > some.high_rad + kRoundingRad) continue;
    if (!out || some.high_rad - some.low_rad > out->high_rad - out->low_rad)
      out = {some.low_rad, std::max(some.low_rad, some.high_rad)};
  }
  return out;
}

double PieceJoints::sweep_towards(const Primitive& p, const Sweeps& of_p, const Primitive& behind) const {
  const double begin = chord_angle_rad(behind) - 0.5 * behind.sweep_rad;
  const double middle = 0.25 * (of_p.low_rad + of_p.high_rad);
  const double half = middle + wrapped(begin - chord_angle_rad(p) - middle);
  return std::clamp(2 * half, of_p.low_rad, of_p.high_rad);
}

bool PieceJoints::keep(const Primitive& before, const Primitive& p) const {
  const double most = max_kink_rad(before, p);
  return most == kInfinity || kinks_of(path_, std::array{before, p}).front() <= most + kRoundingRad;
}

bool PieceJoints::keep(std::span<const Primitive> chain) const {
  for (std::size_t k = 0; k + 1 < chain.size(); ++k)
    if (!keep(chain[k], chain[k + 1])) return false;
  return true;
}

void give_way(const PieceJoints& joints, std::vector<Primitive>& chain) {
  if (!joints.bounded()) return;
  for (bool kept = false; !kept;) {
    std::vector<bool> gives(chain.size(), false);
    kept = true;
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
      if (joints.keep(chain[k], chain[k + 1])) continue;
      kept = false;
      // What is a block as it was stays; of two arcs the shorter one gives way.
      const auto size = [&](const Primitive& p) {
        return is_block(p) ? std::numeric_limits<std::uint32_t>::max() : p.last - p.first;
      };
      gives[size(chain[k]) < size(chain[k + 1]) ? k : k + 1] = true;
    }
    if (kept) return;
    std::vector<Primitive> out;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      if (!gives[k]) {
        out.push_back(chain[k]);
        continue;
      }
      for (std::uint32_t at = chain[k].first; at < chain[k].last; ++at) out.push_back({.first = at, .last = at + 1});
    }
    chain = std::move(out);
  }
}

}  // namespace camber::repath
