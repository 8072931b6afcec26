#pragma once
// Positions of the axes of a machine.
#include "base/geometry.h"

namespace camber::kinematics {

/// Machine coordinates of every axis. Axes that the machine does not have stay at 0.
struct Joints {
  Vec3 linear_mm = Vec3::Zero();   ///< x, y, z
  Vec3 rotary_rad = Vec3::Zero();  ///< a, b, c, with their winding: 370 degrees is not 10
};

}  // namespace camber::kinematics
