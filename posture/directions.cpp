#include "posture/choose.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace camber::posture {
namespace {

std::vector<Vec3> cap_of(double step_rad, double max_tilt_rad) {
  std::vector<Vec3> out{Vec3::UnitZ()};
  for (int ring = 1; ring * step_rad <= max_tilt_rad + 1e-9; ++ring) {
    const double tilt = ring * step_rad;
    const int count = std::max(6, static_cast<int>(std::lround(2 * kPi * std::sin(tilt) / step_rad)));
    for (int k = 0; k < count; ++k) {
      const double turn = 2 * kPi * (k + 0.5 * (ring % 2)) / count;
      out.emplace_back(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
    }
  }
  return out;
}

bool within(double value, const std::array<double, 2>& travel) {
  return value >= travel[0] - 1e-9 && value <= travel[1] + 1e-9;
}

}  // namespace

Directions::Directions(const machine::Machine& machine, double step_rad, double max_tilt_rad) : machine_(machine) {
  const kinematics::Chain chain(machine);
  for (const Vec3& axis : cap_of(step_rad, max_tilt_rad)) {
    const kinematics::Branches branches = chain.branches({Vec3::Zero(), axis}, 0, {});
    Angles angles;
    for (std::size_t i = 0; i < branches.count; ++i) {
      Vec3 rad = branches.joints[i].rotary_rad;
      bool inside = true;
      for (const char letter : chain.rotary_axes()) {
        const auto index = static_cast<std::size_t>(letter - 'a');
        const auto& travel = machine.rotary[index].travel_rad;
        double& value = rad[static_cast<Eigen::Index>(index)];
        if (value > travel[1]) value -= 2 * kPi;
        if (value < travel[0]) value += 2 * kPi;
        inside = inside && within(value, travel);
      }
      if (inside) angles.rad[angles.count++] = rad;
    }
    if (angles.count == 0) continue;
    angles.whole = angles.count == branches.count;
    axes_.push_back(axis);
    angles_.push_back(angles);
  }
  const double near = std::cos(1.5 * step_rad);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    first_.push_back(steps_.size());
    for (std::size_t b = 0; b < axes_.size(); ++b)
      if (axes_[a].dot(axes_[b]) >= near) steps_.push_back(step_between(a, b));
  }
  first_.push_back(steps_.size());
}

Directions::Step Directions::step_between(std::size_t a, std::size_t b) const {
  Step best{static_cast<std::uint16_t>(b), 1e9F, 1e9F};
  if (a == b) return {static_cast<std::uint16_t>(b), 0, 0};
  for (std::size_t i = 0; i < angles_[a].count; ++i)
    for (std::size_t k = 0; k < angles_[b].count; ++k) {
      double turn = 0, time = 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double from = angles_[a].rad[i][axis];
        const double way = std::abs(kinematics::nearest_turn(angles_[b].rad[k][axis], from) - from);
        const machine::RotaryAxis& of = machine_.rotary[static_cast<std::size_t>(axis)];
        turn += deg_from_rad(way);
        time = std::max({time, way / of.max_velocity_rad_per_s, std::sqrt(4 * way / of.acceleration_rad_per_s2)});
      }
      if (turn < best.turn_deg)
        best = {best.to, static_cast<float>(turn), static_cast<float>(time), static_cast<std::uint8_t>(i),
                static_cast<std::uint8_t>(k)};
    }
  return best;
}

}  // namespace camber::posture
