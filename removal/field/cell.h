#pragma once
// Reading a tile between its voxels, and what makes a depth there a chip's thickness: for both readers of chips
// (chip_reader, block_reader).
#include <algorithm>
#include <array>

#include "base/geometry.h"
#include "removal/field/tile.h"
#include "removal/stock.h"

namespace camber::removal {

/// Rigid coupling: chips that are no thicker count as none, mm. An axis under a position loop comes to rest like e^-t:
/// a flat bottom then goes down by less and less, and, far below what a field resolves, would carry the edge force of
/// its whole length for as long as a double still falls. No scale of a machine shows ten nanometres a tooth.
constexpr float kThinnestChip_mm = 1e-5f;

/// A depth of more than this share of what the last motion allows ends at the surface of the tooth before.
constexpr float kNearCap = 0.8f;

/// Least slope: a surface that the normal meets at a grazing angle counts at up to twenty times its distance.
constexpr float kMinSlope = 0.05f;

inline float slope(double along_normal) {
  return static_cast<float>(std::clamp(along_normal, static_cast<double>(kMinSlope), 1.0));
}

/// Offset of corner c, 0 ... 7, of a cell from its lowest voxel; bit a of c goes along axis a.
constexpr int cell_corner(int c) { return Tile::offset(c & 1, c >> 1 & 1, c >> 2 & 1); }

/// Position in a cell, from its lowest voxel, in voxels.
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

}  // namespace camber::removal
