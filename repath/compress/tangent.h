#pragma once
// The room that the tolerance leaves to an arc, used to meet its neighbours without a kink.
#include <vector>

#include "repath/compress/fit.h"

namespace camber::repath {

/// Moves joints that are no corners along the points, as far as both neighbours still fit, where that makes the kinks
/// smaller. The search takes every primitive as far as it goes, which leaves arcs no room; the last of them has plenty.
void move_joints(const Polyline& path, const Fitter& fitter, const std::vector<bool>& corners,
                 std::vector<Primitive>& chain);

/// Changes the sweeps of the arcs of a chain within their room such that the squares of the kinks at joints that are no
/// corners become least. With chord angles x and signed sweeps s the kink between k and k+1 is
/// x[k+1] - s[k+1]/2 - x[k] - s[k]/2: linear, so Gauss-Seidel with bounds settles. Arcs that do not hold the tolerance
/// after rounding stay as they were. In space the path is seen along the third axis.
void make_tangent(std::span<const Vec2> points, const FitOptions& options, const Fitter& fitter,
                  const std::vector<bool>& corners, std::vector<Primitive>& chain);

/// Kink at each joint, rad, 0 or more, in space where the path is: chain.size() - 1 of them.
std::vector<double> kinks_of(const Polyline& path, std::span<const Primitive> chain);

}  // namespace camber::repath
