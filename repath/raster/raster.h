#pragma once
// A finishing raster on the offset surface of a part: rows to and fro, and what links them.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "machine/tool.h"
#include "nc/dialect.h"
#include "repath/raster/drop_cutter.h"
#include "repath/raster/scallop.h"

namespace camber::repath {

// Tip path over a part along a straight line, with points dense enough to bound the error between them.

/// How close the points lie.
struct OffsetPathOptions {
  double chord_mm = 0.001;      ///< largest distance between the path and its chords
  double increment_mm = 0.001;  ///< points nearer than half of this, seen from above, are not parted
  double step_mm = 0;           ///< > 0: points at this distance seen from above, whatever the chords do
};

struct OffsetPoint {
  Vec3 tip = Vec3::Zero();
  DropContact contact{};
};

/// The longest chord for which a cutter with this rounding, on its way between two places at which it is free, meets
/// nothing by more than chord_mm: l^2 = 8 r chord (a point outside both spheres of radius r is outside the sphere
/// between them but for the sagitta). Flat: the radius stands for r, which holds for what lies beside the cutter; what
/// it meets from above shows at the points.
double longest_chord_mm(const Underside& cutter, double chord_mm);

/// From `from` to `to`, both included. Chords are halved while they are longer than longest_chord_mm() or the path
/// halfway is farther from them than chord_mm; at walls until they stand upright. Empty where at a point nothing lies
/// under the cutter.
std::vector<OffsetPoint> offset_path(const DropCutter& part, const Vec2& from, const Vec2& to,
                                     const OffsetPathOptions& options);

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

// A raster as an NC program.

struct RasterProgram {
  nc::Dialect dialect = nc::default_dialect();
  machine::Tool tool{};
  double spindle_rpm = 0, feed_mm_per_min = 0;
  double clearance_mm = 0;     ///< Z of moves from chain to chain
  double lead_in_mm = 0;       ///< feed begins so far above a chain's first point ...
  double lead_in_from_mm = 0;  ///< ... or at this Z, whichever is higher; never above the clearance plane
  int decimals = 3;
};

/// The whole program: header, tool change, length offset, spindle; each chain (of two points at least) led in straight
/// down at a third of the feed and left straight up in rapid; M30. It has an O number if the
/// dialect has program numbers.
std::string raster_text(const RasterProgram& program, std::span<const std::vector<Vec3>> chains);

}  // namespace camber::repath
