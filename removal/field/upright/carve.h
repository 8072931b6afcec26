#pragma once
// Cutting one tile with one stamp: stock = max(stock, -cutter).
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/field/stamp_deflection.h"
#include "removal/field/tile.h"
#include "removal/field/upright/column_cover.h"
#include "removal/stock.h"

namespace camber::removal::upright {

struct CarveStamp {
  Vec3 tip_mm = Vec3::Zero();
  std::int32_t id = 0;
  double shrink_mm = 0;  ///< the cutter is smaller by this along its normal
};

/// Carves with the undeflected cutter; true where a voxel changed. Values are clipped to +-band_mm.
bool carve(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
           const CutterShape& shape, const CarveStamp& stamp);

/// Carves with the envelope whose point (s, phi) is displaced by the deflection of the instant at which an edge passes
/// it: the cutter's distance is read at x - delta(s, phi), where (s, phi) belong to x - delta, by fixed-point steps to
/// 0.05 um (removal/form_error/settling.h).
bool carve_deflected(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                     const EnvelopeGrid& envelope, const CarveStamp& stamp, const DeflectionTable& deflections,
                     const StampDeflection& deflection);

/// Material in a tile's core, in voxels.
double material_voxels(const Tile& tile, double voxel_mm);

/// Lower bound of the distance between the cutter's envelope and any voxel of a tile.
double tile_distance_mm(const Index3& tile_index, double voxel_mm, const CutterShape& shape, const Vec3& tip_mm);

/// carve() for any convex profile.
bool carve_general(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                   const CutterShape& shape, const CarveStamp& stamp);

/// carve_deflected() for any convex profile.
bool carve_deflected_general(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                             const EnvelopeGrid& envelope, const CarveStamp& stamp, const DeflectionTable& deflections,
                             const StampDeflection& deflection);

/// The deflection s of the envelope's point that is displaced to a place, s = deflection(place - s), by steps from a
/// first guess. `row`: as those of `deflections`.
Vec3 settled_deflection(const EnvelopeGrid& envelope, const DeflectionTable& deflections, const float* row,
                        const Vec3& from_tip, Vec3 guess);

}  // namespace camber::removal::upright
