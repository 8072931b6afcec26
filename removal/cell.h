#pragma once
// Reading a tile between its voxels: what both readers of chips (chip_reader, block_reader) share.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "removal/cutter.h"
#include "removal/stamp.h"
#include "removal/stock.h"

namespace camber::removal {

/// A depth of more than this share of what the last motion allows ends at the surface of the tooth before.
constexpr float kNearCap = 0.8f;

/// A surface that the normal meets at a grazing angle is taken at no more than twenty times its distance.
constexpr float kLeastSlope = 0.05f;

inline float slope(double along_normal) {
  return static_cast<float>(std::clamp(along_normal, static_cast<double>(kLeastSlope), 1.0));
}

/// Offset of corner c, 0 ... 7, of a cell from its lowest voxel; bit a of c goes along axis a.
constexpr int cell_corner(int c) { return Tile::offset(c & 1, c >> 1 & 1, c >> 2 & 1); }

/// Place in a cell, from its lowest voxel, in voxels.
using CellShare = std::array<float, 3>;

inline float corner_weight(int c, const CellShare& f) {
  return (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
}

/// `lowest`: the cell's lowest voxel in a tile.
inline float trilinear(const float* lowest, const CellShare& f) {
  float sum = 0;
  for (int c = 0; c < 8; ++c) sum += corner_weight(c, f) * lowest[cell_corner(c)];
  return sum;
}
Vec3 trilinear_gradient(const float* lowest, const CellShare& f, double voxel_mm);

/// Half the widths of an envelope's rings that stand upright, mm; 0 for the others.
std::vector<float> wall_half_widths_mm(const EnvelopeGrid& envelope);

/// Where a ring of the cutter's wall may be cut in two by level faces.
struct RingPlace {
  const float* blank;        ///< lowest voxel of the point's cell in the blank; null: solid
  const std::int32_t* ids;   ///< the same of the stamps that the stock's voxels name
  CellShare share;           ///< of the point in its cell
  Vec3 point_mm, normal;     ///< of the envelope
  double half_width_mm = 0;  ///< of the ring
};

/// Part of the ring's width that lies in material, up and down from its point, mm; nothing where from >= to.
struct RingPart {
  double from_mm, to_mm;
  /// In 255ths of the ring's width.
  std::uint8_t cut_255(double half_width_mm) const;
  double middle_mm() const { return (from_mm + to_mm) / 2; }
};

/// Level faces are the blank's, and the floors cut by the stamps that the cell names: id - first_id of `stamps`.
RingPart part_in_material(const RingPlace& ring, std::span<const Stamp> stamps, std::int32_t first_id,
                          const CutterShape& shape, double voxel_mm);

}  // namespace camber::removal
