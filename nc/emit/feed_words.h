#pragma once
// Follows the modal feed of the emitted program and decides the F words that it takes.
#include <optional>

#include "nc/emit/block_writer.h"
#include "nc/move.h"

namespace camber::nc {

/// Follows the modal F of the given text (G94, G95) and that of the emitted one, in the order of the moves. As long as
/// no feed is edited both are the same, and no F word changes. In G93 every block has its own F: nothing to follow.
class FeedWords {
 public:
  struct Astray {
    double now = 0;    ///< modal feed of the emitted text, mm/min or mm a turn
    double given = 0;  ///< feed of the given program
  };

  FeedWords(const Program& program, const Interpretation& moves) : program_(&program), moves_(&moves) {}

  /// The moves of a block are next: an F word that stands there or before it counts in both texts.
  void begin(const Move& move);

  /// True when the modal feed of the emitted text is another one than that of the given text.
  bool astray() const { return astray_.has_value(); }
  /// Goes back to a state, for a block that is tried and given up.
  const std::optional<Astray>& state() const { return astray_; }
  void go_back_to(const std::optional<Astray>& state) { astray_ = state; }

  /// The F word that `move` needs for the feed; nothing where the modal feed is right. `own`: the F of its block,
  /// where the piece is the one that keeps the block's words. The word counts as written.
  std::optional<NewWord> next(const Move& move, double feed_mm_per_s, const Word* own);

  /// The F of a block in inverse time.
  NewWord inverse_time(double feed_mm_per_s, double length_mm, int min_decimals);

  /// The F word, in the state of `last` (a move behind which the feed is astray), that brings the modal feed back.
  NewWord restored(const Move& last);

 private:
  double modal_of(const Move& move, double feed_mm_per_s) const;
  double unit_mm(const Move& move) const;
  void set_modal(double now, double given);
  NewWord exact(double value);
  int decimals_for(double value);
  void read_style();

  const Program* program_;
  const Interpretation* moves_;
  std::optional<NumberStyle> style_;  ///< style of F words; read when one is needed
  int decimals_ = 0;                  ///< the most that the program's F words have
  std::optional<Astray> astray_;
};

}  // namespace camber::nc
