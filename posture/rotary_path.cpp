#include "posture/rotary_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/units.h"
#include "posture/choose.h"

namespace camber::posture {
namespace {

constexpr double kBetween_deg = 1;
constexpr double kSwingCost = 1000;      ///< cost of a degree of swing in feed moves, in degrees of turn
constexpr double kLowCost_per_mm = 0.1;  ///< the same in rapids, per mm below the highest point
constexpr double kSame_rad = 1e-7;
constexpr std::size_t kMostStates = 12;  ///< states kept at a point, the cheapest ones

struct State {
  Vec3 rotary_rad = Vec3::Zero();
  double cost = 0;  ///< degrees
  std::uint32_t before = 0;
};

/// States point by point: every solution with every winding within travel.
class RotarySearch {
 public:
  RotarySearch(const machine::Machine& machine, std::span<const PathPoint> points, std::span<const Vec3> axes)
      : machine_(machine), chain_(machine), points_(points), axes_(axes) {
    for (const PathPoint& p : points) top_mm_ = std::max(top_mm_, p.centre_mm.z());
  }

  std::vector<Vec3> run() {
    std::vector<std::vector<State>> states(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i == 0)
        add_from({}, 0, 0, states[0]);
      else
        for (std::size_t s = 0; s < states[i - 1].size(); ++s)
          add_from(states[i - 1][s], static_cast<std::uint32_t>(s), i, states[i]);
      std::ranges::stable_sort(states[i], {}, &State::cost);
      if (states[i].size() > kMostStates) states[i].resize(kMostStates);
    }
    std::vector<Vec3> out(points_.size());
    std::size_t s = 0;
    for (std::size_t i = points_.size(); i-- > 0;) {
      out[i] = states[i][s].rotary_rad;
      s = states[i][s].before;
    }
    return out;
  }

 private:
  void add_from(const State& from, std::uint32_t index, std::size_t i, std::vector<State>& out) const {
    kinematics::Joints near;
    near.rotary_rad = from.rotary_rad;
    const kinematics::Branches branches = chain_.branches({Vec3::Zero(), axes_[i]}, 0, near);
    bool any = false;
    for (std::size_t b = 0; b < branches.count; ++b)
      each_winding(branches.joints[b].rotary_rad, 0, [&](const Vec3& rad) {
        any = true;
        add(from, index, i, rad, out);
      });
    // Outside travel, which the check of the new program says.
    if (!any) add(from, index, i, chain_.solve_tool_axis(axes_[i], near).joints.rotary_rad, out);
  }

  template <typename Visit>
  void each_winding(Vec3 rad, std::size_t letter, const Visit& visit) const {
    if (letter == chain_.rotary_axes().size()) {
      visit(rad);
      return;
    }
    const Eigen::Index axis = chain_.rotary_axes()[letter] - 'a';
    const auto& travel = machine_.rotary[static_cast<std::size_t>(axis)].travel_rad;
    const double value = rad[axis];
    for (const int turns : {0, -1, 1}) {
      rad[axis] = value + 2 * kPi * turns;
      if (turns != 0 && endless(travel)) break;
      if (rad[axis] >= travel[0] - 1e-9 && rad[axis] <= travel[1] + 1e-9) each_winding(rad, letter + 1, visit);
    }
  }

  static bool endless(const std::array<double, 2>& travel) {
    return !std::isfinite(travel[0]) || !std::isfinite(travel[1]);
  }

  void add(const State& from, std::uint32_t index, std::size_t i, const Vec3& rad, std::vector<State>& out) const {
    State to{rad, from.cost, index};
    for (Eigen::Index axis = 0; axis < 3; ++axis) to.cost += deg_from_rad(std::abs(rad[axis] - from.rotary_rad[axis]));
    if (i > 0) {
      const double low_mm = top_mm_ - std::min(points_[i - 1].centre_mm.z(), points_[i].centre_mm.z());
      to.cost += (points_[i].rapid ? kLowCost_per_mm * low_mm : kSwingCost) *
                 deg_from_rad(swing_rad(chain_, {from.rotary_rad, axes_[i - 1]}, {rad, axes_[i]}));
    }
    const auto same = std::ranges::find_if(out, [&](const State& other) { return alike(other.rotary_rad, rad); });
    if (same == out.end())
      out.push_back(to);
    else if (to.cost < same->cost)
      *same = to;
  }

  /// Whole turns of an axis that goes on without end are no other place.
  bool alike(const Vec3& a, const Vec3& b) const {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      double apart = a[axis] - b[axis];
      if (endless(machine_.rotary[static_cast<std::size_t>(axis)].travel_rad)) apart = std::remainder(apart, 2 * kPi);
      if (std::abs(apart) > kSame_rad) return false;
    }
    return true;
  }

  const machine::Machine& machine_;
  kinematics::Chain chain_;
  std::span<const PathPoint> points_;
  std::span<const Vec3> axes_;
  double top_mm_ = -std::numeric_limits<double>::infinity();
};

Vec3 axis_at(const kinematics::Chain& chain, const Vec3& rotary_rad) {
  kinematics::Joints joints;
  joints.rotary_rad = rotary_rad;
  return chain.pose(joints, 0).axis;
}

}  // namespace

double swing_rad(const kinematics::Chain& chain, const RotaryPlace& from, const RotaryPlace& to) {
  return angle_between(axis_at(chain, (from.rotary_rad + to.rotary_rad) / 2), from.axis + to.axis);
}

bool swings(const kinematics::Chain& chain, std::span<const PathPoint> points, std::span<const Vec3> axes,
            std::span<const Vec3> rotary_rad, std::size_t i) {
  return i > 0 && points[i].contact && points[i - 1].contact &&
         points[i].corner_mm * swing_rad(chain, {rotary_rad[i - 1], axes[i - 1]}, {rotary_rad[i], axes[i]}) > kSwing_mm;
}

std::vector<Vec3> rotary_path(const machine::Machine& machine, std::span<const PathPoint> points,
                              std::span<const Vec3> axes) {
  return RotarySearch(machine, points, axes).run();
}

bool each_between(const kinematics::Chain& chain, const Vec3& from_rad, const Vec3& to_rad,
                  const std::function<bool(double share, const Vec3& axis)>& visit) {
  const double turn_deg = deg_from_rad((to_rad - from_rad).lpNorm<Eigen::Infinity>());
  const int count = std::max(2, static_cast<int>(std::ceil(turn_deg / kBetween_deg)));
  for (int k = 1; k < count; ++k) {
    const double share = static_cast<double>(k) / count;
    if (!visit(share, axis_at(chain, from_rad + share * (to_rad - from_rad)))) return false;
  }
  return true;
}

}  // namespace camber::posture
