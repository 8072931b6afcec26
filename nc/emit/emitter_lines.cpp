// Lines, rapids, drilling cycles.
#include <cmath>

#include "base/units.h"
#include "nc/emit/emitter.h"

namespace camber::nc {

void Emitter::leave_for_machine_place(BlockWriter& writer, const Move& move, const Vec3& end) {
  const bool all = !writer.find('X') && !writer.find('Y') && !writer.find('Z');
  for (int axis = 0; axis < 3; ++axis)
    if (all || writer.find(kAxis[axis])) at_[axis] = end[axis];
  set_feed(writer, move, move.feed_mm_per_s);
  replace_block(move.block, writer);
}

void Emitter::go_rapidly(BlockWriter& writer, const Move& move) {
  at_ = set_end(writer, move, move.end_mm, 0, false);
  replace_block(move.block, writer);
}

/// A cycle drills where the tool stands or where its words say: both must be the old place.
void Emitter::drill(BlockWriter& writer, const Move& move, const Vec3& last_end, int normal) {
  Vec3 place = last_end;
  if (!incremental(move, nullptr) || !writer.find('L')) {
    place[normal] = at_[normal];
    const Vec3 before = at_;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == normal) continue;
      const int decimals = writer.decimals(kAxis[axis], min_decimals_);
      const bool away = std::abs(place[axis] - before[axis]) > 0.5 * step_mm(decimals) + kSamePlaceMm;
      if (!writer.find(kAxis[axis]) && !away) continue;
      const bool step = incremental(move, writer.find(kAxis[axis]));
      writer.set(kAxis[axis], rounded(word_for(step, axis, place[axis]), decimals), decimals);
    }
  }
  const Move& feeding = cutting_move(index_, end_);
  set_feed(writer, feeding, feeding.feed_mm_per_s);
  replace_block(move.block, writer);
  const double height = last_end[normal] == move.start_mm[normal] ? at_[normal] : last_end[normal];
  at_ = last_end;
  at_[normal] = height;
}

/// The axis that the cycle's feed moves run along.
int Emitter::cycle_normal(std::size_t first, std::size_t end) const {
  if (!moves_.moves[end - 1].canned) return 2;
  for (std::size_t m = first; m < end; ++m) {
    const Move& move = moves_.moves[m];
    if (move.kind != MoveKind::linear || !move.canned) continue;
    Eigen::Index axis = 0;
    (move.end_mm - move.start_mm).cwiseAbs().maxCoeff(&axis);
    return static_cast<int>(axis);
  }
  return 2;
}

void Emitter::go_on_line(BlockWriter& writer, const Move& move, const MoveEdit* edit) {
  const std::vector<Piece> pieces = pieces_of(move, edit);
  const Vec3 start = at_;
  at_ = set_end(writer, move, pieces.front().end_mm, 0, true);
  if (inverse_time(move) && (pieces.size() > 1 || (edit && asks_for_feed(*edit))))
    set_inverse_time_feed(writer, edit, pieces.front(), length_mm_of(start, at_));
  else
    set_feed(writer, move, pieces.front().feed_mm_per_s);
  std::string more;
  if (pieces.size() > 1) {
    const auto at_end = rules_->words_at_end(move.block);
    for (const Word& word : at_end) writer.take_out(word);
    for (std::size_t i = 1; i < pieces.size(); ++i)
      more += further_line(writer, move, *edit, pieces[i], i + 1 == pieces.size() ? at_end : std::vector<Word>{});
  }
  if (writer.changed() || !more.empty()) text_.replace(move.block, writer.text(text_.line_end_of(move.block)) + more);
}

/// Writes moves to the via points and to the end. Points that the decimals cannot tell from the start or the end are
/// left out: they would be moves without length.
std::vector<Emitter::Piece> Emitter::pieces_of(const Move& move, const MoveEdit* edit) {
  if (!edit) return {{move.end_mm, move.feed_mm_per_s}};
  const Vec3 end = edit->end_mm.value_or(move.end_mm);
  const double feed = feed_of(move, edit);
  std::vector<Piece> pieces;
  for (const ViaPoint& via : edit->via) pieces.push_back({via.point_mm, via.feed_mm_per_s.value_or(feed)});
  if (!pieces.empty() && rules_->calls(move.block)) {
    not_made_.push_back({edit->move, EmitGap::subprogram});
    pieces.clear();
  }
  const double near = step_mm(min_decimals_);
  const auto close = [](const Vec3& a, const Vec3& b) { return (a - b).cwiseAbs().maxCoeff(); };
  while (!pieces.empty() && close(pieces.front().end_mm, at_) < 0.5 * near) pieces.erase(pieces.begin());
  while (!pieces.empty() && close(pieces.back().end_mm, end) < 2 * near) pieces.pop_back();
  pieces.push_back({end, feed});
  return pieces;
}

/// The F of inverse time (G93) belongs to one block: its own length counts.
void Emitter::set_inverse_time_feed(BlockWriter& writer, const MoveEdit* edit, const Piece& piece, double length_mm) {
  if (length_mm <= 0) return;
  const int decimals = writer.decimals('F', 3);
  if (edit && asks_for_feed(*edit))
    writer.set(feeds_.inverse_time(piece.feed_mm_per_s, length_mm, decimals));
  else
    writer.set('F', mm_per_min_from_mm_per_s(piece.feed_mm_per_s) / length_mm, decimals);
}

/// A line end and a block with coordinates, and the words that act at its end; empty when the point rounds to where
/// the tool stands.
std::string Emitter::further_line(const BlockWriter& writer, const Move& move, const MoveEdit& edit, const Piece& piece,
                                  const std::vector<Word>& at_end) {
  std::vector<NewWord> words;
  Vec3 after = at_;
  for (int axis = 0; axis < 3; ++axis) {
    // An end that stays keeps its decimals.
    const int decimals = edit.end_mm ? min_decimals_ : writer.decimals(kAxis[axis], min_decimals_);
    const bool step = incremental(move, nullptr);
    const double value = rounded(word_for(step, axis, piece.end_mm[axis]), decimals);
    const double place = place_after(step, axis, value);
    if (std::abs(place - at_[axis]) < 0.5 * step_mm(decimals)) continue;
    words.push_back({kAxis[axis], value, decimals});
    after[axis] = place;
  }
  if (words.empty() && at_end.empty()) return {};
  if (!words.empty()) {
    const double length = length_mm_of(at_, after);
    if (!inverse_time(move)) {
      if (move.feed_mm_per_s > 0)
        if (const auto feed = feeds_.next(move, piece.feed_mm_per_s, nullptr)) words.push_back(*feed);
    } else if (asks_for_feed(edit)) {
      words.push_back(feeds_.inverse_time(piece.feed_mm_per_s, length, min_decimals_));
    } else {
      words.push_back({'F', mm_per_min_from_mm_per_s(piece.feed_mm_per_s) / length, min_decimals_});
    }
  }
  at_ = after;
  return text_.line_end_of(move.block) + writer.further_block(words, at_end);
}

}  // namespace camber::nc
