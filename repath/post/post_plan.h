#pragma once
// Which of the solutions of the machine a program under tool-centre-point control runs with, from its start to its end.
//
// A choice is kept as long as travel allows: a stretch of motion is followed without a jump in every choice. Choices
// differ by whole turns of the rotary axes and, on chains whose tool comes to lie along the first rotary axis, by the
// other branch, which leads from the other side to that pole (rotary_choice). Both give the tool the same direction
// everywhere along the stretch. Where no choice lasts, a shortest path through (stretch, choice) decides where the axes
// turn back: in air rather than in a cut.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/geometry.h"
#include "kinematics/chain.h"
#include "machine/machine_model.h"
#include "repath/post/tip_motion.h"

namespace camber::repath {

// One way to run the rotary axes of a program: as programmed, whole turns further, or in the other branch.

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
  /// Returns the angle of the first axis; it is continuous.
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
  /// Returns how far the tool deviates where the axes turn evenly between two programmed places; 0 without a twist.
  double deviation_rad(const Vec3& from_rad, const Vec3& to_rad) const {
    return twist ? twist->deviation_rad(from_rad, to_rad) : 0;
  }
};

/// The other branch, where there is one that is followed exactly: two rotary axes, and the tool comes to lie along the
/// first one. The second axis mirrored about that pole, the first half a turn further.
std::optional<RotaryChoice> mirrored_choice(const machine::Machine& machine, const kinematics::Chain& chain);

/// A part of a motion that is run with one choice.
struct PlannedStretch {
  std::size_t motion = 0;
  double from = 0, to = 1;
  RotaryChoice choice;
  RotaryChoice before;  ///< of the stretch before; another one: the axes turn back before this stretch
  bool turns_back = false;
  bool in_air = true;  ///< where the axes turn back: next to a rapid
};

/// What a move that is not rewritten asks of the choice about it.
enum class Barrier : std::uint8_t {
  none,
  pose,       ///< linear axes move as programmed: whole turns alone may differ
  programmed  ///< rotary axes are programmed: the choice should be that of the program
};

/// `before[i]`: what stands between motion i - 1 and motion i; one more than motions.
std::vector<PlannedStretch> plan_choices(std::span<const TipMotion> motions, std::span<const Barrier> before,
                                         const MotionFrame& frame, const machine::Machine& machine);

}  // namespace camber::repath
