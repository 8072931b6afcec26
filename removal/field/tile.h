#pragma once
// A dense working copy of a cube of the stock's voxels.
#include <array>
#include <cstdint>

#include "removal/stock.h"

namespace camber::removal {

/// A dense working copy of a cube of voxels: `kCore` a side that the tile owns and one layer above (towards
/// +x, +y, +z) of its neighbours', so that every trilinear cell of the core is whole.
struct Tile {
  static constexpr int kCore = kTileVoxels;
  static constexpr int kSide = kCore + 1;
  static constexpr int kVolume = kSide * kSide * kSide;
  std::array<float, kVolume> distance;
  std::array<std::int32_t, kVolume> stamp;  ///< -1: not cut

  static constexpr int offset(int i, int j, int k) { return (i * kSide + j) * kSide + k; }
};

}  // namespace camber::removal
