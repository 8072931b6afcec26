#pragma once
// Cutting one tile with one stamp of a general cutter: carve.h for profiles that are no rounded cylinder.
#include "removal/field/upright/carve.h"

namespace camber::removal::upright {

/// As carve(), for any convex profile.
bool carve_general(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                   const CutterShape& shape, const CarveStamp& stamp);

/// As carve_deflected(), for any convex profile.
bool carve_deflected_general(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                             const EnvelopeGrid& envelope, const CarveStamp& stamp, const DeflectionTable& deflections,
                             const StampDeflection& deflection);

/// The deflection s of the envelope's point that is displaced to a place, s = deflection(place - s), by steps from a
/// first guess. `row`: as those of `deflections`.
Vec3 settled_deflection(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                        const Vec3& from_tip, Vec3 guess);

}  // namespace camber::removal::upright
