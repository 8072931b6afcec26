#pragma once
// Which chips the points of a patch take from a tile: the depth of the stock below them, and what the motion allows.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/patch_lanes.h"
#include "removal/shift_table.h"
#include "removal/stamp.h"
#include "removal/stock.h"
#include "removal/stretch.h"

namespace camber::removal {

struct StampChip {
  std::int32_t stamp;
  Chip chip;
};

/// Bent envelopes lean by no more than this (a shift that jumps at an edge's entry is no slope).
constexpr double kMostTilt = 0.3;

/// A tile as it stands, and as the blank was there; null where the blank is solid all over.
struct TileStocks {
  const Tile* now = nullptr;
  const Tile* blank = nullptr;
};

/// Reads for one stretch. How depth and chip are defined: removal/stretch.h.
class ChipReader {
 public:
  /// `all`: the stamps that ids in the stock count from `first_id`; `stamps`: those of the stretch.
  ChipReader(const EnvelopeGrid& envelope, const PatchLanes& lanes, std::span<const Stamp> all,
             std::span<const Stamp> stamps, std::int32_t first_id, double voxel_mm, const ShiftTable* shifts);

  /// Appends the chips that stamp k takes in this tile with the points of a patch.
  void read(const TileStocks& stocks, const Index3& tile, std::int32_t k, std::uint32_t patch,
            std::vector<StampChip>& out) const;

 private:
  struct Cell;
  /// What the kernels ask of a stamp, and the voxel from which it is told.
  struct Place {
    StampView view;
    Index3 base;
  };
  Place place_of(std::size_t k) const;
  float thickness(const TileStocks& stocks, const Cell& cell, const Vec3& normal) const;
  float thinnest_general(const Vec3& normal, const std::array<Vec3, 8>& tip, const CornerLanes& corners) const;

  const EnvelopeGrid& envelope_;
  const PatchLanes& lanes_;
  PointLanes view_;
  std::span<const Stamp> all_, stamps_;
  std::int32_t first_id_;
  double voxel_mm_;
  const ShiftTable* shifts_;
  const Kernels& kernels_;
  std::vector<Place> places_;        ///< of the stretch's stamps
  std::vector<float> wall_half_mm_;  ///< of the rings (removal/level_faces.h)
};

}  // namespace camber::removal
