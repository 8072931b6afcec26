#include "repath/compress/tangent.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "repath/compress/block_joints.h"

namespace camber::repath {
namespace {

constexpr int kRounds = 30;
constexpr int kJointRounds = 3;
constexpr double kSmoothRad = 0.5;  ///< a joint that kinks by more is left to itself

double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

}  // namespace

std::vector<double> kinks_of(const Polyline& path, std::span<const Primitive> chain) {
  const auto direction = [&](const Primitive& p, double side) {
    const double rise = path.heights.empty() ? 0 : path.heights[p.last] - path.heights[p.first];
    if (!p.arc) {
      const Vec2 chord = path.points[p.last] - path.points[p.first];
      return Vec3(chord.x(), chord.y(), rise);
    }
    const double angle = chord_angle_rad(path.points, p) + side * 0.5 * p.sweep_rad;
    const double length = p.center_from_start_mm.norm() * std::abs(p.sweep_rad);
    return Vec3(length * std::cos(angle), length * std::sin(angle), rise);
  };
  std::vector<double> kinks;
  for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
    const Vec3 in = direction(chain[k], 1), out = direction(chain[k + 1], -1);
    kinks.push_back(std::atan2(in.cross(out).norm(), in.dot(out)));
  }
  return kinks;
}

namespace {

std::optional<Primitive> fitted(const Fitter& fitter, const Primitive& like, std::uint32_t first, std::uint32_t last) {
  return like.arc ? fitter.arc(first, last) : fitter.line(first, last);
}

bool short_arc(const Primitive& p) {
  constexpr std::uint32_t kBlocks = 8;
  return p.arc && p.last - p.first <= kBlocks;
}

/// Squares of the kinks at the joints of chain[k - 1] .. chain[k + 2], with two of them replaced.
double kinks_around(const Polyline& path, const std::vector<Primitive>& chain, const std::vector<bool>& corners,
                    std::size_t k, const Primitive& left, const Primitive& right) {
  std::vector<Primitive> some;
  if (k > 0 && !corners[left.first]) some.push_back(chain[k - 1]);
  some.push_back(left);
  some.push_back(right);
  if (k + 2 < chain.size() && !corners[right.last]) some.push_back(chain[k + 2]);
  double sum = 0;
  for (const double kink : kinks_of(path, some)) sum += kink * kink;
  return sum;
}

}  // namespace

void move_joints(const Polyline& path, const Fitter& fitter, const std::vector<bool>& corners,
                 std::vector<Primitive>& chain) {
  // A joint beside which nothing changed since it was found to lie best is not tried again.
  std::size_t now = 0;
  std::vector<std::size_t> changed(chain.size() + 2, 1), settled(chain.size(), 0);
  for (int round = 0; round < kJointRounds; ++round)
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
      if (settled[k] > std::max({changed[k > 0 ? k - 1 : 0], changed[k], changed[k + 1], changed[k + 2]})) continue;
      settled[k] = ++now + 1;
      const std::uint32_t joint = chain[k].last;
      if (corners[joint] || (!chain[k].arc && !chain[k + 1].arc)) continue;
      double least = kinks_around(path, chain, corners, k, chain[k], chain[k + 1]);
      for (const int shift : {-16, -6, -3, -2, -1, 1, 2, 3, 6, 16}) {
        const std::int64_t there = static_cast<std::int64_t>(joint) + shift;
        if (there <= chain[k].first || there >= chain[k + 1].last) continue;
        const auto at = static_cast<std::uint32_t>(there);
        // An arc of a few blocks may have been a straight one and its neighbour's begin.
        for (const bool left_straight : {false, true})
          for (const bool right_straight : {false, true}) {
            if ((left_straight && !short_arc(chain[k])) || (right_straight && !short_arc(chain[k + 1])) ||
                (left_straight && right_straight))
              continue;
            const auto left =
                left_straight ? fitter.line(chain[k].first, at) : fitted(fitter, chain[k], chain[k].first, at);
            if (!left) continue;
            const auto right = right_straight ? fitter.line(at, chain[k + 1].last)
                                              : fitted(fitter, chain[k + 1], at, chain[k + 1].last);
            if (!right) continue;
            const double kinks = kinks_around(path, chain, corners, k, *left, *right);
            if (kinks >= least) continue;
            least = kinks;
            chain[k] = *left;
            chain[k + 1] = *right;
            changed[k] = changed[k + 1] = settled[k];
          }
      }
    }
}

void make_tangent(std::span<const Vec2> points, const FitOptions&, const Fitter& fitter,
                  const std::vector<bool>& corners, std::vector<Primitive>& chain) {
  struct Bounds {
    double least = 0, most = 0;
    bool free = false;
  };
  const std::size_t n = chain.size();
  std::vector<Bounds> bounds(n);
  std::vector<double> angle(n), sweep(n);
  for (std::size_t k = 0; k < n; ++k) {
    angle[k] = chord_angle_rad(points, chain[k]);
    sweep[k] = chain[k].sweep_rad;
    if (!chain[k].arc || points[chain[k].first] == points[chain[k].last]) continue;
    const auto room = fitter.room(chain[k].first, chain[k].last);
    if (!room) continue;
    const double a = room->direction * room->min_sweep_rad, b = room->direction * room->max_sweep_rad;
    const double margin = 0.05 * std::abs(b - a);
    bounds[k] = {std::min({std::min(a, b) + margin, sweep[k]}), std::max(std::max(a, b) - margin, sweep[k]), true};
  }
  // Kink at the joint behind k, and whether it counts.
  const auto kink = [&](std::size_t k) {
    return wrapped(angle[k + 1] - 0.5 * sweep[k + 1] - angle[k] - 0.5 * sweep[k]);
  };
  std::vector<bool> smooth(n, false);
  for (std::size_t k = 0; k + 1 < n; ++k) smooth[k] = !corners[chain[k].last] && std::abs(kink(k)) < kSmoothRad;
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t k = 0; k < n; ++k) {
      if (!bounds[k].free) continue;
      double sum = 0;
      int joints = 0;
      if (smooth[k] && k + 1 < n) sum += kink(k), ++joints;
      if (k > 0 && smooth[k - 1]) sum += kink(k - 1), ++joints;
      if (joints > 0) sweep[k] = std::clamp(sweep[k] + 2 * sum / joints, bounds[k].least, bounds[k].most);
    }
  for (std::size_t k = 0; k < n; ++k) {
    if (!bounds[k].free || sweep[k] == chain[k].sweep_rad) continue;
    const int direction = sweep[k] > 0 ? 1 : -1;
    for (const double fraction : {1.0, 0.7, 0.4}) {
      const double wish = chain[k].sweep_rad + fraction * (sweep[k] - chain[k].sweep_rad);
      if (const auto arc = fitter.arc_with_sweep(chain[k].first, chain[k].last, direction, std::abs(wish))) {
        chain[k] = *arc;
        break;
      }
    }
  }
}

}  // namespace camber::repath
