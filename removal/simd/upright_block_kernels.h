#pragma once
// The inner loops of engagement with the undeflected cutter, in vectors as wide as the processor has them. Every lane
// does the same operations in the same order whatever the width, so results do not depend on it.
#include <cstdint>

namespace camber::removal::upright {

/// Envelope points side by side, eight a block (removal/engagement.h).
struct BlockPoints {
  const float *x, *y, *z, *nx, *ny, *nz, *cos_phi, *sin_phi, *k1, *k2;
  const float* wall_half;  ///< half the ring's width (removal/engage/upright/level_faces.h), mm
};

/// The blocks: their points lie around the centre, with normals that differ from the mean one by no more than `spread`.
struct BlockBounds {
  int count;  ///< a multiple of 8
  const float *x, *y, *z;
  const float* bottom;  ///< height of the lowest of the points
  const float* reach;   ///< if the voxel nearest to the centre has more than this, all points are in air, mm
  const float *nx, *ny, *nz, *spread;
  /// Largest component of the normals across the axis, and largest curvature, 1/mm, of blocks whose stamps are
  /// deflected; else null.
  const float *lateral = nullptr, *curvature = nullptr;
  static constexpr float kLevel =
      0.05f;  ///< below this lateral part a point counts as level: its envelope does not lean
};

/// Tiles with numbers. Tile number 0 is air, for what has none.
struct ArenaView {
  const float* distance;      ///< values of tile 0
  const std::int32_t* stamp;  ///< values of tile 0
  std::int32_t stride;        ///< from one tile to the next, values
  const std::int32_t* slot;   ///< [n[0]][n[1]][n[2]]
  std::int32_t n[3];
  const std::int32_t* top;  ///< TopMap::heights
};

/// A stamp in the arena.
struct StampPlace {
  std::int32_t base[3];  ///< voxel below the tip, from the first of the arena
  float fraction[3];     ///< place of the tip in its voxel, voxels
  float per_voxel;       ///< 1 / voxel_mm
  float feed_mm[3];      ///< motion since the stamp before
  float feed_length_mm;
  float min_forward_mm;  ///< a block whose normals all go along the motion by less than this makes no chip
  float min_cap_mm;      ///< nor does a point whose motion allows no more than this; <= 0
  float lateral_mm = 0;  ///< how much farther a deflected cutter's points may go into the material across the axis
  float tilt_mm = 0;     ///< how much more it may, since its envelope leans
  float slack_mm = 0;    ///< how far points may lie from where the block has them
  float axial_mm = 0;    ///< their part along the axis; and how much farther they may go into the material along it
};

/// Points whose chip the fields of the stamps around decide.
struct ShallowPoints {
  int count;
  std::int32_t* lane;  ///< index into BlockPoints
  std::int32_t* cell;  ///< lowest voxel of its cell in the arena
  float* cap;          ///< thickest chip that the motion allows, mm
  float* share[3];     ///< place in the cell
  std::int32_t* hit;   ///< which of the blocks that cut, times 8, plus the lane in it
};

/// Blocks that cut; room for all.
struct BlockHits {
  int count;
  std::uint32_t* block;
  std::uint32_t* deep;  ///< bits: deeper in material than the motion allows a chip to be thick
  float* thickness;     ///< [8] each: of the deep points, else 0
};

/// Tips of stamps in steps of `step_mm`.
struct FixedTips {
  const std::int32_t *x, *y, *z;
  std::int32_t own[3];  ///< tip of the stamp that reads
  float step_mm;
  std::int32_t first_id;  ///< id of tip 0; smaller ids have none
};

/// Points that the blank's surface may be near; the lists are read up to a multiple of 8.
struct BlankPoints {
  int count;
  const float* blank;        ///< distances, from the first tile of the arena on
  const std::int32_t* lane;  ///< index into BlockPoints
  const std::int32_t* cell;  ///< lowest voxel of each point's cell
  const float* share[3];     ///< place in the cell
  float voxel_mm, min_slope;
  float* thickness;  ///< in: of what is below the stamps' surfaces, mm; out: the blank's surface counts too
};

struct BlockKernels {
  /// Lists the blocks that may cut. Returns their number.
  int (*find_blocks)(const BlockBounds& bounds, const StampPlace& stamp, const ArenaView& arena, std::int32_t* out);
  /// `air_mm`: fields above it are in air for sure. Points of walls that are no deeper than half their ring's width
  /// are shallow.
  void (*read_blocks)(const BlockPoints& points, const std::int32_t* blocks, int count, const StampPlace& stamp,
                      const ArenaView& arena, float air_mm, BlockHits& hits, ShallowPoints& shallow);
  /// Thickness of what rounded cylinders left at shallow points: Kernels::thinnest of the eight corners of each cell.
  /// The lists are read and out is written up to a multiple of 8. No stamp in sight: 1e30.
  void (*thin_points)(const BlockPoints& points, const ShallowPoints& shallow, const ArenaView& arena,
                      const FixedTips& tips, float flat, float corner, float min_slope, float* out);
  /// The blank's surface as one field more, read trilinearly: distance over slope.
  void (*thin_by_blank)(const BlockPoints& points, const BlankPoints& at);
};

/// Those of the widest vectors that this processor has.
const BlockKernels& block_kernels();
extern const BlockKernels kBaseBlockKernels;  ///< on every processor
#if defined(__x86_64__)
extern const BlockKernels kAvx2BlockKernels;
#endif

}  // namespace camber::removal::upright
