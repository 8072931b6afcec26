#pragma once
// Directions of the tool that a machine reaches within travel, and the rotary motion and time from one to the next.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kinematics/chain.h"
#include "machine/machine.h"

namespace camber::posture {

class Directions {
 public:
  struct Step {
    std::uint16_t to = 0;
    float turn_deg = 0;  ///< sum of the turns of the rotary axes
    float time_s = 0;    ///< time of the slowest axis, at its speed or from rest to rest with its acceleration
    std::uint8_t from_branch = 0, to_branch = 0;  ///< solutions, as in angles()
  };

  /// Directions about `step_rad` apart, up to `max_tilt_rad` from +Z, that the rotary axes of the machine reach within
  /// their travel; neighbours up to one and a half steps away. Requires machine.kinematics.given().
  Directions(const machine::Machine& machine, double step_rad, double max_tilt_rad);

  std::size_t size() const { return axes_.size(); }
  const Vec3& axis(std::size_t i) const { return axes_[i]; }
  /// Returns one or two solutions for A, B and C, rad.
  std::span<const Vec3> angles(std::size_t i) const { return {angles_[i].rad.data(), angles_[i].count}; }
  /// Every solution of the inverse kinematics is within travel.
  bool whole(std::size_t i) const { return angles_[i].whole; }
  /// Returns the steps from direction i, the one to itself included.
  std::span<const Step> steps(std::size_t i) const { return {steps_.data() + first_[i], first_[i + 1] - first_[i]}; }

 private:
  struct Angles {
    std::array<Vec3, 2> rad;
    std::size_t count = 0;
    bool whole = false;
  };
  Step step_between(std::size_t a, std::size_t b) const;

  const machine::Machine& machine_;
  std::vector<Vec3> axes_;
  std::vector<Angles> angles_;
  std::vector<Step> steps_;
  std::vector<std::size_t> first_;
};

}  // namespace camber::posture
