#pragma once
// Which columns of a tile a stamp can still change: most of a finishing cutter's disc lies where another stamp has cut
// deeper.
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>

#include "removal/cutter.h"
#include "removal/field/tile.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Columns are the tile's rows of voxels along z, numbered i * kSide + j. Places count from the tile's voxel (0, 0, 0).
///
/// Each column remembers one stamp that has cut it. Another stamp of the same cutter changes no voxel that is not
/// nearer to it than to the first: for a ball on its shank nearer to the axis from the centre on upwards; for every
/// other cutter a tip that is neither lower nor nearer in the plane changes nothing. Nor does one that is not lower
/// where the first has its flat bottom and its wall is farther than the band.
class ColumnCover {
 public:
  static constexpr int kColumns = Tile::kSide * Tile::kSide;
  static constexpr int kLine = 24;  ///< columns of one i, filled up to whole vectors

  /// Tip and largest deflection of a stamp that is in the tile already; false: not known.
  using TipOf = std::function<bool(std::int32_t id, Vec3& tip_mm, double& deflection_mm)>;

  /// Reads a loaded tile: where air begins in each column, and a stamp that it names. `shrink_mm`: of the stamps, as
  /// SweepOptions has it.
  ColumnCover(const Tile& tile, const Index3& index, double voxel_mm, double band_mm, const CutterShape& shape,
              const TipOf& tip_of, double shrink_mm = 0);

  /// Radius around its axis in which a stamp leaves nothing to others that are not lower; negative: nowhere.
  static double covered_radius_mm(const CutterShape& shape, double band_mm, double shrink_mm);

  /// First voxel of the column from which on all are air.
  int top(int column) const { return top_[static_cast<std::size_t>(column)]; }
  const std::int16_t* tops(int i) const { return top_.data() + i * Tile::kSide; }  ///< from column (i, 0) on
  const float* tops_mm(int i) const {
    return top_mm_.data() + i * kLine;
  }  ///< the same, from voxel 0, mm; far below past the last
  bool all_air() const { return air_columns_ == kColumns; }
  Eigen::Vector3f from_origin(const Vec3& place_mm) const { return (place_mm - origin_mm_).cast<float>(); }

  /// Stamps may be displaced along the axis by up to this more against each other; it does not fall. What it lets pass
  /// of flat bottoms, half a micrometre, no chip shows.
  void allow_axial(double largest_mm) {
    constexpr double kPassed_mm = 5e-4;
    axial_slack_ = std::max(axial_slack_, static_cast<float>(2 * largest_mm - kPassed_mm));
  }
  /// The stamp that a column remembers.
  struct Remembered {
    bool known;
    Eigen::Vector3f tip;
    float deflection_mm;
  };
  Remembered remembered(int i, int j) const {
    const auto at = static_cast<std::size_t>(i * kLine + j);
    return {x_[at] < kNone, {x_[at], y_[at], z_[at]}, deflection_[at]};
  }

  /// Sets out[j] > 0 where a stamp with this tip may change column (i, j); `deflection_mm` bounds its deflection.
  /// Returns false if no column may change.
  bool changeable(int i, const Vec3& tip_mm, double deflection_mm, std::array<float, kLine>& out) const {
    return changeable(i, 0, kLine, from_origin(tip_mm), static_cast<float>(deflection_mm), out);
  }
  /// For columns j = first ... end - 1, whole vectors of 8; tips from the tile's voxel (0, 0, 0).
  bool changeable(int i, int first, int end, const Eigen::Vector3f& tip, float deflection_mm,
                  std::array<float, kLine>& out) const;
  /// As changeable(), for lines i_from ... i_to - 1 of a block and an undeflected stamp; line l is written from
  /// out[l * kLine] on. Returns one bit a line, the lowest for i_from.
  std::uint32_t changeable_lines(int i_from, int i_to, int first, int end, const Eigen::Vector3f& tip,
                                 float* out) const;
  /// As changeable(), with a stamp of its own for every column.
  bool changeable_each(int i, int first, int end, const float* x, const float* y, const float* z,
                       std::array<float, kLine>& out) const;

  /// Returns false if this stamp, coming right after the given one, can change nothing in the tile.
  bool changeable_after(const Vec3& before_mm, double before_deflection_mm, const Vec3& tip_mm,
                        double deflection_mm) const;

  /// After the stamp has been cut into the column: `changed` tells whether a voxel did.
  void cut(const Tile& tile, int i, int j, const Vec3& tip_mm, double deflection_mm, bool changed) {
    cut(tile, i, j, from_origin(tip_mm), static_cast<float>(deflection_mm), changed);
  }
  void cut(const Tile& tile, int i, int j, const Eigen::Vector3f& tip, float deflection_mm, bool changed);

 private:
  static constexpr float kNone = 1e9f;

  void lower_top(const Tile& tile, int column);
  bool covers_more(int i, int j, const Eigen::Vector3f& tip, float deflection_mm) const;

  float voxel_, band_, radius_, covered_radius_, axial_slack_ = 0;
  bool ball_;
  Vec3 origin_mm_;
  int air_columns_ = 0;
  std::array<float, Tile::kSide * kLine> x_, y_, z_, deflection_, top_mm_;
  std::array<std::int16_t, kColumns> top_;
};

/// The stamps that a stock names by their ids, first_id and on; `deflection_mm` bounds how far they leaned.
inline ColumnCover::TipOf tips_by_id(std::span<const Stamp> stamps, std::int32_t first_id, double deflection_mm) {
  return [=](std::int32_t id, Vec3& tip_mm, double& deflection) {
    if (id < first_id) return false;
    tip_mm = stamps[static_cast<std::size_t>(id - first_id)].pose.tip_mm;
    deflection = deflection_mm;
    return true;
  };
}

}  // namespace camber::removal::upright
