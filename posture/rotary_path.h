#pragma once
// Chooses, for a path whose directions are given, one solution of the inverse kinematics and its winding at each point,
// over the whole path at once.
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kinematics/chain.h"
#include "machine/machine_model.h"
#include "posture/path_points.h"

namespace camber::posture {

/// Angles of A, B and C at one point, and the direction of the tool.
struct RotaryPlace {
  Vec3 rotary_rad = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();
};

/// Returns how far the tool swings between two places: the angle between its direction half way, with the axes turning
/// evenly, and the direction half way between the two.
double swing_rad(const kinematics::Chain& chain, const RotaryPlace& from, const RotaryPlace& to);

/// Largest distance by which a swing may take the centre of the rounding, on the part, off its way.
inline constexpr double kSwing_mm = 0.1;
/// Returns whether the tool swings on the way to point i from the one before. `rotary_rad`: result of rotary_path().
bool swings(const kinematics::Chain& chain, std::span<const PathPoint> points, std::span<const Vec3> axes,
            std::span<const Vec3> rotary_rad, std::size_t i);

/// Returns A, B and C, rad, one value per point: within travel, of least swing in feed moves and then of least turn,
/// from 0 on. The axes change their solution in rapids, as high as may be, where there is any such way.
std::vector<Vec3> rotary_path(const machine::Machine& machine, std::span<const PathPoint> points,
                              std::span<const Vec3> axes);

/// Calls `visit` with directions between two places, the axes turning evenly, at most a degree apart and at least with
/// the one half way; `share`: fraction of the way. Ends when `visit` returns false.
bool each_between(const kinematics::Chain& chain, const Vec3& from_rad, const Vec3& to_rad,
                  const std::function<bool(double share, const Vec3& axis)>& visit);

}  // namespace camber::posture
