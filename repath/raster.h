#pragma once
// A finishing raster on the offset surface of a part: rows to and fro, and what links them.
#include <vector>

#include "repath/offset_path.h"
#include "repath/scallop.h"

namespace camber::repath {

struct RasterOptions {
  Rectangle boundary;        ///< in X and Y; where the cutter touches
  double direction_rad = 0;  ///< of the rows, from +X
  double scallop_mm = 0.005;
  double tolerance_mm = 0.005;             ///< of the program's path from the offset surface
  double increment_mm = 0.001;             ///< that the points are rounded to
  std::function<void(double)> progress{};  ///< called with the completed fraction of the rows; may be empty
};

/// A stretch of the raster as seen from above; the tip's height follows from the part.
struct Leg {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  bool link = false;  ///< from one row to the next
};

struct Raster {
  /// Between two of them the cutter is lifted to the clearance plane. The legs of each follow each other.
  std::vector<std::vector<Leg>> chains;
  RowSpacing spacing;
  std::size_t pieces = 0;  ///< of rows
  std::size_t links = 0;   ///< along the surface
};

/// Rows by space_rows(), each cut where the cutter touches inside the boundary, and a tenth of the radius farther where
/// it touches nothing outside there; gaps shorter than the diameter are
/// passed along the surface. Neighbouring rows are cut in opposite directions. From the end of a piece to the next one
/// it goes along the surface too where that is no farther than a diameter and does not dip by more than a radius below
/// its ends; else over the clearance plane. Empty chains: nothing of the part lies inside the boundary.
Raster make_raster(const DropCutter& part, const RasterOptions& options);

/// The tip's places along a chain, rounded to the increment, no two that follow each other alike. `step_mm` as in
/// OffsetPathOptions; 0: chords within 15 % of the tolerance.
std::vector<Vec3> points_of(const DropCutter& part, const std::vector<Leg>& chain, const RasterOptions& options,
                            double step_mm = 0);

/// What points_of() and its rounding leave of the tolerance to those who lay the path out again.
double tolerance_left_mm(const RasterOptions& options);

}  // namespace camber::repath
