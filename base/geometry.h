#pragma once
// Vector types; millimetres unless the name says otherwise.
#include <Eigen/Core>

namespace camber {
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
inline constexpr double kPi = 3.14159265358979323846;
}  // namespace camber
