#pragma once
// How thick the part is under its surface.
#include <optional>
#include <span>
#include <vector>

#include "removal/form_error.h"
#include "removal/stock.h"

namespace camber::simulate {

/// The way through a stock's material from a point of its surface, against the outward normal, mm; `longest_mm` or more
/// where it is longer. Within a voxel of the surface the way is not looked at.
double thickness_mm(const removal::Stock& stock, const Vec3& place_mm, const Vec3& outward, double longest_mm);

/// What a stock is like under a surface.
struct Thickness {
  double thin_mm = 0;            ///< that a twentieth of the area is no thicker than
  Vec3 place_mm = Vec3::Zero();  ///< of a point of about this thickness
  Vec3 outward = Vec3::UnitZ();
};

/// Looks at up to two thousand of the points. Empty where nothing is thinner than `longest_mm`, or there is no point.
std::optional<Thickness> thin_part(const removal::Stock& stock, std::span<const removal::SurfacePoint> points,
                                   double longest_mm);

/// How far a thin part reaches from where it hangs on: the shortest way, along the part and square to `outward`, to
/// where it is twice as thick or ends in the held level `bottom_mm`. Empty where no way leads there.
std::optional<double> reach_mm(const removal::Stock& stock, const Thickness& thin, double bottom_mm, double longest_mm);

}  // namespace camber::simulate
