#pragma once
// Tip path over a part along a straight line, with points dense enough to bound the error between them.
#include <optional>
#include <vector>

#include "repath/drop_cutter.h"

namespace camber::repath {

/// How close the points lie.
struct OffsetPathOptions {
  double chord_mm = 0.001;      ///< largest distance between the path and its chords
  double increment_mm = 0.001;  ///< points nearer than half of this, seen from above, are not parted
  double step_mm = 0;           ///< > 0: points at this distance seen from above, whatever the chords do
};

struct OffsetPoint {
  Vec3 tip = Vec3::Zero();
  DropContact contact{};
};

/// The longest chord for which a cutter with this rounding, on its way between two places at which it is free, meets
/// nothing by more than chord_mm: l^2 = 8 r chord (a point outside both spheres of radius r is outside the sphere
/// between them but for the sagitta). Flat: the radius stands for r, which holds for what lies beside the cutter; what
/// it meets from above shows at the points.
double longest_chord_mm(const Underside& cutter, double chord_mm);

/// From `from` to `to`, both included. Chords are halved while they are longer than longest_chord_mm() or the path
/// halfway is farther from them than chord_mm; at walls until they stand upright. Empty where at a point nothing lies
/// under the cutter.
std::vector<OffsetPoint> offset_path(const DropCutter& part, const Vec2& from, const Vec2& to,
                                     const OffsetPathOptions& options);

}  // namespace camber::repath
