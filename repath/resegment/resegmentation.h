#pragma once
// Resegmenting: runs of short lines replaced by segments just long enough for the control.
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "repath/compress/compression.h"

namespace camber::repath {

/// Lower feeds about the corners that are kept, where axes that lag cut them off or leave them late: in the last 0.8 mm
/// before a corner and the first 0.4 mm behind it. Figures of trial: they are where the seconds buy most.
struct CornerFeeds {
  double fraction = 1;  ///< of the feed; 1: as elsewhere
  double settle_s = 0;  ///< what lies between two sharp corners (60 degrees) that are no farther apart, as the step
                        ///< from row to row, takes at least so long: the axes catch up
  bool any() const { return fraction != 1 || settle_s > 0; }
};

struct ResegmentOptions {
  double tolerance_mm = 0.01;  ///< largest distance between the old and the new path, both ways
  double length_mm = 0;        ///< segment length; 0: length_factor times L_b
  double block_time_s = 0;     ///< T_b; 0: the mean length of the old blocks is used as L_b
  double length_factor = 1;    ///< at least 1
  double feed_factor = 1;      ///< factor on the feed of the rewritten runs
  CornerFeeds corners{};       ///< of that feed
  double corner_rad = 5 * kPi / 180;
};

/// L_b = F T_b: shorter blocks than that the control cannot read at the feed.
/// Source: KAKEN report on deflection-compensated CAM, eq. 3 (there F T_b / 60000 in mm, mm/min, ms).
double segment_length_mm(double feed_mm_per_s, double block_time_s);

/// The points of a run in space, as the text says them, of arcs also points between their ends. Repeated points are
/// left out; `block` tells which block ends at each (of the first point: the run's first block).
struct SpacePath {
  static constexpr std::uint32_t kInside = std::numeric_limits<std::uint32_t>::max();  ///< an arc: no block ends there
  std::vector<Vec3> points;
  std::vector<std::uint32_t> block;
  double sagitta_mm = 0;  ///< maximum deviation of the lines between the points from arcs; 0: no arcs
};
/// `sagitta_mm`: of the lines that stand for arcs, greater than zero.
SpacePath space_path_of(const nc::Interpretation& moves, const BlockRun& run, double sagitta_mm);

/// Where a segment lies.
struct SegmentPlace {
  bool near_corner = false;
  double between_corners_mm = 0;  ///< greater than zero: it is part of a step of that length between sharp corners
};

/// A resegmented path.
struct Layout {
  std::vector<Vec3> points;              ///< from the first to the last one of the old path
  std::vector<std::uint32_t> old_point;  ///< the last old point that is not behind each
  double deviation_mm = 0;               ///< Hausdorff distance, both ways (an upper bound)
  std::size_t corners = 0;
  std::vector<SegmentPlace> place;  ///< of the segment that ends at each point; empty: not asked for
};

/// Returns the length of a run's segments: options.length_mm, or length_factor times L_b at the run's feed, or where
/// the control has no block time, length_factor times the mean length of its blocks.
double length_for(const nc::Interpretation& moves, const BlockRun& run, const ResegmentOptions& options);

/// Between corners a smooth curve takes the place of the points (half of the tolerance), and segments of `length_mm`
/// are laid on it, shorter ones where the whole tolerance asks for it. Where a curve leaves the old path by more, as
/// between points that lie far apart, the path is cut there and stays what it was. `increment_mm`: points are rounded
/// to it.
Layout lay_out(std::span<const Vec3> points, const ResegmentOptions& options, double length_mm, double increment_mm);

struct Resegmentation {
  std::string text;
  std::vector<RewrittenRun> runs;
  double max_deviation_mm = 0;
  std::size_t corners = 0;
};

/// Linear in the number of blocks. Does not throw on a program that was read and interpreted without errors.
Resegmentation resegment(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options);

// Selection of the arcs of a run that are rewritten together with the neighbouring lines.

/// Zeroes: every arc stays.
struct ShortArcRule {
  double length_mm = 0;     ///< of the segments to be laid
  double tolerance_mm = 0;  ///< a chord of sqrt(8 r t) leaves a curve of radius r by t
};

/// The stretches of a run between arcs that stay. An arc is laid out again where it is shorter than the segment that
/// would be laid on it, the length or the chord within the tolerance, and goes on smoothly (20 degrees) into a block of
/// the run that is short too. Otherwise one block is best, and the arc stays. A stretch does not end on an arc whose
/// mode (G2, G3) the text behind relies on. Stretches of one block are left out.
std::vector<BlockRun> between_arcs(const nc::Program& program, const nc::Interpretation& moves, const BlockRun& run,
                                   const ShortArcRule& rule);

// A smooth curve through the points of a path, within a tolerance.

/// A natural cubic spline over the points' chord length, from the first point to the last. The points in between are
/// moved by at most `tolerance_mm`, such that the integral of the squared second derivative becomes least for the
/// largest weight that the tolerance allows: the corners and the noise of the CAM system's chords go, the shape stays.
/// Source: Reinsch, Smoothing by spline functions, Numerische Mathematik 10 (1967), with the ends held fast.
class SmoothCurve {
 public:
  /// At least two points, no two that follow each other alike. Time and memory grow linearly with their number.
  SmoothCurve(std::span<const Vec3> points, double tolerance_mm);

  double length_mm() const { return knots_.back(); }  ///< of the chords
  const std::vector<double>& knots_mm() const { return knots_; }
  Vec3 at(double s_mm) const;
  double largest_move_mm() const { return largest_move_; }  ///< of a point

 private:
  void solve(std::span<const Vec3> points, double weight);
  std::vector<double> knots_;
  std::vector<Vec3> values_, second_;  ///< at the knots
  double largest_move_ = 0;
};

}  // namespace camber::repath
