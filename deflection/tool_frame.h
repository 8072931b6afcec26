#pragma once
// Converts forces of an edge from tangential, radial, axial to x, y, z of the tool's frame (base/tool_pose.h). No other
// file does.
//
// The tool turns clockwise seen from above (M3). At the angle phi (counter-clockwise from x) and the profile's normal
// angle kappa (0: down, pi/2: outwards) the edge moves along t, the envelope's outward normal is n, and m is the
// meridian's tangent that points up and outwards:
//   t = (sin phi, -cos phi, 0),  n = (sin kappa cos phi, sin kappa sin phi, -cos kappa),
//   m = (cos kappa cos phi, cos kappa sin phi, sin kappa).
// The force on the tool is -(F_t t + F_r n + F_a m). Source: Engin & Altintas 2001 (kappa as there), signs as in
// docs/force.md.
#include "base/geometry.h"
#include "deflection/edge_force.h"

namespace camber::deflection {

struct EdgeDirections {
  Vec3 tangential, normal, meridian;
};

inline EdgeDirections edge_directions(double sin_kappa, double cos_kappa, double sin_phi, double cos_phi) {
  return {{sin_phi, -cos_phi, 0},
          {sin_kappa * cos_phi, sin_kappa * sin_phi, -cos_kappa},
          {cos_kappa * cos_phi, cos_kappa * sin_phi, sin_kappa}};
}

/// Returns the force on the tool, N, of an edge with these components.
inline Vec3 force_on_tool(const EdgeForce& e, const EdgeDirections& d) {
  return -(e.tangential_N * d.tangential + e.radial_N * d.normal + e.axial_N * d.meridian);
}
/// What edges do to the tool: force in its frame, and torque of the spindle.
struct ToolLoad {
  Vec3 force_N = Vec3::Zero();
  double torque_Nmm = 0;

  ToolLoad& operator+=(const ToolLoad& other) {
    force_N += other.force_N;
    torque_Nmm += other.torque_Nmm;
    return *this;
  }
};
/// Returns the load of an edge with these components at this radius.
inline ToolLoad load_on_tool(const EdgeForce& e, const EdgeDirections& d, double radius_mm) {
  return {force_on_tool(e, d), e.tangential_N * radius_mm};
}

/// Returns the lateral part of that force.
inline Vec2 lateral_on_tool(const EdgeForce& e, const Vec2& tangential, const Vec2& normal, const Vec2& meridian) {
  return -(e.tangential_N * tangential + e.radial_N * normal + e.axial_N * meridian);
}

/// Computes load_on_tool component by component, for loops that the compiler vectorizes.
struct LoadComponents {
  double x, y, z, torque;
};
inline LoadComponents load_components(double tangential_N, double radial_N, double axial_N, double sin_kappa,
                                      double cos_kappa, double sin_phi, double cos_phi, double radius_mm) {
  const double outward = radial_N * sin_kappa + axial_N * cos_kappa;
  return {-(tangential_N * sin_phi + outward * cos_phi), -(outward * sin_phi - tangential_N * cos_phi),
          radial_N * cos_kappa - axial_N * sin_kappa, tangential_N * radius_mm};
}

}  // namespace camber::deflection
