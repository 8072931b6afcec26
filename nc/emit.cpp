#include "nc/emit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/arc_rounding.h"
#include "nc/block_writer.h"
#include "nc/frames.h"

namespace camber::nc {
namespace {

constexpr char kAxis[] = "XYZ";
constexpr char kCentre[] = "IJK";
constexpr double kSamePlaceMm = 1e-9;  ///< sums of increments; far below any decimal
constexpr int kMoreDecimals = 4;       ///< an arc may take so many decimals more to close

bool has_code(std::span<const Word> words, char letter, std::initializer_list<double> codes) {
  return std::any_of(words.begin(), words.end(), [&](const Word& w) {
    return w.letter == letter && std::find(codes.begin(), codes.end(), w.value) != codes.end();
  });
}

/// Words that act at the end of their block's move.
std::vector<Word> words_at_end(std::span<const Word> words) {
  std::vector<Word> out;
  for (const Word& w : words)
    if (has_code({&w, 1}, 'M', {0, 1, 2, 5, 9, 30, 60}) || has_code({&w, 1}, 'G', {9})) out.push_back(w);
  return out;
}

bool goes_to_machine_place(std::span<const Word> words) { return has_code(words, 'G', {28, 29, 30, 53}); }

Plane plane_of(const Arc& arc) { return arc.normal.z() != 0 ? Plane::xy : arc.normal.y() != 0 ? Plane::zx : Plane::yz; }

class Emitter {
 public:
  Emitter(const Program& program, const Interpretation& moves, std::span<const MoveEdit> edits,
          const EmitOptions& options)
      : program_(program), moves_(moves), edits_(edits), options_(options), style_(style_of(program)) {
    const std::string& text = program.source.text();
    const std::size_t end = text.find('\n');
    line_end_ = end != std::string::npos && end > 0 && text[end - 1] == '\r' ? "\r\n" : "\n";
  }

  Emission run() {
    out_.reserve(program_.source.text().size() + 64);
    add_header();
    const auto& moves = moves_.moves;
    if (!moves.empty()) at_ = moves.front().start_mm;
    for (std::size_t m = 0; m < moves.size();) {
      std::size_t end = m + 1;
      while (end < moves.size() && moves[end].block == moves[m].block) ++end;
      run_block(m, end);
      m = end;
    }
    write_replaced_blocks();
    copy_until(program_.source.text().size());
    return {std::move(out_), std::move(not_made_), block_of_lines()};
  }

 private:
  void copy_until(std::size_t offset) {
    if (offset <= copied_) return;
    out_.append(program_.source.text(), copied_, offset - copied_);
    copied_ = offset;
  }

  void add_header() {
    if (options_.header_comment.empty()) return;
    std::size_t block = 0;
    const auto& text = program_.source.text();
    while (block < program_.blocks.size()) {
      const Block& b = program_.blocks[block];
      const bool tape = b.length > 0 && text[b.offset] == '%';
      const auto words = program_.words_of(block);
      if (!tape && (words.empty() || words.front().letter != 'O')) break;
      ++block;
    }
    const std::size_t at = block < program_.blocks.size() ? program_.blocks[block].offset : text.size();
    copy_until(at);
    if (!out_.empty() && out_.back() != '\n') out_ += line_end_;
    std::size_t from = 0;
    while (from < options_.header_comment.size()) {
      const std::size_t end = std::min(options_.header_comment.find('\n', from), options_.header_comment.size());
      out_ += "(" + options_.header_comment.substr(from, end - from) + ")" + line_end_;
      from = end + 1;
      ++header_lines_;
    }
    header_before_ = block;
  }

  /// The header, then every block's own lines.
  std::vector<std::uint32_t> block_of_lines() const {
    std::vector<std::uint32_t> out;
    std::size_t next = 0;
    for (std::uint32_t block = 0; block < program_.blocks.size(); ++block) {
      if (block == header_before_) out.insert(out.end(), header_lines_, Emission::kNoBlock);
      std::size_t lines = 1;
      for (; next < replaced_.size() && replaced_[next].first == block; ++next)
        lines +=
            static_cast<std::size_t>(std::count(replaced_[next].second.begin(), replaced_[next].second.end(), '\n'));
      out.insert(out.end(), lines, block);
    }
    return out;
  }

  /// All moves [first, end) are of one block.
  void run_block(std::size_t first, std::size_t end) {
    const Move& move = moves_.moves[first];
    const MoveEdit* edit = take_edit(first, end);
    const Vec3 last_end = moves_.moves[end - 1].end_mm;
    if (!edit && (at_ - move.start_mm).cwiseAbs().maxCoeff() < kSamePlaceMm) {
      at_ = last_end;
      return;
    }
    if (move.kind == MoveKind::dwell) return;
    const Frame& frame = moves_.frame_of(move);
    if (!move.editable) {
      pass_over(first, end);
      return;
    }
    if (frame.plain) {
      run_block_in_program(move, edit, last_end, cycle_normal(first, end));
      return;
    }
    Move there = move;
    there.start_mm = frame.to_program(move.start_mm);
    there.end_mm = frame.to_program(move.end_mm);
    MoveEdit wish;
    if (edit) {
      wish = *edit;
      wish.end_mm = frame.to_program(wish.end_mm);
      wish.center_mm = frame.to_program(wish.center_mm);
      for (Vec3& via : wish.via_mm) via = frame.to_program(via);
      for (Vec3& centre : wish.via_center_mm) centre = frame.to_program(centre);
    }
    at_ = frame.to_program(at_);
    run_block_in_program(there, edit ? &wish : nullptr, frame.to_program(last_end), cycle_normal(first, end));
    at_ = frame.from_program(at_);
  }

  /// The coordinates of `move`, `edit` and at_ are those of the text.
  void run_block_in_program(const Move& move, const MoveEdit* edit, const Vec3& last_end, int normal) {
    const auto words = program_.words_of(move.block);
    unit_mm_ = moves_.state_of(move).inch ? kMmPerInch : 1.0;
    least_decimals_ = unit_mm_ == 1.0 ? options_.decimals_mm : options_.decimals_inch;
    BlockWriter writer(program_, move.block, style_);
    if (goes_to_machine_place(words)) {
      leave_for_machine_place(writer, last_end);
    } else if (move.canned) {
      drill(writer, move, last_end, normal);
    } else if (move.kind == MoveKind::rapid && !edit) {
      go_rapidly(writer, move);
    } else if (move.kind == MoveKind::arc) {
      go_on_arc(writer, move, edit);
    } else {
      go_on_line(writer, move, edit);
    }
  }

  /// The edit of the block's only move; what cannot be edited is noted and passed over.
  const MoveEdit* take_edit(std::size_t first, std::size_t end) {
    const MoveEdit* edit = nullptr;
    for (; next_edit_ < edits_.size() && edits_[next_edit_].move < end; ++next_edit_) {
      const MoveEdit& next = edits_[next_edit_];
      if (const auto why = why_not(next.move, end - first))
        not_made_.push_back({next.move, *why});
      else
        edit = &next;
    }
    return edit;
  }

  std::optional<EmitGap> why_not(std::uint32_t m, std::size_t moves_of_block) const {
    const Move& move = moves_.moves[m];
    if (move.kind == MoveKind::dwell) return EmitGap::dwell;
    if (goes_to_machine_place(program_.words_of(move.block))) return EmitGap::machine_place;
    if (move.canned) return EmitGap::canned_cycle;
    if (!move.editable) return EmitGap::not_in_text;
    if (moves_of_block > 1) return EmitGap::several_moves;
    return std::nullopt;
  }

  /// Moves that the text does not say one by one: where they go does not depend on where the tool stands, but for axes
  /// that stand still or go by increments.
  void pass_over(std::size_t first, std::size_t end) {
    const Vec3 start = moves_.moves[first].start_mm, shift = at_ - start;
    at_ = moves_.moves[end - 1].end_mm;
    for (int axis = 0; axis < 3; ++axis) {
      bool still = true;
      for (std::size_t m = first; m < end; ++m) still = still && moves_.moves[m].end_mm[axis] == start[axis];
      if (still || incremental(moves_.moves[first])) at_[axis] += shift[axis];
    }
  }

  /// Subprograms run out of the order of the text: blocks are written when all are known.
  void replace_block(std::uint32_t block, std::string text) { replaced_.emplace_back(block, std::move(text)); }

  void write_replaced_blocks() {
    std::stable_sort(replaced_.begin(), replaced_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [block, text] : replaced_) {
      copy_until(program_.blocks[block].offset);
      out_ += text;
      copied_ = program_.blocks[block].offset + program_.blocks[block].length;
    }
  }

  void replace_block(std::uint32_t block, const BlockWriter& writer) {
    if (writer.changed()) replace_block(block, writer.text());
  }

  std::string line_end_of(std::uint32_t block) const {
    const auto& text = program_.source.text();
    const std::size_t end = program_.blocks[block].offset + program_.blocks[block].length;
    const std::size_t next = text.find('\n', end);
    return next == std::string::npos ? line_end_ : text.substr(end, next + 1 - end);
  }

  // --- one axis ---------------------------------------------------------------------------------------------------

  bool incremental(const Move& move) const { return moves_.state_of(move).incremental; }

  double step_mm(int decimals) const { return unit_mm_ * std::pow(10.0, -decimals); }

  /// The word's value that takes the axis to `wanted`.
  double word_for(const Move& move, int axis, double wanted) const {
    return (incremental(move) ? wanted - at_[axis] : wanted) / unit_mm_;
  }

  double place_after(const Move& move, int axis, double value) const {
    return incremental(move) ? at_[axis] + value * unit_mm_ : value * unit_mm_;
  }

  /// Sets the words that take the tool as near to `wanted` as the decimals allow; returns where it will be.
  Vec3 set_end(BlockWriter& writer, const Move& move, const Vec3& wanted, int more_decimals, bool add_words) const {
    Vec3 after = at_;
    for (int axis = 0; axis < 3; ++axis) {
      const int decimals = writer.decimals(kAxis[axis], least_decimals_) + more_decimals;
      const bool present = writer.find(kAxis[axis]) != nullptr;
      const bool away = std::abs(wanted[axis] - at_[axis]) > 0.5 * step_mm(decimals) + kSamePlaceMm;
      if (!present && !(away && add_words)) continue;
      const double value = rounded(word_for(move, axis, wanted[axis]), decimals);
      writer.set(kAxis[axis], value, decimals);
      after[axis] = place_after(move, axis, writer.value(kAxis[axis]));
    }
    return after;
  }

  // --- kinds of blocks ----------------------------------------------------------------------------------------------

  void leave_for_machine_place(const BlockWriter& writer, const Vec3& end) {
    const bool all = !writer.find('X') && !writer.find('Y') && !writer.find('Z');
    for (int axis = 0; axis < 3; ++axis)
      if (all || writer.find(kAxis[axis])) at_[axis] = end[axis];
  }

  void go_rapidly(BlockWriter& writer, const Move& move) {
    at_ = set_end(writer, move, move.end_mm, 0, false);
    replace_block(move.block, writer);
  }

  /// A cycle drills where the tool stands or where its words say: both must be the old place.
  void drill(BlockWriter& writer, const Move& move, const Vec3& last_end, int normal) {
    Vec3 place = last_end;
    if (!incremental(move) || !writer.find('L')) {
      place[normal] = at_[normal];
      const Vec3 before = at_;
      for (int axis = 0; axis < 3; ++axis) {
        if (axis == normal) continue;
        const int decimals = writer.decimals(kAxis[axis], least_decimals_);
        const bool away = std::abs(place[axis] - before[axis]) > 0.5 * step_mm(decimals) + kSamePlaceMm;
        if (!writer.find(kAxis[axis]) && !away) continue;
        writer.set(kAxis[axis], rounded(word_for(move, axis, place[axis]), decimals), decimals);
      }
    }
    replace_block(move.block, writer);
    const double height = last_end[normal] == move.start_mm[normal] ? at_[normal] : last_end[normal];
    at_ = last_end;
    at_[normal] = height;
  }

  /// The axis that the cycle's feed moves run along.
  int cycle_normal(std::size_t first, std::size_t end) const {
    if (!moves_.moves[first].canned) return 2;
    for (std::size_t m = first; m < end; ++m) {
      const Move& move = moves_.moves[m];
      if (move.kind != MoveKind::linear) continue;
      Eigen::Index axis = 0;
      (move.end_mm - move.start_mm).cwiseAbs().maxCoeff(&axis);
      return static_cast<int>(axis);
    }
    return 2;
  }

  void go_on_line(BlockWriter& writer, const Move& move, const MoveEdit* edit) {
    std::vector<Vec3> points = points_of(move, edit);
    const Vec3 start = at_;
    at_ = set_end(writer, move, points.front(), 0, true);
    std::string more;
    if (points.size() > 1) {
      set_inverse_time_feed(writer, move, (at_ - start).norm());
      const auto at_end = words_at_end(program_.words_of(move.block));
      for (const Word& word : at_end) writer.take_out(word);
      for (std::size_t i = 1; i < points.size(); ++i)
        more += further_line(writer, move, points[i], i + 1 == points.size() ? at_end : std::vector<Word>{});
    }
    if (writer.changed() || !more.empty()) replace_block(move.block, writer.text() + more);
  }

  /// The via points and the end. Those that the decimals cannot tell from the start or the end are left out: they
  /// would be moves without length.
  std::vector<Vec3> points_of(const Move& move, const MoveEdit* edit) {
    if (!edit) return {move.end_mm};
    std::vector<Vec3> points = edit->via_mm;
    if (!points.empty() && has_code(program_.words_of(move.block), 'M', {96, 97, 98, 99})) {
      not_made_.push_back({edit->move, EmitGap::subprogram});
      points.clear();
    }
    const double near = step_mm(least_decimals_);
    const auto close = [](const Vec3& a, const Vec3& b) { return (a - b).cwiseAbs().maxCoeff(); };
    while (!points.empty() && close(points.front(), at_) < 0.5 * near) points.erase(points.begin());
    while (!points.empty() && close(points.back(), edit->end_mm) < 2 * near) points.pop_back();
    points.push_back(edit->end_mm);
    return points;
  }

  /// The F of inverse time (G93) belongs to one block: its own length counts.
  void set_inverse_time_feed(BlockWriter& writer, const Move& move, double length_mm) const {
    if (moves_.state_of(move).feed_mode != FeedMode::inverse_time || length_mm <= 0) return;
    writer.set('F', mm_per_min_from_mm_per_s(move.feed_mm_per_s) / length_mm, writer.decimals('F', 3));
  }

  /// A line end and a block with coordinates, and the words that act at its end; empty when the point rounds to where
  /// the tool stands.
  std::string further_line(const BlockWriter& writer, const Move& move, const Vec3& point,
                           const std::vector<Word>& at_end) {
    std::string letters;
    std::vector<double> values;
    Vec3 after = at_;
    for (int axis = 0; axis < 3; ++axis) {
      const double value = rounded(word_for(move, axis, point[axis]), least_decimals_);
      const double place = place_after(move, axis, value);
      if (std::abs(place - at_[axis]) < 0.5 * step_mm(least_decimals_)) continue;
      letters += kAxis[axis];
      values.push_back(value);
      after[axis] = place;
    }
    if (letters.empty() && at_end.empty()) return {};
    if (!letters.empty() && moves_.state_of(move).feed_mode == FeedMode::inverse_time) {
      letters += 'F';
      values.push_back(mm_per_min_from_mm_per_s(move.feed_mm_per_s) / (after - at_).norm());
    }
    at_ = after;
    return line_end_of(move.block) + writer.further_block(letters, values, least_decimals_, at_end);
  }

  // --- arcs ---------------------------------------------------------------------------------------------------------

  void go_on_arc(BlockWriter& writer, const Move& move, const MoveEdit* edit) {
    const Arc arc = arc_in_program(move);
    WantedArc wanted;
    wanted.plane = plane_of(arc);
    const PlaneAxes axes = axes_of(wanted.plane);
    wanted.end_mm = edit ? edit->end_mm : move.end_mm;
    wanted.center_mm = edit ? edit->center_mm : arc.center_mm;
    wanted.sweep_rad = arc.sweep_rad;
    wanted.full_turn = std::hypot(move.end_mm[axes.first] - move.start_mm[axes.first],
                                  move.end_mm[axes.second] - move.start_mm[axes.second]) < 1e-6;
    wanted.by_radius = writer.find('R') != nullptr;
    wanted.absolute_centre = moves_.state_of(move).absolute_arc_centre;
    wanted.turns = writer.find('P') ? std::max(1, static_cast<int>(std::lround(writer.value('P')))) : 1;
    if (is_as_before(writer, move, wanted)) {
      at_ = move.end_mm;
      return;
    }
    if (edit && !edit->via_mm.empty()) {
      for (int more = 0; more <= kMoreDecimals; ++more)
        if (write_arc_pieces(move, *edit, wanted, more)) return;
      if (has_code(program_.words_of(move.block), 'M', {96, 97, 98, 99}))
        not_made_.push_back({edit->move, EmitGap::subprogram});
    }
    for (int more = 0; more <= kMoreDecimals; ++more)
      if (write_arc(move, wanted, more)) return;
    // No room between the ends: the old arc, moved to where the tool stands.
    not_made_.push_back({static_cast<std::uint32_t>(&move - moves_.moves.data()), EmitGap::arc});
    wanted.end_mm = at_ + move.end_mm - move.start_mm;
    wanted.center_mm = at_ + arc.center_mm - move.start_mm;
    if (!write_arc(move, wanted, kMoreDecimals)) at_ = place_of_untouched(writer, move);
  }

  /// Start, end and centre differ from the text by less than its decimals can say.
  bool is_as_before(const BlockWriter& writer, const Move& move, const WantedArc& wanted) const {
    if ((at_ - move.start_mm).cwiseAbs().maxCoeff() >= kSamePlaceMm) return false;
    for (int axis = 0; axis < 3; ++axis) {
      const double half = 0.5 * step_mm(writer.decimals(kAxis[axis], least_decimals_));
      if (std::abs(wanted.end_mm[axis] - move.end_mm[axis]) > half) return false;
    }
    const Vec3 centre_shift = wanted.center_mm - arc_in_program(move).center_mm;
    return centre_shift.cwiseAbs().maxCoeff() <= 0.5 * step_mm(least_decimals_);
  }

  Arc arc_in_program(const Move& move) const {
    const Frame& frame = moves_.frame_of(move);
    return frame.plain ? moves_.arcs[move.arc] : to_program(frame, moves_.arcs[move.arc]);
  }

  bool write_arc(const Move& move, const WantedArc& wish, int more_decimals) {
    BlockWriter writer(program_, move.block, style_);
    WantedArc wanted = wish;
    const PlaneAxes axes = axes_of(wanted.plane);
    if (wanted.full_turn)
      for (const int axis : {axes.first, axes.second}) wanted.end_mm[axis] = at_[axis];
    wanted.start_mm = at_;
    wanted.end_mm = set_end(writer, move, wanted.end_mm, more_decimals, true);
    const char first = kCentre[axes.first], second = kCentre[axes.second];
    const int decimals = least_decimals_ + more_decimals;
    const auto arc = round_arc(wanted, unit_mm_, decimals);
    if (!arc) return false;
    if (wanted.by_radius) {
      writer.set('R', arc->r_mm / unit_mm_, decimals);
    } else {
      set_centre(writer, first, arc->first_mm, decimals);
      set_centre(writer, second, arc->second_mm, decimals);
    }
    at_ = wanted.end_mm;
    replace_block(move.block, writer);
    return true;
  }

  /// The sweep from start to end about a centre, in the sense of `like`.
  static double sweep_about(const Vec3& centre, const Vec3& start, const Vec3& end, const PlaneAxes& axes,
                            double like) {
    const auto angle = [&](const Vec3& p) {
      return std::atan2(p[axes.second] - centre[axes.second], p[axes.first] - centre[axes.first]);
    };
    double sweep = angle(end) - angle(start);
    while (sweep * like <= 0) sweep += like > 0 ? 2 * kPi : -2 * kPi;
    while (std::abs(sweep) > 2 * kPi) sweep -= like > 0 ? 2 * kPi : -2 * kPi;
    return sweep;
  }

  /// Several arcs in place of one; false, and nothing is written, where the words of one of them do not close.
  bool write_arc_pieces(const Move& move, const MoveEdit& edit, const WantedArc& whole, int more_decimals) {
    const auto words = program_.words_of(move.block);
    if (edit.via_center_mm.size() != edit.via_mm.size() || whole.turns != 1 ||
        moves_.state_of(move).feed_mode == FeedMode::inverse_time || has_code(words, 'M', {96, 97, 98, 99}))
      return false;
    const PlaneAxes axes = axes_of(whole.plane);
    const char letter[2] = {kCentre[axes.first], kCentre[axes.second]};
    const int decimals = least_decimals_ + more_decimals;
    const Vec3 start = at_;
    BlockWriter writer(program_, move.block, style_);
    const auto at_end = words_at_end(words);
    std::string more;
    for (std::size_t i = 0; i <= edit.via_mm.size(); ++i) {
      const bool last = i == edit.via_mm.size();
      WantedArc piece = whole;
      piece.full_turn = false;
      piece.start_mm = at_;
      piece.center_mm = last ? edit.center_mm : edit.via_center_mm[i];
      Vec3 end = last ? edit.end_mm : edit.via_mm[i];
      if (last && whole.full_turn)
        for (const int axis : {axes.first, axes.second}) end[axis] = start[axis];
      std::string letters;
      std::vector<double> values;
      if (i == 0) {
        piece.end_mm = set_end(writer, move, end, more_decimals, true);
      } else {
        piece.end_mm = at_;
        for (int axis = 0; axis < 3; ++axis) {
          const double value = rounded(word_for(move, axis, end[axis]), decimals);
          const double place = place_after(move, axis, value);
          if (std::abs(place - at_[axis]) < 0.5 * step_mm(decimals)) continue;
          letters += kAxis[axis];
          values.push_back(value);
          piece.end_mm[axis] = place;
        }
      }
      piece.sweep_rad = sweep_about(piece.center_mm, piece.start_mm, piece.end_mm, axes, whole.sweep_rad);
      const auto arc = round_arc(piece, unit_mm_, decimals);
      if (!arc) {
        at_ = start;
        return false;
      }
      if (i == 0 && piece.by_radius) {
        writer.set('R', arc->r_mm / unit_mm_, decimals);
      } else if (i == 0) {
        set_centre(writer, letter[0], arc->first_mm, decimals);
        set_centre(writer, letter[1], arc->second_mm, decimals);
      } else {
        letters += piece.by_radius ? std::string("R") : std::string(letter, 2);
        if (piece.by_radius) {
          values.push_back(arc->r_mm / unit_mm_);
        } else {
          values.push_back(arc->first_mm / unit_mm_);
          values.push_back(arc->second_mm / unit_mm_);
        }
        more += line_end_of(move.block) +
                writer.further_block(letters, values, decimals, last ? at_end : std::vector<Word>{});
      }
      at_ = piece.end_mm;
    }
    for (const Word& word : at_end) writer.take_out(word);
    replace_block(move.block, writer.text() + more);
    return true;
  }

  void set_centre(BlockWriter& writer, char letter, double value_mm, int decimals) const {
    if (writer.find(letter) || value_mm != 0) writer.set(letter, value_mm / unit_mm_, decimals);
  }

  Vec3 place_of_untouched(const BlockWriter& writer, const Move& move) const {
    Vec3 after = at_;
    for (int axis = 0; axis < 3; ++axis)
      if (const Word* word = writer.find(kAxis[axis])) after[axis] = place_after(move, axis, word->value);
    return after;
  }

  const Program& program_;
  const Interpretation& moves_;
  std::span<const MoveEdit> edits_;
  const EmitOptions& options_;
  NumberStyle style_;
  std::string line_end_;

  std::string out_;
  std::vector<EditNotMade> not_made_;
  std::size_t copied_ = 0;                                       ///< bytes of the source that are in out_ or replaced
  std::vector<std::pair<std::uint32_t, std::string>> replaced_;  ///< blocks and their new text
  std::size_t header_before_ = 0, header_lines_ = 0;             ///< the header stands before this block
  std::size_t next_edit_ = 0;
  Vec3 at_ = Vec3::Zero();  ///< where the emitted program has taken the tool
  double unit_mm_ = 1;
  int least_decimals_ = 4;
};

}  // namespace

std::string to_string(EmitGap why) {
  switch (why) {
    case EmitGap::canned_cycle:
      return "a drilling cycle";
    case EmitGap::machine_place:
      return "a move of G28, G30 or G53";
    case EmitGap::dwell:
      return "a dwell";
    case EmitGap::not_in_text:
      return "a move of a loop, an expression or a subprogram";
    case EmitGap::several_moves:
      return "a block of several moves";
    case EmitGap::subprogram:
      return "a block that also calls or ends a subprogram";
    case EmitGap::arc:
      break;
  }
  return "an arc that does not reach the new ends";
}

Emission emit_edits(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                    const EmitOptions& options) {
  return Emitter(program, interpretation, edits, options).run();
}

std::string emit(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                 const EmitOptions& options) {
  return emit_edits(program, interpretation, edits, options).text;
}

void warn_of_uneditable(const Program& program, const Interpretation& interpretation, const std::vector<bool>& wanted,
                        Diagnostics& diagnostics) {
  const Move* first = nullptr;
  std::size_t count = 0;
  for (std::size_t m = 0; m < interpretation.moves.size(); ++m) {
    const Move& move = interpretation.moves[m];
    if (!wanted[m] || move.editable || move.canned) continue;
    if (!first) first = &move;
    ++count;
  }
  if (!first) return;
  diagnostics.add(program.source.diagnostic(
      Severity::warning, program.blocks[first->block].offset,
      fmt::format("{} cutting move{} from here on {} made by a loop, an expression or a subprogram that is called more "
                  "than once or stands in another file; the text has no words of their own, they stay as they are",
                  count, count == 1 ? "" : "s", count == 1 ? "is" : "are"),
      "not-editable"));
}

}  // namespace camber::nc
