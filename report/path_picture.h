#pragma once
// A program's path as points for a picture, arcs and lines told apart.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "nc/move.h"

namespace camber::report {

/// What leads to a point.
enum class PathKind : std::uint8_t { start, rapid, line, arc, kept_line, kept_arc };

struct PathPicture {
  std::vector<Vec3> points;
  std::vector<PathKind> kind;        ///< of the way to each point
  std::vector<std::uint32_t> block;  ///< that makes it
  std::vector<std::uint8_t> ends;    ///< 1: a block ends at the point
  double chord_mm = 0;               ///< the picture lies within this of the path
  bool thinned = false;              ///< points of blocks were left out, so `ends` does not say where all blocks end
};

/// Stretches of blocks, first and last, ascending, that were rewritten; what lies outside is `kept`.
using BlockRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Arcs become chords within a part of the picture's size that no eye sees. Above `max_points` points those are left
/// out that lie within a distance of the chord between the ones that stay; the distance is doubled until no more than
/// `max_points` are left. Corners beyond it so always stay, and the outermost places to within it. Linear in the number
/// of moves.
PathPicture path_picture(const nc::Interpretation& program, const BlockRanges& rewritten, std::size_t max_points);

}  // namespace camber::report
