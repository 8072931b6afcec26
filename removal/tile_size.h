#pragma once
// The grain of the stock, for those who ask whether a tile is air or cut (Stock::is_air, is_solid, is_cut).

namespace camber::removal {

constexpr int kTileVoxels = 16;  ///< along an edge of a tile

}  // namespace camber::removal
