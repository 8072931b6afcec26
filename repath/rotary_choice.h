#pragma once
// One way to run the rotary axes of a program: as programmed, whole turns further, or in the other branch.
#include <optional>

#include <Eigen/Core>

#include "base/geometry.h"
#include "kinematics/chain.h"
#include "machine/machine.h"

namespace camber::repath {

/// What the first axis turns further in the other branch of a chain that reaches its pole, where the second axis is not
/// square to both the first and the tool (nutating heads).
///
/// With the tool on the first axis at the pole, beta between the two axes, and the second axis delta past the pole, the
/// tool is at the azimuth  psi(delta) = -pi/2 + atan(cos(beta) tan(delta / 2))  about the first axis, delta > 0, and
/// psi(-delta) = -psi(delta). The same direction at -delta therefore takes  2 psi(delta) = -pi + 2 atan(...)  more of
/// the first axis: half a turn, which RotaryChoice::offset_rad has, and this.
struct PoleTwist {
  Eigen::Index first = 0, second = 0;        ///< of A, B, C
  double first_sense = 1, second_sense = 1;  ///< of the tool against the part, for growing words
  double pole_rad = 0;                       ///< second axis
  double cosine = 0;                         ///< of beta

  double past_pole_rad(const Vec3& programmed_rad) const;
  /// Of the first axis; continuous.
  double of(const Vec3& programmed_rad) const;
  /// Bound of the angle between the tool where this turns as it must, and where the axes turn evenly between two
  /// places: max|of''| / 8 of the first axis, times the sine of the angle between it and the tool.
  double deviation_rad(const Vec3& from_rad, const Vec3& to_rad) const;
};

struct RotaryChoice {
  bool mirrored = false;
  Vec3 offset_rad = Vec3::Zero();  ///< of A, B, C
  Vec3 mirror_rad = Vec3::Zero();  ///< twice the angle of the pole, at the mirrored axis
  Vec3 sign = Vec3::Ones();        ///< -1 at the mirrored axis
  std::optional<PoleTwist> twist{};

  Vec3 of(const Vec3& programmed_rad) const;
  bool as_programmed() const { return !mirrored && offset_rad.isZero(0); }
  /// Of the tool, where the axes turn evenly between two programmed places; 0 without a twist.
  double deviation_rad(const Vec3& from_rad, const Vec3& to_rad) const {
    return twist ? twist->deviation_rad(from_rad, to_rad) : 0;
  }
};

/// The other branch, where there is one that is followed exactly: two rotary axes, and the tool comes to lie along the
/// first one. The second axis mirrored about that pole, the first half a turn further.
std::optional<RotaryChoice> mirrored_choice(const machine::Machine& machine, const kinematics::Chain& chain);

}  // namespace camber::repath
