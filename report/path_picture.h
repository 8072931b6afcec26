#pragma once
// A program's path as points for a picture, lines and arcs distinguished.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "nc/move.h"

namespace camber::report {

/// Kind of the motion that leads to a point.
enum class PathKind : std::uint8_t { start, rapid, line, arc, kept_line, kept_arc };

struct PathPicture {
  std::vector<Vec3> points;
  std::vector<PathKind> kind;           ///< kind of the way to each point
  std::vector<std::uint32_t> block;     ///< that makes it
  std::vector<std::uint8_t> ends;       ///< 1: a block ends at the point
  std::vector<std::uint32_t> tool;      ///< in the spindle; empty: not asked for
  std::vector<float> feed_mm_per_min;   ///< programmed; NaN: of rapids; empty: not asked for
  std::vector<float> speed_mm_per_min;  ///< mean over the way to the point as the control plans it; empty: no machine
  double chord_mm = 0;                  ///< the picture lies within this of the path
  double feed_step_mm_per_min = 0;      ///< feeds of what was left out lie within this of those drawn
  bool thinned = false;                 ///< points of blocks were left out, so `ends` does not say where all blocks end
};

/// Stretches of blocks, first and last, ascending, that were rewritten; what lies outside is `kept`.
using BlockRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Arcs become chords within a part of the picture's size that no eye sees. Above `max_points` points those are left
/// out that lie within a distance of the chord between the ones that stay; the distance is doubled until no more than
/// `max_points` are left. Corners beyond it so always stay, and the outermost places to within it. Linear in the number
/// of moves.
PathPicture path_picture(const nc::Interpretation& program, const BlockRanges& rewritten, std::size_t max_points);

/// The whole program, nothing rewritten, with tools and programmed feeds.
PathPicture program_picture(const nc::Interpretation& program, std::size_t most);

/// Leaves out points between which path, kind, tool and feed hardly change; what counts as such is doubled until no
/// more than `most` points are left. All points where there are no more than `most`.
PathPicture thinned_picture(PathPicture full, double chord_mm, std::size_t most);

/// An arc's chords stay within this part of the picture's extent.
double picture_chord_mm(const nc::Interpretation& program);

/// Chords of an arc, at least six.
int chords_of(double sweep_rad, double radius_mm, double chord_mm);

/// The programmed feed of a move; NaN: a rapid.
float feed_of(const nc::Move& move);

}  // namespace camber::report
