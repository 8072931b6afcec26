#pragma once
// Which chips the points of a patch take from a tile: the depth of the stock below them, and what the motion allows.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/chip.h"
#include "removal/cutter.h"
#include "removal/patch_lanes.h"
#include "removal/shift_table.h"
#include "removal/stamp.h"
#include "removal/stock.h"

namespace camber::removal {

/// Bent envelopes lean by no more than this (a shift that jumps at an edge's entry is no slope).
constexpr double kMostTilt = 0.3;

/// How far out of the material a sample is told of.
constexpr float kNear_mm = 0.1f;

/// What a point takes with the bend it has, and how that changes as it bends on.
struct BentChip {
  Chip chip;           ///< its thickness: the lesser of the next two, negative for a point out of the material
  float depth_mm = 0;  ///< of the stock below the point, against the normal
  float cap_mm = 0;    ///< what the motion allows
  /// Change of the depth with a shift, and of the cap, by x and y.
  std::array<float, 2> deeper{}, wider{};
};

/// A tile as it stands, and as the blank was there; null where the blank is solid all over.
struct TileStocks {
  const Tile* now = nullptr;
  const float* blank = nullptr;
};

/// Reads for one stretch. How depth and chip are defined: removal/stretch.h.
class ChipReader {
 public:
  /// `all`: the stamps that ids in the stock count from `first_id`; `stamps`: those of the stretch. Rows of `shifts`
  /// are read as they stand.
  ChipReader(const EnvelopeGrid& envelope, const PatchLanes& lanes, std::span<const Stamp> all,
             std::span<const Stamp> stamps, std::int32_t first_id, double voxel_mm, const ShiftTable& shifts);

  /// Appends the chips that stamp k takes in this tile with the points of a patch. Points that the motion leads into
  /// the material, and that lie out of it by less than kNear_mm along the normal, tell that by a negative thickness.
  void read(const TileStocks& stocks, const Index3& tile, std::int32_t k, std::uint32_t patch,
            std::vector<BentChip>& out) const;

 private:
  struct Cell;
  /// What the kernels ask of a stamp, and the voxel from which it is told.
  struct Place {
    StampView view;
    Index3 base;
  };
  Place place_of(std::size_t k) const;
  /// Of the stock below a point.
  struct Depth {
    float mm;
    std::array<float, 2> deeper;  ///< by a shift in x and y
  };
  Depth depth(const TileStocks& stocks, const Cell& cell, const Vec3& normal) const;
  Thinnest thinnest_general(const Vec3& normal, const std::array<Vec3, 8>& tip, const CornerLanes& corners) const;

  const EnvelopeGrid& envelope_;
  const PatchLanes& lanes_;
  PointLanes view_;
  std::span<const Stamp> all_, stamps_;
  std::int32_t first_id_;
  double voxel_mm_;
  const ShiftTable& shifts_;
  const Kernels& kernels_;
  std::vector<Place> places_;        ///< of the stretch's stamps
  std::vector<float> wall_half_mm_;  ///< of the rings (removal/level_faces.h)
};

}  // namespace camber::removal
