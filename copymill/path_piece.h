#pragma once
// Pieces of a path, lines and arcs: what the control runs and what the program says.
#include <functional>
#include <vector>

#include "base/geometry.h"

namespace camber::copymill {

/// A pass at one level, seen from above. Closed: the first point is not repeated.
struct FlatPass {
  std::vector<Vec2> points;
  bool closed = false;
};

/// A pass in space.
struct Pass {
  std::vector<Vec3> points;
  bool closed = false;
};

Pass at_height(const FlatPass& pass, double z_mm);
FlatPass reversed(FlatPass pass);
Pass reversed(Pass pass);
/// Begins a closed pass at the point nearest to a place; an open one is left as it is.
void start_near(Pass& pass, const Vec3& place);
double length_mm(const Pass& pass);
/// Returns the points of a pass with further ones between them, at most `step_mm` apart.
std::vector<Vec3> dense(const Pass& pass, double step_mm);
/// Returns the stretches of a pass whose points, `step_mm` apart, are `wanted`, `lead_mm` longer at either end; gaps
/// shorter than `join_mm` are included. A pass that is wanted everywhere stays as it is.
std::vector<Pass> stretches(const Pass& pass, double step_mm, const std::function<bool(const Vec3&)>& wanted,
                            double lead_mm, double join_mm);
/// Returns the distance of a place from the polyline through the points.
double distance_mm(const std::vector<Vec3>& line, const Vec3& place);

/// A piece from one place to another: a line, or an arc in a level plane.
struct PathPiece {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  bool arc = false;
  Vec2 centre = Vec2::Zero();
  double sweep_rad = 0;  ///< counter-clockwise positive
  double length_mm = 0;

  double radius_mm() const { return (from.head<2>() - centre).norm(); }
  Vec3 at(double along_mm) const;
  Vec3 direction(double along_mm) const;
};

PathPiece line_piece(const Vec3& from, const Vec3& to);

/// Tolerance and increment of the pieces.
struct PieceOptions {
  double tolerance_mm = 0.002;  ///< largest distance of lines and arcs from the points
  double increment_mm = 0.001;
};

/// Returns the part of a piece from one length along it to another, both ends rounded to increments.
PathPiece part_of(const PathPiece& piece, double from_mm, double to_mm, double increment_mm);

Vec3 rounded(const Vec3& p, double increment_mm);

/// Fits few lines and arcs to points, rounded to increments (repath/compress/fit.h); steep stretches stay lines between
/// points.
std::vector<PathPiece> pieces_of(const std::vector<Vec3>& points, bool closed, const PieceOptions& options);

}  // namespace camber::copymill
