#pragma once
// A batch of undeflected stamps in a tile, in the order that is least work.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/field/upright/column_cover.h"
#include "removal/simd/upright_kernels.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Cuts a tile by many stamps, of which few change it. The tile is divided into four blocks of columns. Each block
/// skips stamps that cannot cut below the deepest one, or below what its middle column remembers (ColumnCover). Then
/// every column is cut by the remaining stamp that goes deepest near its surface, and by another one only where that
/// may go deeper somewhere. For rounded cylinders only (ball, flat and bull-nose).
class BatchCut {
 public:
  BatchCut(const CutterShape& shape, double voxel_mm, double band_mm, double shrink_mm);

  /// Cuts stamps[k] of all k of the batch; their ids are first_id + k. Returns true if a voxel changed.
  bool cut(Tile& tile, ColumnCover& cover, std::span<const Stamp> stamps, std::span<const std::int32_t> batch,
           std::int32_t first_id);

 private:
  /// Columns i_from ... i_to - 1 by j_from ... j_to - 1, up to voxel layer `top`.
  struct Block {
    int i_from, i_to, j_from, j_to;
    float top_mm;
  };
  void find_candidates(const ColumnCover& cover, const Block& block, float z_mm);
  void keep_positive();
  bool cut_block(Tile& tile, ColumnCover& cover, const Block& block, std::int32_t first_id);
  bool update(const Tile& tile, ColumnCover& cover, int i, const LineResult& result, const float* x, const float* y,
              const float* z, int stride) const;

  const CutterShape& shape_;
  float voxel_, band_, shrink_;
  const Kernels& kernels_;
  std::vector<float> x_, y_, z_;  ///< tips from the tile's voxel (0, 0, 0)
  std::vector<std::int32_t> id_;  ///< index of each
  std::vector<std::int32_t> candidates_;
  std::vector<float> cx_, cy_, cz_, low_, margin_;  ///< values of the candidates
};

}  // namespace camber::removal::upright
