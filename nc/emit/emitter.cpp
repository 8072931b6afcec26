#include "nc/emit/emitter.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/language.h"

namespace camber::nc {

bool has_split_feeds(const MoveEdit& edit) {
  return std::any_of(edit.via.begin(), edit.via.end(), [](const ViaPoint& v) { return v.feed_mm_per_s.has_value(); });
}

bool asks_for_feed(const MoveEdit& edit) { return edit.feed_mm_per_s || has_split_feeds(edit); }

namespace {

bool asks_for_anything(const MoveEdit& edit) {
  return edit.end_mm || edit.center_mm || !edit.via.empty() || edit.feed_mm_per_s;
}

/// The F word of the block is an expression.
bool has_feed_expression(std::span<const Word> words) {
  return std::any_of(words.begin(), words.end(), [](const Word& w) { return w.letter == 'F' && std::isnan(w.value); });
}

}  // namespace

Emitter::Emitter(const Program& program, const Interpretation& moves, std::span<const MoveEdit> edits,
                 const EmitOptions& options)
    : program_(program),
      moves_(moves),
      edits_(edits),
      options_(options),
      rules_(language_of(program).text_rules(program)),
      style_(style_of(program)),
      text_(program, *rules_),
      feeds_(program, moves) {
  rules_->adapt(style_);
  assert(std::ranges::is_sorted(edits, {}, &MoveEdit::move));
  assert(edits.empty() || edits.back().move < moves.moves.size());
  if (std::any_of(edits.begin(), edits.end(), asks_for_feed)) feed_is_read_ = rules_->reads_feed();
}

Emission Emitter::run() {
  const auto& moves = moves_.moves;
  if (!moves.empty()) at_ = moves.front().start_mm;
  for (std::size_t m = 0; m < moves.size();) {
    std::size_t end = m + 1;
    while (end < moves.size() && moves[end].block == moves[m].block) ++end;
    run_block(m, end);
    m = end;
  }
  Emission out;
  out.text = text_.text(options_.header_comment);
  out.not_made = std::move(not_made_);
  out.block_of_line = text_.block_of_lines();
  return out;
}

void Emitter::run_block(std::size_t first, std::size_t end) {
  const Move& move = moves_.moves[first];
  const MoveEdit* edit = take_edit(first, end);
  const Vec3 last_end = moves_.moves[end - 1].end_mm;
  const bool may_be_skipped = program_.blocks[move.block].skip != 0;
  if (may_be_skipped && feeds_.astray()) restore_feed_on_own_line();
  feeds_.begin(move);
  const bool feed_is_right = !feeds_.astray() || !cuts(first, end);
  if (!edit && feed_is_right && (at_ - move.start_mm).cwiseAbs().maxCoeff() < kSamePlaceMm) {
    put_lines_before(move.block);
    at_ = last_end;
    return;
  }
  if (move.kind == MoveKind::dwell) return;
  const bool end_fixed = std::ranges::binary_search(moves_.fixed_ends, static_cast<std::uint32_t>(first));
  if (!move.editable && !end_fixed) {
    if (!feed_is_right) restore_feed_on_own_line();
    put_lines_before(move.block);
    pass_over(first, end);
    return;
  }
  index_ = static_cast<std::uint32_t>(first);
  end_ = end;
  frame_ = &moves_.frame_of(move);
  const int normal = cycle_normal(first, end);
  if (frame_->plain) {
    run_block_in_program(move, edit, last_end, normal);
  } else {
    Move there = move;
    there.start_mm = frame_->to_program(move.start_mm);
    there.end_mm = frame_->to_program(move.end_mm);
    MoveEdit wish;
    if (edit) {
      wish = *edit;
      if (wish.end_mm) wish.end_mm = frame_->to_program(*wish.end_mm);
      if (wish.center_mm) wish.center_mm = frame_->to_program(*wish.center_mm);
      for (ViaPoint& via : wish.via) {
        via.point_mm = frame_->to_program(via.point_mm);
        if (via.center_mm) via.center_mm = frame_->to_program(*via.center_mm);
      }
    }
    at_ = frame_->to_program(at_);
    run_block_in_program(there, edit ? &wish : nullptr, frame_->to_program(last_end), normal);
    at_ = frame_->from_program(at_);
  }
  if (cuts(first, end)) last_cut_ = &cutting_move(first, end);
  if (may_be_skipped && feeds_.astray()) restore_feed_on_own_line();
}

/// The coordinates of `move`, `edit` and at_ are those of the text.
void Emitter::run_block_in_program(const Move& move, const MoveEdit* edit, const Vec3& last_end, int normal) {
  unit_mm_ = moves_.state_of(move).inch ? kMmPerInch : 1.0;
  min_decimals_ = unit_mm_ == 1.0 ? options_.decimals_mm : options_.decimals_inch;
  BlockWriter writer = writer_of(move.block);
  if (rules_->goes_to_machine_place(move.block)) {
    leave_for_machine_place(writer, move, last_end);
  } else if (moves_.moves[end_ - 1].canned) {  // all of its moves, or those behind the way to the hole
    drill(writer, move, last_end, normal);
  } else if (move.kind == MoveKind::rapid && !edit && move.editable) {
    go_rapidly(writer, move);
  } else if (move.kind == MoveKind::arc) {
    go_on_arc(writer, move, edit);
  } else {
    go_on_line(writer, move, edit);
  }
}

// --- which edits are made -------------------------------------------------------------------------------------------

/// The edit of the block's only move; what cannot be edited is noted and passed over.
const MoveEdit* Emitter::take_edit(std::size_t first, std::size_t end) {
  const MoveEdit* edit = nullptr;
  for (; next_edit_ < edits_.size() && edits_[next_edit_].move < end; ++next_edit_) {
    const MoveEdit& next = edits_[next_edit_];
    if (const auto why = why_not(next, end - first))
      not_made_.push_back({next.move, *why});
    else
      edit = without_feeds_that_cannot_be(next);
  }
  return edit && asks_for_anything(*edit) ? edit : nullptr;
}

std::optional<EmitGap> Emitter::why_not(const MoveEdit& edit, std::size_t moves_of_block) const {
  const Move& move = moves_.moves[edit.move];
  const auto words = program_.words_of(move.block);
  if (move.kind == MoveKind::dwell) return EmitGap::dwell;
  if (rules_->goes_to_machine_place(move.block)) return EmitGap::machine_place;
  if (move.canned) return EmitGap::canned_cycle;
  if (!move.editable && asks_for_feed(edit) && has_feed_expression(words)) return EmitGap::feed_by_variable;
  if (!move.editable) return EmitGap::not_in_text;
  if (moves_of_block > 1) return EmitGap::several_moves;
  return std::nullopt;
}

const MoveEdit* Emitter::without_feeds_that_cannot_be(const MoveEdit& edit) {
  if (!asks_for_feed(edit)) return &edit;
  const auto why = why_no_feed(moves_.moves[edit.move]);
  if (!why) return &edit;
  not_made_.push_back({edit.move, *why});
  without_feeds_ = edit;
  without_feeds_.feed_mm_per_s.reset();
  for (ViaPoint& via : without_feeds_.via) via.feed_mm_per_s.reset();
  return &without_feeds_;
}

std::optional<EmitGap> Emitter::why_no_feed(const Move& move) const {
  if (move.kind == MoveKind::rapid) return EmitGap::rapid;
  if (move.feed_by_variable || feed_is_read_) return EmitGap::feed_by_variable;
  if (rules_->calls(move.block)) return EmitGap::subprogram;
  return std::nullopt;
}

/// Moves that the text does not say one by one: where they go does not depend on where the tool stands, but for axes
/// that stand still or go by increments.
void Emitter::pass_over(std::size_t first, std::size_t end) {
  const Vec3 start = moves_.moves[first].start_mm, shift = at_ - start;
  at_ = moves_.moves[end - 1].end_mm;
  for (int axis = 0; axis < 3; ++axis) {
    bool still = true;
    for (std::size_t m = first; m < end; ++m) still = still && moves_.moves[m].end_mm[axis] == start[axis];
    if (still || incremental(moves_.moves[first], word_of(moves_.moves[first], axis))) at_[axis] += shift[axis];
  }
}

/// Puts lines before a block that restore what it relies on beside position and feed, where an edit has changed that.
void Emitter::put_lines_before(std::uint32_t block) {
  const std::string lines = rules_->lines_before(block);
  if (lines.empty()) return;
  BlockWriter writer = writer_of(block);
  writer.put_before(lines);
  replace_block(block, writer);
}

void Emitter::replace_block(std::uint32_t block, const BlockWriter& writer) {
  if (writer.changed()) text_.replace(block, writer.text(text_.line_end_of(block)));
}

// --- feeds ----------------------------------------------------------------------------------------------------------

bool Emitter::cuts(std::size_t first, std::size_t end) const { return cutting_move(first, end).feed_mm_per_s > 0; }

/// The first of them with a feed; the last where none has one.
const Move& Emitter::cutting_move(std::size_t first, std::size_t end) const {
  for (std::size_t m = first; m + 1 < end; ++m)
    if (moves_.moves[m].feed_mm_per_s > 0) return moves_.moves[m];
  return moves_.moves[end - 1];
}

/// Behind the last cutting block, which is the one that left the feed astray or one that shares it.
void Emitter::restore_feed_on_own_line() {
  const NewWord word = feeds_.restored(*last_cut_);
  const BlockWriter writer = writer_of(last_cut_->block);
  text_.add_line_behind(last_cut_->block, writer.further_block({&word, 1}));
}

double Emitter::feed_of(const Move& move, const MoveEdit* edit) const {
  assert(!edit || !edit->feed_mm_per_s || *edit->feed_mm_per_s > 0);
  return edit ? edit->feed_mm_per_s.value_or(move.feed_mm_per_s) : move.feed_mm_per_s;
}

/// The modal feed of the block that `writer` makes.
void Emitter::set_feed(BlockWriter& writer, const Move& move, double feed_mm_per_s) {
  if (move.feed_mm_per_s <= 0 || inverse_time(move)) return;
  if (const auto word = feeds_.next(move, feed_mm_per_s, writer.find('F'))) writer.set(*word);
}

/// Between two points of the text.
double Emitter::length_mm_of(const Vec3& from, const Vec3& to) const {
  return frame_->shift_only ? (to - from).norm() : (frame_->from_program(to) - frame_->from_program(from)).norm();
}

// --- one axis -------------------------------------------------------------------------------------------------------

double Emitter::step_mm(int decimals) const { return unit_mm_ * std::pow(10.0, -decimals); }

const Word* Emitter::word_of(const Move& move, int axis) const {
  const Word* found = nullptr;
  for (const Word& w : program_.words_of(move.block))
    if (w.letter == kAxis[axis]) found = &w;
  return found;
}

/// The word's value that takes the axis to `wanted`.
double Emitter::word_for(bool incremental, int axis, double wanted) const {
  return (incremental ? wanted - at_[axis] : wanted) / unit_mm_;
}

double Emitter::place_after(bool incremental, int axis, double value) const {
  return incremental ? at_[axis] + value * unit_mm_ : value * unit_mm_;
}

/// Sets the words that take the tool as near to `wanted` as the decimals allow; returns where it will be.
Vec3 Emitter::set_end(BlockWriter& writer, const Move& move, const Vec3& wanted, int more_decimals,
                      bool add_words) const {
  Vec3 after = at_;
  for (int axis = 0; axis < 3; ++axis) {
    const int decimals = writer.decimals(kAxis[axis], min_decimals_) + more_decimals;
    const Word* present = writer.find(kAxis[axis]);
    const bool step = incremental(move, present);
    const bool away = std::abs(wanted[axis] - at_[axis]) > 0.5 * step_mm(decimals) + kSamePlaceMm;
    if (!present && !(away && add_words)) continue;
    const double value = rounded(word_for(step, axis, wanted[axis]), decimals);
    writer.set(kAxis[axis], value, decimals);
    after[axis] = place_after(step, axis, writer.value(kAxis[axis]));
  }
  return after;
}

Vec3 Emitter::place_of_untouched(const BlockWriter& writer, const Move& move) const {
  Vec3 after = at_;
  for (int axis = 0; axis < 3; ++axis)
    if (const Word* word = writer.find(kAxis[axis]))
      after[axis] = place_after(incremental(move, word), axis, word->value);
  return after;
}

// --- the door -------------------------------------------------------------------------------------------------------

Emission emit_edits(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                    const EmitOptions& options) {
  return Emitter(program, interpretation, edits, options).run();
}

std::string emit(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                 const EmitOptions& options) {
  return emit_edits(program, interpretation, edits, options).text;
}

}  // namespace camber::nc
