#pragma once
// The angles of the rotary axes that give the tool a direction. Internal to kinematics/.
//
// Axes w_1 ... w_n in the order from the part to the spindle, t the tool's direction at angles of 0; wanted
//     R(w_1, q_1) ... R(w_n, q_n) t = u.
// n = 2 (Paden & Kahan's second subproblem, any two directions, so nutating heads too): v = R(w_2, q_2) t must make the
// angle rho of u with w_1. The spherical triangle w_1 w_2 v has the sides angle(w_1, w_2), angle(w_2, t) and rho; the
// half angle formula gives its angle at w_2, +phi or -phi. Then q_1 turns v into u about w_1. Angles between directions
// come from atan2 of cross and dot product, so that the solution keeps its accuracy near the pole, where arc cosines
// lose half of the digits. n = 1: the same last step. n = 3: damped Newton steps of least norm from the angles given.
#include <array>
#include <cstddef>
#include <span>

#include "base/geometry.h"

namespace camber::kinematics {

struct RotarySolutions {
  /// By axis, from the part to the spindle, rad; a multiple of one turn may be missing.
  std::array<std::array<double, 3>, 2> angles{};
  std::size_t count = 0;  ///< 0: no angles reach the direction
  /// The axis next to the part turns about the tool (less than kPoleRad between them): its angle is free, and the one
  /// given was kept.
  bool at_pole = false;
  /// Angle between the tool and the axis next to the part, 0 to pi/2, or infinity without rotary axes.
  double pole_distance_rad = 0;
};

inline constexpr double kPoleRad = 1e-12;
/// A direction that far beyond the reach of the axes still counts as reached, at the limit.
inline constexpr double kReachRad = 1e-9;

/// `axes`: unit directions about which a growing angle turns the tool relative to the part, none to three. `tool`,
/// `wanted`: unit. `near`: angles where the choice is free.
RotarySolutions solve_direction(std::span<const Vec3> axes, const Vec3& tool, const Vec3& wanted,
                                const std::array<double, 3>& near);

/// `v` turned about the unit `axis`.
Vec3 turned(const Vec3& v, const Vec3& axis, double angle_rad);

}  // namespace camber::kinematics
