#pragma once
// The inner loops of engagement and deflected carving, in vectors as wide as the processor has them. Every lane does
// the same operations in the same order whatever the width, so results do not depend on it.
#include <cstdint>

#include "removal/simd/upright_block_kernels.h"

namespace camber::removal::upright {

/// Deflections of a stamp, mm, as a row of DeflectionTable.
struct DeflectionRow {
  const float* now = nullptr;     ///< null: the undeflected cutter
  const float* before = nullptr;  ///< row of the stamp before
  int nodes = 0, steps = 0;
  float node_step_mm = 1;
  bool axial = false;  ///< the row has axial deflections
};

/// Envelope points side by side (see removal/engage/upright/patch_lanes.h): the arrays hold whole vectors of kLanes.
struct PointLanes {
  const float *x, *y, *z, *nx, *ny, *nz, *cos_phi, *sin_phi, *k1, *k2;
  const float *sine, *cosine, *per_radius, *upper_fraction;
  const std::int32_t *lower, *step;  ///< node below, rotation step
};

/// Deflection of a stamp's cutter, and the limits that follow for its points.
struct StampBend {
  DeflectionRow deflection;
  float lag_per_mm;
  float per_rad;      ///< rotation steps / (4 pi)
  float max_tilt_mm;  ///< largest tilt of the deflected envelope along the motion
  float reach_mm;     ///< points whose motion allows more than -reach_mm times their normal's lateral part are read
  float axial_reach_mm = 0;  ///< added to this limit: the same for the axial part of the normal
};

/// A stamp of any pose in the arena.
struct TiltedPlace {
  StampPlace tip;        ///< its motion in the tool's frame
  float turn_rad[3];     ///< rotation of the tool since the stamp before, in its frame
  float voxels[3][3];    ///< from the tip along each of the part's axes, by mm along the tool's x, y and z
  float max_tilt;        ///< largest tilt of the deflected envelope for each mm of motion
  float min_cap_per_mm;  ///< a point whose motion allows no more than this times its square makes no chip
};

/// Values read at each point.
struct LaneReading {
  static constexpr int kMax = 64;
  alignas(64) float cap[kMax];          ///< thickest chip that the motion allows, mm
  alignas(64) float field[kMax];        ///< trilinear distance at the point, mm
  alignas(64) float fraction[3][kMax];  ///< place of the point in its cell
  alignas(64) std::int32_t cell[kMax];  ///< its cell's lowest voxel in the arena; -1: no chip
};

/// Points, each against one of the stamps whose fields meet in its cell. The lists are read and written up to a
/// multiple of 8.
struct PairLanes {
  int count;
  float *x, *y, *z;                          ///< from the stamp's tip, mm; out: less the stamp's deflection there
  const float *nx, *ny, *nz;                 ///< normal of the point
  const float *guess_x, *guess_y, *guess_z;  ///< first guess of the deflection, mm; 0 where it is not known
  const float* known;                        ///< 1: the stamp's deflections are in `rows`, else 0
  const std::int32_t* row;                   ///< there: first pair
  const float* farther;                      ///< how much farther out than that cutter's the surface lies, mm
  DeflectionRow rows;                        ///< `now`: of many stamps; null: of none
  float lag_per_mm, steps_per_rad;
  float* thickness;  ///< out, mm
};

/// A line of a tile's columns (removal/field/upright/column_cover.h), all with the same x, against a rounded cylinder.
struct LineCut {
  static constexpr int kColumns = 17, kLine = 24;  ///< as Tile::kSide and ColumnCover::kLine
  float* distance;                                 ///< [kColumns][kColumns] of the line
  std::int32_t* stamp;                             ///< the same of the ids
  const float* changeable;                         ///< [kLine], > 0: the column may change
  const std::int16_t* top;                         ///< [kColumns], first voxel of the air above
  int first = 0, end = kColumns;                   ///< columns
  std::int32_t id;
  int lowest;         ///< no voxel below is reached
  float dx, dy, z;    ///< place of voxel 0 of column 0 from the tip, mm
  float voxel, band;  ///< mm
  float flat, corner, shrink;
};

/// Places of stamps in a tile, from its voxel (0, 0, 0), mm.
struct TipLanes {
  const float *x, *y, *z;
};

/// A line of columns, from column `first` up to `end` (whole vectors of 8), and for each of them the stamp that goes
/// deepest at `z`.
struct LineSearch {
  int first, end;
  TipLanes tips;
  const std::int32_t* which;  ///< [count] of the tips
  int count;
  float x, voxel;  ///< mm, of the line; between columns
  const float* z;  ///< [LineCut::kLine], mm
  float flat, corner;
  float band;                    ///< stamps that are farther in than this leave the same air
  float *tip_x, *tip_y, *tip_z;  ///< [LineCut::kLine], out
  std::int32_t* winner;          ///< [LineCut::kLine], out: index of a tip
};

/// The addition for a deflected cutter.
struct LineDeflection {
  DeflectionRow deflection;
  float largest_mm;         ///< largest deflection of the row
  float axial_mm;           ///< the largest along the axis
  const float* outward_mm;  ///< by sector, StampDeflection::kSectors of them
  int sectors;
  float lag_per_mm, steps_per_rad;
};

/// Columns of a line as bits.
struct LineResult {
  std::uint32_t tried = 0, changed = 0;
};

struct Kernels {
  int lanes;
  /// `count`: a multiple of 8, at most LaneReading::kMax.
  void (*read_points)(const PointLanes& points, int from, int count, const StampPlace& stamp, const StampBend& bend,
                      const ArenaView& arena, LaneReading& out);
  void (*read_tilted_points)(const PointLanes& points, int from, int count, const TiltedPlace& stamp,
                             const StampBend& bend, const ArenaView& arena, LaneReading& out);
  /// Thickness of what a rounded cylinder left at a stamp, along the point's normal: distance over slope, the slope at
  /// least `min_slope`; at most 0 where it has cut the point away.
  void (*thin_pairs)(const PairLanes& pairs, float flat, float corner, float min_slope);
  /// stock = max(stock, -cutter), at most band; voxels that change take the id.
  LineResult (*cut_line)(const LineCut& line);
  LineResult (*cut_line_deflected)(const LineCut& line, const LineDeflection& deflection);
  /// As cut_line, with a stamp of its own for every column, as LineSearch has found them; `x` of the line; ids are
  /// line.id + winner.
  LineResult (*cut_winners)(const LineCut& line, const LineSearch& search, const std::int32_t* id_of_tip);
  void (*find_winners)(const LineSearch& search);
};

/// Returns the kernels for the widest vectors of this processor.
const Kernels& kernels();
extern const Kernels kBaseKernels;  ///< on every processor
#if defined(__x86_64__)
extern const Kernels kAvx2Kernels;
#endif

}  // namespace camber::removal::upright
