#include "repath/post/post_writer.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/units.h"
#include "kinematics/control_options.h"

namespace camber::repath {
namespace {

constexpr double kNoMotionS = 1e-3;   ///< of a block in inverse time that moves nothing
constexpr double kNoLengthMm = 1e-9;  // as kinematics/feed_meaning.cpp
double unit_mm(const nc::ModalState& state) { return state.inch ? kMmPerInch : 1; }

int decimals_for(double value) {
  constexpr int kDigits = 5;
  if (value <= 0) return 0;
  return std::clamp(kDigits - 1 - static_cast<int>(std::floor(std::log10(value))), 0, 9);
}

}  // namespace

PostWriter::PostWriter(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                       const PostOptions& options, const PostRounding& rounding)
    : program_(program),
      moves_(moves),
      machine_(machine),
      options_(options),
      rounding_(rounding),
      text_(nc::five_axis_text(program, kinematics::dialect_of(machine.control.kind))),
      tool_axis_(machine.kinematics.tool_axis.normalized()),
      gauge_mm_(machine.kinematics.gauge_point_mm) {
  for (const char letter : {'a', 'b', 'c'})
    if (machine.kinematics.chain.find(letter) != std::string::npos) axes_ += static_cast<char>(letter - 'a' + 'A');
}

nc::BlockEdit& PostWriter::edit_of(std::uint32_t block) {
  const auto found = edits_.find(block);
  return found != edits_.end() ? found->second : edits_.emplace(block, text_->edit_of(block)).first->second;
}

/// To joints: no tool-centre-point control anywhere in the text, but the tool length.
void PostWriter::take_out_control() {
  for (std::uint32_t b = 0; b < program_.blocks.size(); ++b) {
    nc::BlockEdit edit = text_->edit_of(b);
    text_->take_out_control(edit);
    if (edit.changed()) edits_.emplace(b, std::move(edit));
  }
}

/// Modal codes of the text on the way to a block.
void PostWriter::look_at_codes_until(std::uint32_t block) {
  for (; next_block_ < block; ++next_block_) {
    text_->pass(next_block_);
    if (const auto mode = text_->feed_mode_of(next_block_)) feed_mode_ = *mode;
  }
}

nc::FeedMode PostWriter::mode_of(const nc::Move& move) const {
  return options_.inverse_time ? nc::FeedMode::inverse_time : moves_.state_of(move).feed_mode;
}

Vec3 PostWriter::text_point(const nc::Move& move, const Vec3& in_frame_mm) const {
  return moves_.frame_of(move).to_program(in_frame_mm) / unit_mm(moves_.state_of(move));
}

Vec3 PostWriter::joint_point_mm(const nc::Move& move, const Vec3& linear_mm) const {
  return linear_mm - *moves_.state_of(move).tool_length_mm * tool_axis_ + gauge_mm_ + *moves_.machine_origin_mm;
}

Vec3 PostWriter::wanted_point(const nc::Move& move, const PostPoint& point) const {
  if (options_.frame)
    return options_.frame->frame_from_work * text_point(move, Vec3(point.tip_mm + *moves_.machine_origin_mm));
  return text_point(move, options_.target == PostTarget::tcp ? Vec3(point.tip_mm + *moves_.machine_origin_mm)
                                                             : joint_point_mm(move, point.linear_mm));
}

std::string PostWriter::place_word(const nc::Move& move, int axis, double wanted, double now,
                                   const nc::Word* like) const {
  const nc::ModalState& state = moves_.state_of(move);
  const int decimals = axis >= 3    ? rounding_.decimals_deg
                       : state.inch ? rounding_.decimals_inch
                                    : rounding_.decimals_mm;
  const double value = text_->rules().incremental(state, like) ? wanted - now : wanted;
  const std::string_view number =
      like ? std::string_view(program_.source.text())
                 .substr(like->offset + like->value_at, static_cast<std::size_t>(like->length - like->value_at))
           : std::string_view();
  if (like && nc::rounded(value, decimals) == like->value) return std::string(number);
  return nc::format_number(value, decimals, text_->style(), number);
}

/// The words of the place: those that change, and in the block's own text those that it has.
void PostWriter::set_places(const nc::Move& move, const PostPoint& point, nc::BlockEdit* edit,
                            std::vector<std::string>& words) {
  const Vec3 wanted = wanted_point(move, point);
  const bool inch = moves_.state_of(move).inch;
  for (int axis = 0; axis < 6; ++axis) {
    const char letter = "XYZABC"[axis];
    if (axis >= 3 && (options_.frame || axes_.find(letter) == std::string::npos)) continue;
    double& now = axis < 3 ? at_[axis] : deg_[axis - 3];
    const double to = axis >= 3 ? point.rotary_deg[axis - 3]
                                : nc::rounded(wanted[axis], inch ? rounding_.decimals_inch : rounding_.decimals_mm);
    const nc::Word* own = edit ? edit->find(letter) : nullptr;
    if (!own && !all_words_ && to == now) continue;
    if (own && !text_->keeps_form(*own)) {
      text_->take_out(*edit, *own);
      own = nullptr;
    }
    const std::string number = place_word(move, axis, to, now, own);
    if (edit)
      edit->set(letter, number);
    else
      words.push_back(letter + number);
    now = to;
  }
  all_words_ = false;
}

PostWriter::Number PostWriter::feed_of(const nc::Move& move, const PostPoint& point, const Vec3& before,
                                       const Vec3& turn_deg) const {
  const nc::ModalState& state = moves_.state_of(move);
  double value = 0;
  if (mode_of(move) == nc::FeedMode::inverse_time) {
    value = 60 / (point.time_s > 0 ? point.time_s : kNoMotionS);
  } else {
    const nc::Frame& frame = moves_.frame_of(move);
    const Vec3 way = frame.plain || frame.shift_only ? Vec3(at_ - before) : Vec3(frame.linear * (at_ - before));
    const double length = way.norm();  // in the text's unit, as kinematics/feed_meaning.cpp counts it
    const double length_mm = length * unit_mm(state), deg = turn_deg.norm();
    if (length_mm < kNoLengthMm)
      value = 60 * deg / point.time_s;
    else if (options_.target == PostTarget::joints && machine_.control.rotary_feed == machine::RotaryFeed::joints)
      value = 60 * std::hypot(length_mm, deg) / point.time_s / unit_mm(state);
    else
      value = 60 * length / point.time_s;
    if (mode_of(move) == nc::FeedMode::per_revolution && state.spindle_speed_rpm > 0) value /= state.spindle_speed_rpm;
  }
  return {value, decimals_for(value)};
}

std::string PostWriter::set_feed(const nc::Move& move, const PostPoint& point, const Vec3& before, const Vec3& turn_deg,
                                 nc::BlockEdit* edit) {
  const nc::Word* own = edit ? edit->find('F') : nullptr;
  const bool inverse = mode_of(move) == nc::FeedMode::inverse_time;
  if (point.rapid || (point.time_s <= 0 && !inverse)) {
    if (own && !point.extra) feed_ = own->value;
    return {};
  }
  const Number wanted = feed_of(move, point, before, turn_deg);
  if (wanted.value <= 0) return {};  // nothing moves
  const double rounded = nc::rounded(wanted.value, wanted.decimals);
  const bool other = edit && text_->take_out_other_feeds(*edit);
  if (!inverse && !own && !other && rounded == feed_) return {};
  const std::string number = own && own->value == rounded
                                 ? std::string(edit->number(*own))
                                 : nc::format_number(wanted.value, wanted.decimals, text_->feed_style());
  if (edit) edit->set('F', number);
  feed_ = inverse ? -1 : rounded;
  feed_is_ours_ = true;
  return edit ? std::string() : 'F' + number;
}

/// Tool-centre-point control on.
void PostWriter::open_run(const nc::Move& move, std::vector<std::string>& lines) {
  if (options_.frame) lines.insert(lines.end(), options_.frame->before.begin(), options_.frame->before.end());
  if (options_.target != PostTarget::tcp || options_.frame) return;
  look_at_codes_until(move.block);
  for (std::string& line : text_->control_on(move.block)) lines.push_back(std::move(line));
  keep_tip_control(move.block, move.block + 1);
}

/// Edits these blocks so that their text does not switch tool-centre-point control off.
void PostWriter::keep_tip_control(std::uint32_t first, std::uint32_t end) {
  if (options_.target != PostTarget::tcp || options_.frame) return;
  for (std::uint32_t b = first; b < end; ++b) {
    nc::BlockEdit probe = text_->edit_of(b);
    text_->keep_control(probe);
    if (probe.changed()) text_->keep_control(edit_of(b));
  }
}

/// Feed mode of a feed block.
void PostWriter::write_mode(const TipMotion& motion, nc::BlockEdit& edit, std::vector<std::string>& front) {
  const nc::FeedMode wanted = mode_of(moves_.moves[motion.move]);
  if (motion.rapid || feed_mode_ == wanted) return;
  if (!text_->set_feed_mode(edit, wanted)) front.push_back(text_->feed_line(wanted, {}));
  feed_mode_ = wanted;
  feed_is_ours_ = true;
}

void PostWriter::write_motion(const TipMotion& motion, const DividedMotion& divided, bool first_of_run) {
  const nc::Move& move = moves_.moves[motion.move];
  std::vector<std::string>&front = in_front_[move.block], &further = pieces_[move.block];
  if (first_of_run) {
    open_run(move, front);
    all_words_ = true;
    // Modal in the text, where the block does not say it.
    rapid_ = motion.arc ? std::nullopt : std::optional(motion.rapid);
  } else {
    keep_tip_control(next_block_, move.block + 1);
  }
  look_at_codes_until(move.block + 1);
  nc::BlockEdit& edit = edit_of(move.block);
  text_->take_out_curve(edit, motion.arc, moves_.state_of(move).tip_control == nc::TipControl::directions);
  write_mode(motion, edit, front);
  std::vector<nc::Word> at_end;
  if (std::count_if(divided.points.begin(), divided.points.end(), [](const auto& p) { return !p.extra; }) > 1)
    at_end = text_->rules().words_at_end(move.block);
  for (const nc::Word& w : at_end) edit.take_out(w.offset, w.length);
  bool own_text = false;
  for (const PostPoint& point : divided.points) {
    const bool first = !point.extra && !own_text;
    nc::BlockEdit* here = first ? &edit : nullptr;
    nc::LineWords line{.rapid = point.rapid, .in_force = rapid_ == point.rapid, .places = {}, .feed = {}, .at_end = {}};
    if (first) text_->make_line(edit, line.rapid, line.in_force);
    rapid_ = point.rapid;
    const Vec3 before = at_, before_deg = deg_;
    set_places(move, point, here, line.places);
    line.feed = set_feed(move, point, before, deg_ - before_deg, here);
    linear_mm_ = point.linear_mm;
    own_text = own_text || first;
    if (!first) {
      if (&point == &divided.points.back())
        for (const nc::Word& w : at_end) line.at_end.push_back(program_.source.text().substr(w.offset, w.length));
      (own_text ? further : front).push_back(text_->further_line(edit, line));
    }
    if (!point.extra)
      lines_[move.block].push_back({static_cast<std::uint32_t>(further.size()), motion.move, point.from, point.to});
  }
}

std::string PostWriter::modal_feed_word(const nc::Move& move) const {
  const nc::ModalState& state = moves_.state_of(move);
  double value = 60 * move.feed_mm_per_s / unit_mm(state);
  if (state.feed_mode == nc::FeedMode::per_revolution && state.spindle_speed_rpm > 0) value /= state.spindle_speed_rpm;
  return "F" + nc::format_number(value, decimals_for(value), text_->feed_style());
}

/// The place of the linear axes in their own coordinates, where the text says that of the tip.
std::vector<std::string> PostWriter::place_lines(const nc::Move& move) const {
  const Vec3 at = text_point(move, joint_point_mm(move, linear_mm_));
  const int decimals = moves_.state_of(move).inch ? rounding_.decimals_inch : rounding_.decimals_mm;
  std::vector<std::string> words;
  for (int axis = 0; axis < 3; ++axis) words.push_back(text_->word("XYZ"[axis], at[axis], decimals));
  return text_->place_lines(words, rapid_.value_or(false), moves_.state_of(move).incremental);
}

/// Tool-centre-point control off.
std::vector<std::string> PostWriter::codes_behind(const nc::Move& last, std::size_t next) {
  if (options_.frame) return options_.frame->behind;
  std::vector<std::string> out;
  if (options_.target == PostTarget::joints || next >= moves_.moves.size()) return out;
  out = text_->control_off();
  if (deg_.isZero(0)) return out;
  for (std::string& line : place_lines(last)) out.push_back(std::move(line));
  return out;
}

/// Behind rewritten moves: what was modal in the given text is modal again.
void PostWriter::close_run(std::size_t last, std::size_t next) {
  const nc::Move& move = moves_.moves[last];
  std::vector<std::string>& lines = behind_[move.block];
  for (std::string& line : codes_behind(move, next)) lines.push_back(std::move(line));
  if (next >= moves_.moves.size() || !feed_is_ours_) return;
  const nc::FeedMode mode = moves_.state_of(move).feed_mode;
  std::string feed;
  const bool other_mode = feed_mode_ != mode;
  std::size_t cut = next;
  while (cut < moves_.moves.size() && moves_.moves[cut].feed_mm_per_s <= 0) ++cut;
  const bool relies = cut < moves_.moves.size() && !moves_.moves[cut].feed_given && mode != nc::FeedMode::inverse_time;
  const double given = relies ? 60 * moves_.moves[cut].feed_mm_per_s / unit_mm(moves_.state_of(moves_.moves[cut])) : 0;
  if (relies && (other_mode || std::abs(given - feed_) > 1e-6 * given)) feed = modal_feed_word(moves_.moves[cut]);
  if (other_mode || !feed.empty())
    lines.push_back(text_->feed_line(other_mode ? std::optional(mode) : std::nullopt, feed));
  feed_mode_ = mode;
  feed_is_ours_ = false;
}

/// A move that stays as it is: where it leaves the axes, a block behind it may count from.
void PostWriter::keep(std::uint32_t index) {
  const nc::Move& move = moves_.moves[index];
  if (move.kind == nc::MoveKind::dwell) return;
  look_at_codes_until(move.block + 1);
  all_words_ = true;
  feed_ = -1;
  if (move.open_axes == 0) at_ = text_point(move, move.end_mm);
  const auto target = std::ranges::lower_bound(moves_.rotary, index, {}, &nc::RotaryTarget::move);
  if (target != moves_.rotary.end() && target->move == index && !target->is_direction)
    for (Eigen::Index axis = 0; axis < 3; ++axis) deg_[axis] = deg_from_rad(target->end[axis]);
}

void PostWriter::write(const PostMotions& motions, const std::vector<DividedMotion>& divided, Posted& out) {
  if (options_.target == PostTarget::joints) take_out_control();
  std::size_t last = PostMotions::kKept;
  for (std::size_t i = 0; i < moves_.moves.size(); ++i) {
    const std::size_t k = motions.of_move[i];
    if (k == PostMotions::kKept) {
      if (last != PostMotions::kKept && moves_.moves[i].kind != nc::MoveKind::dwell) {
        close_run(last, i);
        last = PostMotions::kKept;
      }
      keep(static_cast<std::uint32_t>(i));
      continue;
    }
    if (last != PostMotions::kKept && motions.first_of_run[k]) {
      close_run(last, i);
    }
    write_motion(motions.motions[k], divided[k], motions.first_of_run[k]);
    last = i;
  }
  if (last != PostMotions::kKept) close_run(last, moves_.moves.size());
  put_together(out);
}

void PostWriter::put_together(Posted& out) {
  nc::EmittedText text(program_, text_->rules());
  std::map<std::uint32_t, std::size_t> lines_in_front;
  for (const auto& [block, edit] : edits_) {
    const std::string end = text.line_end_of(block);
    std::string all;
    for (const std::string& line : in_front_[block]) all += line + end;
    lines_in_front[block] = in_front_[block].size();
    all += edit.text();
    for (const std::string& line : pieces_[block]) all += end + line;
    for (const std::string& line : behind_[block]) all += end + line;
    text.replace(block, all);
  }
  out.text = text.text({});
  out.block_of_line = text.block_of_lines();
  std::map<std::uint32_t, std::uint32_t> first_line;
  for (std::uint32_t line = 0; line < out.block_of_line.size(); ++line)
    first_line.try_emplace(out.block_of_line[line], line);
  for (const auto& [block, pieces] : lines_)
    for (PostedPiece piece : pieces) {
      piece.line += first_line[block] + static_cast<std::uint32_t>(lines_in_front[block]);
      out.pieces.push_back(piece);
    }
  std::stable_sort(out.pieces.begin(), out.pieces.end(), [](const PostedPiece& a, const PostedPiece& b) {
    return a.move != b.move ? a.move < b.move : a.from < b.from;
  });
}

}  // namespace camber::repath
