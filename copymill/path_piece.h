#pragma once
// Pieces of a path, lines and arcs: what the control runs and what the program says.
#include <vector>

#include "base/geometry.h"
#include "copymill/pass.h"

namespace camber::copymill {

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

/// The stretch of a piece from one place on it to another, both rounded to increments.
PathPiece part_of(const PathPiece& piece, double from_mm, double to_mm, double increment_mm);

Vec3 rounded(const Vec3& p, double increment_mm);

/// Points, rounded to increments, as few lines and arcs (repath/fit.h); steep stretches stay lines from point to point.
std::vector<PathPiece> pieces_of(const std::vector<Vec3>& points, bool closed, const PieceOptions& options);

}  // namespace camber::copymill
