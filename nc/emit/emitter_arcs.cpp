// Arcs: one for one, or several in place of one.
#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "nc/emit/emitter.h"
#include "nc/frames.h"

namespace camber::nc {
namespace {

constexpr int kMoreDecimals = 4;  ///< an arc may take so many decimals more to close

Plane plane_of(const Arc& arc) { return arc.normal.z() != 0 ? Plane::xy : arc.normal.y() != 0 ? Plane::zx : Plane::yz; }

/// The sweep from start to end about a centre, in the sense of `like`.
double sweep_about(const Vec3& centre, const Vec3& start, const Vec3& end, const PlaneAxes& axes, double like) {
  const auto angle = [&](const Vec3& p) {
    return std::atan2(p[axes.second] - centre[axes.second], p[axes.first] - centre[axes.first]);
  };
  double sweep = angle(end) - angle(start);
  while (sweep * like <= 0) sweep += like > 0 ? 2 * kPi : -2 * kPi;
  while (std::abs(sweep) > 2 * kPi) sweep -= like > 0 ? 2 * kPi : -2 * kPi;
  return sweep;
}

/// The pieces are to be made although neither end nor centre changes: they differ in feed, or are asked for as pieces
/// of the arc as it is. (Pieces with centres of their own that round to the old arc are the old arc.)
bool is_split_as_it_is(const MoveEdit& edit) {
  return std::any_of(edit.via.begin(), edit.via.end(),
                     [&](const ViaPoint& v) { return !v.center_mm || v.feed_mm_per_s || edit.feed_mm_per_s; });
}

}  // namespace

void Emitter::go_on_arc(BlockWriter& writer, const Move& move, const MoveEdit* edit) {
  const Arc arc = arc_in_program(move);
  WantedArc wanted = wanted_arc(move, edit, arc);
  const bool split = edit && !edit->via.empty();
  if (is_as_before(writer, move, wanted) && !(split && is_split_as_it_is(*edit))) {
    at_ = move.end_mm;
    if (inverse_time(move) && edit && edit->feed_mm_per_s)
      writer.set(inverse_time_feed(writer, feed_of(move, edit), wanted));
    set_feed(writer, move, feed_of(move, edit));
    replace_block(move.block, writer);
    return;
  }
  MoveEdit whole;
  if (split) {
    if (write_split(move, *edit, wanted)) return;
    whole = *edit;
    whole.via.clear();
    if (has_split_feeds(*edit)) whole.feed_mm_per_s.reset();
    edit = &whole;
  }
  for (int more = 0; more <= kMoreDecimals; ++more)
    if (write_arc(move, edit, wanted, more)) return;
  // No room between the ends: the old arc, moved to where the tool stands.
  not_made_.push_back({index_, EmitGap::arc});
  wanted.end_mm = at_ + move.end_mm - move.start_mm;
  wanted.center_mm = at_ + arc.center_mm - move.start_mm;
  if (!write_arc(move, edit, wanted, kMoreDecimals)) {
    at_ = place_of_untouched(writer, move);
    set_feed(writer, move, feed_of(move, edit));
    replace_block(move.block, writer);
  }
}

WantedArc Emitter::wanted_arc(const Move& move, const MoveEdit* edit, const Arc& arc) const {
  WantedArc wanted;
  wanted.plane = plane_of(arc);
  const PlaneAxes axes = axes_of(wanted.plane);
  wanted.start_mm = at_;
  wanted.end_mm = edit ? edit->end_mm.value_or(move.end_mm) : move.end_mm;
  wanted.center_mm = edit ? edit->center_mm.value_or(arc.center_mm) : arc.center_mm;
  wanted.sweep_rad = arc.sweep_rad;
  wanted.full_turn = std::hypot(move.end_mm[axes.first] - move.start_mm[axes.first],
                                move.end_mm[axes.second] - move.start_mm[axes.second]) < 1e-6;
  wanted.by_radius = rules_->by_radius(move.block);
  wanted.absolute_centre = rules_->absolute_centre(moves_.state_of(move), move.block);
  const double turns = std::abs(arc.sweep_rad) / (2 * kPi);
  wanted.turns = std::max(1, static_cast<int>(wanted.full_turn ? std::lround(turns) : std::floor(turns) + 1));
  return wanted;
}

/// Start, end and centre differ from the text by less than its decimals can say.
bool Emitter::is_as_before(const BlockWriter& writer, const Move& move, const WantedArc& wanted) const {
  if ((at_ - move.start_mm).cwiseAbs().maxCoeff() >= kSamePlaceMm) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * step_mm(writer.decimals(kAxis[axis], min_decimals_));
    if (std::abs(wanted.end_mm[axis] - move.end_mm[axis]) > half) return false;
  }
  const Vec3 centre_shift = wanted.center_mm - arc_in_program(move).center_mm;
  return centre_shift.cwiseAbs().maxCoeff() <= 0.5 * step_mm(min_decimals_);
}

Arc Emitter::arc_in_program(const Move& move) const {
  const Frame& frame = moves_.frame_of(move);
  return frame.plain ? moves_.arcs[move.arc] : to_program(frame, moves_.arcs[move.arc]);
}

/// The F of inverse time for the arc, whose start and end stand in the text.
NewWord Emitter::inverse_time_feed(const BlockWriter& writer, double feed_mm_per_s, const WantedArc& arc) {
  const PlaneAxes axes = axes_of(arc.plane);
  double sweep = arc.sweep_rad;
  if (!arc.full_turn && arc.turns == 1) sweep = sweep_about(arc.center_mm, arc.start_mm, arc.end_mm, axes, sweep);
  Vec3 out = arc.start_mm - arc.center_mm, rise = Vec3::Zero();
  out[axes.normal] = 0;
  rise[axes.normal] = arc.end_mm[axes.normal] - arc.start_mm[axes.normal];
  const double length = std::hypot((frame_->linear * out).norm() * sweep, (frame_->linear * rise).norm());
  return feeds_.inverse_time(feed_mm_per_s, length, writer.decimals('F', 3));
}

bool Emitter::write_arc(const Move& move, const MoveEdit* edit, const WantedArc& wish, int more_decimals) {
  BlockWriter writer = writer_of(move.block);
  WantedArc wanted = wish;
  const PlaneAxes axes = axes_of(wanted.plane);
  if (wanted.full_turn)
    for (const int axis : {axes.first, axes.second}) wanted.end_mm[axis] = at_[axis];
  wanted.start_mm = at_;
  wanted.end_mm = set_end(writer, move, wanted.end_mm, more_decimals, true);
  const int decimals = min_decimals_ + more_decimals;
  const auto arc = round_arc(wanted, unit_mm_, decimals);
  if (!arc) return false;
  rules_->set_arc(writer, wanted, *arc, unit_mm_, decimals);
  if (inverse_time(move) && edit && edit->feed_mm_per_s)
    writer.set(inverse_time_feed(writer, feed_of(move, edit), wanted));
  set_feed(writer, move, feed_of(move, edit));
  at_ = wanted.end_mm;
  replace_block(move.block, writer);
  return true;
}

/// The arc in pieces; false where it stays whole.
bool Emitter::write_split(const Move& move, const MoveEdit& edit, const WantedArc& wanted) {
  if (rules_->calls(move.block)) {
    not_made_.push_back({edit.move, EmitGap::subprogram});
    return false;
  }
  if (wanted.turns != 1 || inverse_time(move)) {
    not_made_.push_back({edit.move, EmitGap::arc_not_split});
    return false;
  }
  for (int more = 0; more <= kMoreDecimals; ++more)
    if (write_arc_pieces(move, edit, wanted, more)) return true;
  not_made_.push_back({edit.move, EmitGap::arc_not_split});
  return false;
}

/// Several arcs in place of one; false, and nothing is written, where the words of one of them do not close.
bool Emitter::write_arc_pieces(const Move& move, const MoveEdit& edit, const WantedArc& whole, int more_decimals) {
  const PlaneAxes axes = axes_of(whole.plane);
  const int decimals = min_decimals_ + more_decimals;
  const Vec3 start = at_;
  const auto feed_before = feeds_.state();
  BlockWriter writer = writer_of(move.block);
  const auto at_end = rules_->words_at_end(move.block);
  std::string more;
  for (std::size_t i = 0; i <= edit.via.size(); ++i) {
    const bool last = i == edit.via.size();
    WantedArc piece = whole;
    piece.full_turn = false;
    piece.start_mm = piece.end_mm = at_;
    if (!last) piece.center_mm = edit.via[i].center_mm.value_or(whole.center_mm);
    Vec3 end = last ? whole.end_mm : edit.via[i].point_mm;
    if (last && whole.full_turn)
      for (const int axis : {axes.first, axes.second}) end[axis] = start[axis];
    std::vector<NewWord> words;
    if (i == 0)
      piece.end_mm = set_end(writer, move, end, more_decimals, true);
    else
      words = words_to(move, end, decimals, piece.end_mm);
    piece.sweep_rad = sweep_about(piece.center_mm, piece.start_mm, piece.end_mm, axes, whole.sweep_rad);
    const auto arc = round_arc(piece, unit_mm_, decimals);
    if (!arc) {
      at_ = start;
      feeds_.go_back_to(feed_before);
      return false;
    }
    const double feed = last ? feed_of(move, &edit) : edit.via[i].feed_mm_per_s.value_or(feed_of(move, &edit));
    if (i == 0) {
      rules_->set_arc(writer, piece, *arc, unit_mm_, decimals);
      set_feed(writer, move, feed);
    } else {
      if (move.feed_mm_per_s > 0)
        if (const auto word = feeds_.next(move, feed, nullptr)) words.push_back(*word);
      more += text_.line_end_of(move.block) + rules_->further_arc(writer, std::move(words), piece, *arc, unit_mm_,
                                                                  decimals, last ? at_end : std::vector<Word>{});
    }
    at_ = piece.end_mm;
  }
  for (const Word& word : at_end) writer.take_out(word);
  text_.replace(move.block, writer.text(text_.line_end_of(move.block)) + more);
  return true;
}

/// The coordinates that change on the way to `end`; `after` becomes the place that they say.
std::vector<NewWord> Emitter::words_to(const Move& move, const Vec3& end, int decimals, Vec3& after) const {
  std::vector<NewWord> words;
  for (int axis = 0; axis < 3; ++axis) {
    const bool step = incremental(move, nullptr);
    const double value = rounded(word_for(step, axis, end[axis]), decimals);
    const double place = place_after(step, axis, value);
    if (std::abs(place - at_[axis]) < 0.5 * step_mm(decimals)) continue;
    words.push_back({kAxis[axis], value, decimals});
    after[axis] = place;
  }
  return words;
}

}  // namespace camber::nc
