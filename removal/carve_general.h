#pragma once
// Cutting one tile with one stamp of a general cutter: carve.h for profiles that are no rounded cylinder.
#include "removal/carve.h"

namespace camber::removal {

/// As carve(), for any convex profile.
bool carve_general(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                   const CutterShape& shape, const CarveStamp& stamp);

/// As carve_bent(), for any convex profile.
bool carve_bent_general(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                        const EnvelopeGrid& envelope, const CarveStamp& stamp, const ShiftTable& shifts,
                        const CarveBend& bend);

}  // namespace camber::removal
