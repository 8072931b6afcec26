#pragma once
// Shift path: the nodes of the program's path that may be moved, and the shift of each.
#include <cstdint>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "nc/emit.h"
#include "nc/move.h"

namespace camber::compensate {

/// A place on the programmed path. Shifts are linear between neighbours of a chain.
struct ControlPoint {
  std::uint32_t move = 0;
  double fraction = 0;  ///< fraction of the move's length
  double along_mm = 0;  ///< path length since the chain's start
  Vec3 place_mm = Vec3::Zero();
  Vec3 shift_mm = Vec3::Zero();
  double feed_fraction = 1;  ///< fraction of the programmed feed, on the piece that ends here
  bool fixed = false;        ///< not moved: end of a rapid, of another operation's move or of one that is not editable
  /// The piece that ends here runs along Z alone, a plunge or a retract, and gets no X and Y words: its shift across is
  /// that of the point before.
  bool plunge = false;
};

/// One unbroken run of moves that may be shifted: points[from] ... points[from + count - 1].
struct ShiftChain {
  std::size_t from = 0, count = 0;
};

class ShiftPath {
 public:
  /// Lines and arcs longer than spacing_mm get points between their ends, but none closer than the control can process
  /// blocks at the move's feed, F T_b. Infinite: no move is split, and arcs have a point in the middle (full turns two)
  /// that determine their radius. `whole` (one per move, or empty): moves that are never split.
  ShiftPath(const nc::Interpretation& program, const std::vector<bool>& selected, double spacing_mm,
            double block_time_s = 0, const std::vector<bool>& whole = {});

  std::vector<ControlPoint>& points() { return points_; }
  const std::vector<ControlPoint>& points() const { return points_; }
  const std::vector<ShiftChain>& chains() const { return chains_; }

  /// The interval of points in which a place of the path lies: points()[lower] and points()[lower + 1].
  struct PointInterval {
    std::size_t lower = 0;
    double upper_fraction = 0;
  };
  /// Returns whether the points of the move may be shifted.
  bool contains(std::uint32_t move) const { return move < first_of_move_.size() && first_of_move_[move] != kNone; }
  /// Requires a move that is contained.
  PointInterval find(std::uint32_t move, double fraction) const;
  Vec3 shift_at(const PointInterval& place) const;
  std::vector<Vec3> shifts() const;
  void set_shifts(std::span<const Vec3> shifts);
  /// Gives the points of plunges the shift across Z that they must have.
  void keep_plunges();

  /// Returns the moves whose points are shifted or whose feed is changed. Points between the ends of a line are kept
  /// where the path without them would deviate by more than tolerance_mm. An arc stays one arc if that passes the
  /// shifted points within the tolerance, else it becomes the fewest arcs that do.
  std::vector<nc::MoveEdit> edits(double tolerance_mm) const;
  /// Returns the path with lines split at the points that are kept (one flag per point) and nowhere else.
  std::vector<nc::MoveEdit> edits(const std::vector<bool>& kept, double tolerance_mm) const;

  /// Returns one flag per point: true for the ends of moves, for every point of an arc and for what is fixed.
  std::vector<bool> ends_of_moves() const;
  /// Keeps the points of lines at which the feed changes.
  void keep_feed_changes(std::vector<bool>& kept) const;
  /// Keeps points of lines without which the shifted path would deviate by more than tolerance_mm.
  void keep_strays(double tolerance_mm, std::vector<bool>& kept) const;
  /// Returns the path of the kept points alone; ends_of_moves() must be among them.
  ShiftPath thinned(const std::vector<bool>& kept) const;
  double largest_shift_mm() const;
  /// Cuts longer shifts to `max_shift_mm`; plunges stay plunges. Returns the number of points that it changed.
  std::size_t cut_to(double max_shift_mm);

 private:
  nc::MoveEdit edit_of(std::size_t first_point, std::size_t last_point, const std::vector<bool>& kept,
                       double tolerance_mm) const;
  void set_feeds(std::size_t first_point, std::size_t last_point, const std::vector<bool>& kept,
                 nc::MoveEdit& edit) const;
  void edit_arc(std::size_t first_point, std::size_t last_point, double tolerance_mm, nc::MoveEdit& edit) const;

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  const nc::Interpretation* program_;
  std::vector<ControlPoint> points_;
  std::vector<ShiftChain> chains_;
  std::vector<std::size_t> first_of_move_;  ///< index of the point at each selected move's start
};

}  // namespace camber::compensate
