#pragma once
// Emitter: goes through the moves in their order and decides what each block becomes. Behind the door nc/emit.h.
//   emitter.cpp        the walk over the blocks; which edits cannot be made; the end points of one axis
//   emitter_lines.cpp  lines, rapids, drilling cycles
//   emitter_arcs.cpp   arcs
//   feed_words         the modal feed and the F words that it takes
//   text_rules         how a language writes words; iso_text_rules: those of ISO
//   block_writer       one block's text with some of its words changed; number_style: how numbers are written
//   arc_rounding       arcs whose words are rounded and still close
//   emitted_text       the whole text put together
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nc/emit.h"
#include "nc/emit/arc_rounding.h"
#include "nc/emit/block_writer.h"
#include "nc/emit/emitted_text.h"
#include "nc/emit/feed_words.h"
#include "nc/emit/text_rules.h"

namespace camber::nc {

/// Some of the pieces have a feed of their own.
bool has_split_feeds(const MoveEdit& edit);
bool asks_for_feed(const MoveEdit& edit);

class Emitter {
 public:
  Emitter(const Program& program, const Interpretation& moves, std::span<const MoveEdit> edits,
          const EmitOptions& options);
  Emission run();

 private:
  static constexpr char kAxis[] = "XYZ";
  static constexpr double kSamePlaceMm = 1e-9;  ///< sums of increments; far below any decimal

  /// A move that a block becomes.
  struct Piece {
    Vec3 end_mm;
    double feed_mm_per_s = 0;
  };

  // emitter.cpp: the walk. All moves [first, end) are of one block.
  void run_block(std::size_t first, std::size_t end);
  void run_block_in_program(const Move& move, const MoveEdit* edit, const Vec3& last_end, int normal);
  const MoveEdit* take_edit(std::size_t first, std::size_t end);
  std::optional<EmitGap> why_not(const MoveEdit& edit, std::size_t moves_of_block) const;
  const MoveEdit* without_feeds_that_cannot_be(const MoveEdit& edit);
  std::optional<EmitGap> why_no_feed(const Move& move) const;
  void pass_over(std::size_t first, std::size_t end);
  BlockWriter writer_of(std::uint32_t block) const { return {program_, block, style_, *rules_}; }
  void put_lines_before(std::uint32_t block);
  void replace_block(std::uint32_t block, const BlockWriter& writer);

  // emitter.cpp: feeds
  bool cuts(std::size_t first, std::size_t end) const;
  const Move& cutting_move(std::size_t first, std::size_t end) const;
  void restore_feed_on_own_line();
  double feed_of(const Move& move, const MoveEdit* edit) const;
  void set_feed(BlockWriter& writer, const Move& move, double feed_mm_per_s);
  double length_mm_of(const Vec3& from, const Vec3& to) const;

  // emitter.cpp: one axis
  /// Returns whether the axis word of the block counts from where the tool stands; without one: a word that would be
  /// added.
  bool incremental(const Move& move, const Word* word) const {
    return rules_->incremental(moves_.state_of(move), word);
  }
  const Word* word_of(const Move& move, int axis) const;
  bool inverse_time(const Move& move) const { return moves_.state_of(move).feed_mode == FeedMode::inverse_time; }
  double step_mm(int decimals) const;
  double word_for(bool incremental, int axis, double wanted) const;
  double place_after(bool incremental, int axis, double value) const;
  Vec3 set_end(BlockWriter& writer, const Move& move, const Vec3& wanted, int more_decimals, bool add_words) const;
  Vec3 place_of_untouched(const BlockWriter& writer, const Move& move) const;

  // emitter_lines.cpp
  void leave_for_machine_place(BlockWriter& writer, const Move& move, const Vec3& end);
  void go_rapidly(BlockWriter& writer, const Move& move);
  void drill(BlockWriter& writer, const Move& move, const Vec3& last_end, int normal);
  int cycle_normal(std::size_t first, std::size_t end) const;
  void go_on_line(BlockWriter& writer, const Move& move, const MoveEdit* edit);
  std::vector<Piece> pieces_of(const Move& move, const MoveEdit* edit);
  void set_inverse_time_feed(BlockWriter& writer, const MoveEdit* edit, const Piece& piece, double length_mm);
  std::string further_line(const BlockWriter& writer, const Move& move, const MoveEdit& edit, const Piece& piece,
                           const std::vector<Word>& at_end);

  // emitter_arcs.cpp
  void go_on_arc(BlockWriter& writer, const Move& move, const MoveEdit* edit);
  WantedArc wanted_arc(const Move& move, const MoveEdit* edit, const Arc& arc) const;
  bool is_as_before(const BlockWriter& writer, const Move& move, const WantedArc& wanted) const;
  Arc arc_in_program(const Move& move) const;
  bool write_split(const Move& move, const MoveEdit& edit, const WantedArc& wanted);
  bool write_arc(const Move& move, const MoveEdit* edit, const WantedArc& wish, int more_decimals);
  bool write_arc_pieces(const Move& move, const MoveEdit& edit, const WantedArc& whole, int more_decimals);
  std::vector<NewWord> words_to(const Move& move, const Vec3& end, int decimals, Vec3& after) const;
  NewWord inverse_time_feed(const BlockWriter& writer, double feed_mm_per_s, const WantedArc& arc);

  const Program& program_;
  const Interpretation& moves_;
  std::span<const MoveEdit> edits_;
  const EmitOptions& options_;
  std::unique_ptr<TextRules> rules_;
  NumberStyle style_;
  EmittedText text_;
  FeedWords feeds_;
  bool feed_is_read_ = false;  ///< the program reads its modal feed, or calls a macro behind moves

  std::vector<EditNotMade> not_made_;
  MoveEdit without_feeds_;          ///< the edit of the block, where its feeds cannot be made
  const Move* last_cut_ = nullptr;  ///< the last one with a feed of its own making
  std::size_t next_edit_ = 0;
  Vec3 at_ = Vec3::Zero();   ///< place to which the emitted program has taken the tool
  std::uint32_t index_ = 0;  ///< index of the block's first move
  std::size_t end_ = 0;      ///< behind its last one
  const Frame* frame_ = nullptr;
  double unit_mm_ = 1;
  int min_decimals_ = 4;
};

}  // namespace camber::nc
