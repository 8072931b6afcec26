#pragma once
// The cutting moves of a program in short cells, each of which may have a feed of its own.
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "nc/emit.h"
#include "simulate/predict_path.h"

namespace camber::adapt {

/// Why the feed of a cell stays as programmed.
enum class Kept : std::uint8_t {
  no,
  unknown_load,  ///< outside the job's operations: nothing is known of its load
  plunge,        ///< straight along the tool's axis, a hole
  not_editable   ///< the text does not allow it (nc::EmitGap)
};

struct Cell {
  std::uint32_t move = 0;
  double from = 0, to = 1;  ///< fractions of the move's length
  double length_mm = 0;
  double along_mm = 0;       ///< path length at its end, from the start of its chain
  double feed_mm_per_s = 0;  ///< programmed, of the tip on the part
  Kept kept = Kept::no;
  bool first = false;  ///< first of a chain: after a rapid or a dwell
};

/// Cells of all lines and arcs with a feed, in the order of the path. Between two chains lies a rapid or a dwell.
class FeedCells {
 public:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  /// `length_mm`: greatest length of a cell, by move; moves in which rotary axes turn are one cell.
  FeedCells(const simulate::SimulatedProgram& program, const machine::Machine& machine,
            std::span<const double> length_mm);

  const std::vector<Cell>& cells() const { return cells_; }
  std::size_t size() const { return cells_.size(); }
  const Cell& operator[](std::size_t i) const { return cells_[i]; }
  /// kNone: not a cutting move.
  std::size_t find(std::uint32_t move, double fraction) const;
  /// Cells [first, second) of each chain.
  const std::vector<std::pair<std::size_t, std::size_t>>& chains() const { return chains_; }
  /// Moves whose feed the text does not allow to change, and why.
  const std::vector<nc::EditNotMade>& not_editable() const { return not_editable_; }

  /// The edits of the text that give every cell its feed; nothing is edited where it is the programmed one. One per
  /// cell.
  std::vector<nc::MoveEdit> edits(const simulate::SimulatedProgram& program,
                                  std::span<const double> feed_mm_per_s) const;

 private:
  void add(const simulate::SimulatedProgram& program, std::uint32_t move, double length_mm, Kept kept);

  std::vector<double> tip_feed_mm_per_s_;  ///< one per move
  std::vector<Cell> cells_;
  std::vector<std::size_t> first_of_move_;  ///< one per move and one more
  std::vector<std::pair<std::size_t, std::size_t>> chains_;
  std::vector<nc::EditNotMade> not_editable_;
};

}  // namespace camber::adapt
