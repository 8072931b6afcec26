#pragma once
// Which chips the points of a patch take from a tile: the depth of the stock below them, and what the motion allows.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/engage/upright/bend_memory.h"
#include "removal/engage/upright/patch_lanes.h"
#include "removal/engagement.h"
#include "removal/field/tile.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// A tile as it stands, and as the blank was there; null where the blank is solid all over.
struct TileStocks {
  const Tile* now = nullptr;
  const float* blank = nullptr;
};

/// Reads for one stretch. How depth and chip are defined: removal/engagement.h.
class ChipReader {
 public:
  /// `all`: the stamps that ids in the stock count from `first_id`; `stamps`: those of the stretch. Rows of
  /// `deflections` are read as they stand; `memory` has those of stamps that were cut.
  ChipReader(const EnvelopeGrid& envelope, const PatchLanes& lanes, std::span<const Stamp> all,
             std::span<const Stamp> stamps, std::int32_t first_id, double voxel_mm, const DeflectionTable& deflections,
             const BendMemory& memory);

  /// How much more than its motion allows a point of stamp k may take, since the stamp before was deflected otherwise
  /// when it left the surface there, at another rotation step.
  float reach_mm(std::size_t k) const;
  /// Appends the chips that stamp k takes in this tile with the points of a patch. Points that the motion leads into
  /// the material, or out of it by less than `reach_mm`, and that lie out of it by less than kNear_mm along the normal,
  /// tell that by a negative thickness.
  void read(const TileStocks& stocks, const Index3& tile, std::int32_t k, float reach_mm, std::uint32_t patch,
            std::vector<DeflectedChipSample>& out) const;

 private:
  struct Cell;
  /// What the kernels ask of a stamp, and the voxel from which it is told.
  struct VoxelPlace {
    StampView view;
    Index3 base;
  };
  VoxelPlace place_of(std::size_t k) const;
  /// Of the stock below a point.
  struct Depth {
    float mm;
    std::array<float, 2> deeper;  ///< by a deflection in x and y
  };
  /// `bend`: of the point itself.
  Depth depth(const TileStocks& stocks, const Cell& cell, const Vec3& normal, const Vec2& deflection) const;
  void place_corners(const TileStocks& stocks, const Cell& cell, CornerLanes& corners) const;
  Thinnest thinnest_general(CornerLanes& corners) const;

  const EnvelopeGrid& envelope_;
  const PatchLanes& lanes_;
  PointLanes view_;
  std::span<const Stamp> all_, stamps_;
  std::int32_t first_id_;
  double voxel_mm_;
  const DeflectionTable& deflections_;
  const BendMemory& memory_;
  float node_step_mm_;
  const Kernels& kernels_;
  std::vector<VoxelPlace> places_;   ///< of the stretch's stamps
  std::vector<float> wall_half_mm_;  ///< of the rings (removal/engage/upright/level_faces.h)
};

}  // namespace camber::removal::upright
