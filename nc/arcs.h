#pragma once
// Arcs from the words of a block.
#include <optional>
#include <string>

#include "base/geometry.h"
#include "nc/move.h"

namespace camber::nc {

enum class Plane { xy, zx, yz };  ///< G17, G18, G19
Vec3 normal_of(Plane plane);

/// The two axes that span the plane, first and second such that first x second = normal (G18: Z, X), and the
/// axis along the normal: 0 X, 1 Y, 2 Z.
struct PlaneAxes {
  int first = 0, second = 1, normal = 2;
};
PlaneAxes axes_of(Plane plane);

struct ArcWords {
  Vec3 start_mm = Vec3::Zero(), end_mm = Vec3::Zero();
  Plane plane = Plane::xy;
  bool clockwise = false;  ///< G2, seen against the normal of the plane
  std::optional<double> i_mm{}, j_mm{}, k_mm{}, r_mm{};
  bool absolute_centre = false;  ///< G90.1
  int turns = 1;                 ///< P, L: 1 is up to one full turn
  bool spiral = false;           ///< the radius may change along the way; ends in one direction are a full turn
};

struct ArcResult {
  Arc arc;
  double radius_difference_mm = 0;  ///< |radius at end - radius at start|
  double start_radius_mm = 0, end_radius_mm = 0;
  bool is_point = false;  ///< the whole arc is no larger than kPointMm and its centre coincides with an end: no arc
  std::string error;      ///< not empty: no arc
};

/// Rounding of programs with three decimals (four in inches) leaves of arcs that are so small nothing but their ends.
inline constexpr double kPointMm = 0.005;

/// Centre and sweep. R: the arc up to half a turn, for R < 0 the larger one (the centre lies at
/// sqrt(R^2 - (chord/2)^2) from the chord's middle; Yan & Shirase 1997 eq. 1 in vector form). A chord longer than
/// 2 R by no more than 0.01 mm is taken as half a turn. Start and end at one place (within 1e-6 mm): a full turn
/// (I J K only). The sweep is counted at the given centre, so a radius difference does not change the end.
ArcResult make_arc(const ArcWords& words);

}  // namespace camber::nc
