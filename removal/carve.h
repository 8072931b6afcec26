#pragma once
// Cutting one tile with one stamp: stock = max(stock, -cutter).
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "removal/column_cover.h"
#include "removal/cutter.h"
#include "removal/shift_table.h"
#include "removal/stock.h"

namespace camber::removal {

struct CarveStamp {
  Vec3 tip_mm = Vec3::Zero();
  std::int32_t id = 0;
  double shrink_mm = 0;  ///< the cutter is smaller by this along its normal
};

/// Bent envelope of one stamp.
struct CarveBend {
  static constexpr int kSectors = 32;
  const float* row = nullptr;
  double largest_mm = 0;  ///< bounds the length of every shift in the row
  /// By the direction from the axis, sector 0 from -pi: bounds how far a shift moves the envelope outwards there.
  std::array<float, kSectors> outward_mm{};
};

/// Bends of the stamps of one table.
class Bends {
 public:
  /// Both must outlive it.
  Bends(const EnvelopeGrid& envelope, const ShiftTable& shifts);
  CarveBend of(std::ptrdiff_t stamp) const;

 private:
  const ShiftTable& shifts_;
  int flutes_, spread_;
  int group_;                         ///< steps taken together: at most a degree
  std::vector<std::uint8_t> centre_;  ///< [node][group][flute]: the sector that the edge passes then
};

/// Carves with the undeflected cutter; true where a voxel changed. Values are clipped to +-band_mm.
bool carve(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
           const CutterShape& shape, const CarveStamp& stamp);

/// Carves with the envelope whose point (s, phi) is displaced by the shift of the instant at which an edge passes
/// it: the cutter's distance is read at x - delta(s, phi), where (s, phi) belong to x - delta (two fixed-point
/// steps: what is left is the square of the shift's slope, a quarter of a percent of it).
bool carve_bent(Tile& tile, ColumnCover& cover, const Index3& tile_index, double voxel_mm, double band_mm,
                const EnvelopeGrid& envelope, const CarveStamp& stamp, const ShiftTable& shifts, const CarveBend& bend);

/// Material in a tile's core, in voxels.
double material_voxels(const Tile& tile, double voxel_mm);

/// Lower bound of the distance between the cutter's envelope and any voxel of a tile.
double tile_distance_mm(const Index3& tile_index, double voxel_mm, const CutterShape& shape, const Vec3& tip_mm);

}  // namespace camber::removal
