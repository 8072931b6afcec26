#include "repath/post_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/emit/text_rules.h"
#include "nc/five_axis_words.h"
#include "nc/language.h"

namespace camber::repath {
namespace {

constexpr double kNoMotionS = 1e-3;   ///< of a block in inverse time that moves nothing
constexpr double kNoLengthMm = 1e-9;  // as kinematics/feed_meaning.cpp
constexpr std::initializer_list<double> kTipControl{43.4, 43.5, 234};
constexpr std::initializer_list<double> kFeedModes{93, 94, 95};
constexpr std::initializer_list<double> kMotions{0, 1, 2, 3};

std::string tip_control_word(const nc::Dialect& dialect) {
  return std::string(nc::five_axis_words(dialect).tip_control);
}

double unit_mm(const nc::ModalState& state) { return state.inch ? kMmPerInch : 1; }

int code_of(nc::FeedMode mode) {
  return mode == nc::FeedMode::inverse_time ? 93 : mode == nc::FeedMode::per_minute ? 94 : 95;
}

nc::FeedMode mode_of_code(double code) {
  return code == 93 ? nc::FeedMode::inverse_time : code == 94 ? nc::FeedMode::per_minute : nc::FeedMode::per_revolution;
}

bool acts_at_end(const nc::Word& w) {
  constexpr std::array<double, 7> kEnds{0, 1, 2, 5, 9, 30, 60};
  if (w.letter == 'G') return w.value == 9;
  return w.letter == 'M' && std::find(kEnds.begin(), kEnds.end(), w.value) != kEnds.end();
}

int decimals_for(double value) {
  constexpr int kDigits = 5;
  if (value <= 0) return 0;
  return std::clamp(kDigits - 1 - static_cast<int>(std::floor(std::log10(value))), 0, 9);
}

}  // namespace

PostWriter::PostWriter(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                       const nc::Dialect& dialect, const PostOptions& options, const PostRounding& rounding)
    : program_(program),
      moves_(moves),
      machine_(machine),
      dialect_(dialect),
      options_(options),
      rounding_(rounding),
      style_(nc::style_of(program)),
      feed_style_(nc::feed_style_of(program)),
      tool_axis_(machine.kinematics.tool_axis.normalized()),
      gauge_mm_(machine.kinematics.gauge_point_mm) {
  for (const char letter : {'a', 'b', 'c'})
    if (machine.kinematics.chain.find(letter) != std::string::npos) axes_ += static_cast<char>(letter - 'a' + 'A');
}

BlockEdit& PostWriter::edit_of(std::uint32_t block) { return edits_.try_emplace(block, program_, block).first->second; }

/// To joints: no tool-centre-point control anywhere in the text, but the tool length.
void PostWriter::replace_codes() {
  const double on = dialect_.tip_control_on_m, off = dialect_.tip_control_off_m;
  for (std::uint32_t b = 0; b < program_.blocks.size(); ++b)
    for (const nc::Word& w : program_.words_of(b)) {
      if (w.letter == 'G' && std::find(kTipControl.begin(), kTipControl.end(), w.value) != kTipControl.end())
        edit_of(b).replace(w, "43");
      else if (w.letter == 'M' && on != 0 && (w.value == on || w.value == off))
        edit_of(b).take_out(w);
    }
}

/// Modal codes of the text on the way to a block.
void PostWriter::look_at_codes_until(std::uint32_t block) {
  for (; next_block_ < block; ++next_block_) {
    std::string number;
    const auto words = program_.words_of(next_block_);
    for (const nc::Word& w : words)
      if (w.letter == 'H')
        number = program_.source.text().substr(w.offset + w.value_at, static_cast<std::size_t>(w.length - w.value_at));
    for (const nc::Word& w : words) {
      if (w.letter == 'G' && (w.value == 43 || w.value == 44)) {
        length_active_ = true;
        length_number_ = number;
      }
      if (w.letter == 'G' && w.value == 49) length_active_ = false;
      if (w.letter == 'G' && (w.value == 93 || w.value == 94 || w.value == 95)) feed_mode_ = mode_of_code(w.value);
    }
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
  const double value = state.incremental ? wanted - now : wanted;
  const std::string_view number =
      like ? std::string_view(program_.source.text())
                 .substr(like->offset + like->value_at, static_cast<std::size_t>(like->length - like->value_at))
           : std::string_view();
  if (like && nc::rounded(value, decimals) == like->value) return std::string(number);
  return nc::format_number(value, decimals, style_, number);
}

/// The words of the place: those that change, and in the block's own text those that it has.
void PostWriter::set_places(const nc::Move& move, const PostPoint& point, BlockEdit* edit,
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

void PostWriter::set_feed(const nc::Move& move, const PostPoint& point, const Vec3& before, const Vec3& turn_deg,
                          BlockEdit* edit, std::vector<std::string>& words) {
  const nc::Word* own = edit ? edit->find('F') : nullptr;
  const bool inverse = mode_of(move) == nc::FeedMode::inverse_time;
  if (point.rapid || (point.time_s <= 0 && !inverse)) {
    if (own && !point.extra) feed_ = own->value;
    return;
  }
  const Number wanted = feed_of(move, point, before, turn_deg);
  if (wanted.value <= 0) return;  // nothing moves
  const double rounded = nc::rounded(wanted.value, wanted.decimals);
  if (!inverse && !own && rounded == feed_) return;
  const std::string number = own && own->value == rounded
                                 ? std::string(edit->number(*own))
                                 : nc::format_number(wanted.value, wanted.decimals, feed_style_);
  if (edit)
    edit->set('F', number);
  else
    words.push_back('F' + number);
  feed_ = inverse ? -1 : rounded;
  feed_is_ours_ = true;
}

/// Tool-centre-point control on.
void PostWriter::open_run(const nc::Move& move, std::vector<std::string>& lines) {
  if (options_.frame) lines.insert(lines.end(), options_.frame->before.begin(), options_.frame->before.end());
  if (options_.target != PostTarget::tcp || options_.frame) return;
  look_at_codes_until(move.block);
  const std::string number = length_active_ && !length_number_.empty() ? length_number_ : "0";
  if (dialect_.tip_control_on_m == 0) {
    if (!BlockEdit(program_, move.block).find_code('G', {43}))
      lines.push_back(tip_control_word(dialect_) + " H" + number);
    keep_tip_control(move.block, move.block + 1);
    return;
  }
  if (!length_active_) lines.push_back("G43 H0");
  lines.push_back(fmt::format("M{}", dialect_.tip_control_on_m));
}

/// Where a G code switches tool-centre-point control on, G43 and G49 of the same length switch it off.
void PostWriter::keep_tip_control(std::uint32_t first, std::uint32_t end) {
  if (options_.target != PostTarget::tcp || options_.frame || dialect_.tip_control_on_m != 0) return;
  for (std::uint32_t b = first; b < end; ++b) {
    BlockEdit block(program_, b);
    if (const nc::Word* w = block.find_code('G', {43})) edit_of(b).replace(*w, tip_control_word(dialect_).substr(1));
    if (const nc::Word* w = block.find_code('G', {49})) edit_of(b).take_out(*w);
  }
}

/// Feed mode of a feed block.
void PostWriter::write_mode(const TipMotion& motion, BlockEdit& edit, std::vector<std::string>& front) {
  const nc::FeedMode wanted = mode_of(moves_.moves[motion.move]);
  if (motion.rapid || feed_mode_ == wanted) return;
  if (const nc::Word* own = edit.find_code('G', kFeedModes))
    edit.replace(*own, std::to_string(code_of(wanted)));
  else
    front.push_back(fmt::format("G{}", code_of(wanted)));
  feed_mode_ = wanted;
  feed_is_ours_ = true;
}

void PostWriter::write_motion_code(int code, BlockEdit* edit, std::vector<std::string>& words) {
  const bool same = code == motion_code_;
  motion_code_ = code;
  const nc::Word* own = edit ? edit->find_code('G', kMotions) : nullptr;
  if (own) {
    const bool two = edit->number(*own).size() == 2;
    if (own->value != code) edit->replace(*own, fmt::format("{}{}", two ? "0" : "", code));
    return;
  }
  if (same) return;
  if (edit)
    edit->add_code(fmt::format("G{}", code));
  else
    words.push_back(fmt::format("G{}", code));
}

void PostWriter::write_motion(const TipMotion& motion, const DividedMotion& divided, bool first_of_run) {
  const nc::Move& move = moves_.moves[motion.move];
  std::vector<std::string>&front = in_front_[move.block], &further = pieces_[move.block];
  if (first_of_run) {
    open_run(move, front);
    all_words_ = true;
    motion_code_ = motion.rapid ? 0 : motion.arc ? 2 : 1;  // modal in the text, where the block does not say it
  } else {
    keep_tip_control(next_block_, move.block + 1);
  }
  look_at_codes_until(move.block + 1);
  BlockEdit& edit = edit_of(move.block);
  if (motion.arc || moves_.state_of(move).tip_control == nc::TipControl::directions)
    for (const char letter : {'I', 'J', 'K', 'R', 'P'})
      if (const nc::Word* w = edit.find(letter)) edit.take_out(*w);
  write_mode(motion, edit, front);
  std::vector<nc::Word> at_end;
  if (std::count_if(divided.points.begin(), divided.points.end(), [](const auto& p) { return !p.extra; }) > 1)
    for (const nc::Word& w : program_.words_of(move.block))
      if (acts_at_end(w)) at_end.push_back(w);
  for (const nc::Word& w : at_end) edit.take_out(w);
  bool own_text = false;
  for (const PostPoint& point : divided.points) {
    const bool first = !point.extra && !own_text;
    BlockEdit* here = first ? &edit : nullptr;
    std::vector<std::string> words;
    write_motion_code(point.rapid ? 0 : 1, here, words);
    const Vec3 before = at_, before_deg = deg_;
    set_places(move, point, here, words);
    set_feed(move, point, before, deg_ - before_deg, here, words);
    linear_mm_ = point.linear_mm;
    own_text = own_text || first;
    if (!first) {
      if (&point == &divided.points.back())
        for (const nc::Word& w : at_end) words.push_back(program_.source.text().substr(w.offset, w.length));
      (own_text ? further : front).push_back(edit.further(words));
    }
    if (!point.extra)
      lines_[move.block].push_back({static_cast<std::uint32_t>(further.size()), motion.move, point.from, point.to});
  }
}

std::string PostWriter::modal_feed_word(const nc::Move& move) const {
  const nc::ModalState& state = moves_.state_of(move);
  double value = 60 * move.feed_mm_per_s / unit_mm(state);
  if (state.feed_mode == nc::FeedMode::per_revolution && state.spindle_speed_rpm > 0) value /= state.spindle_speed_rpm;
  return "F" + nc::format_number(value, decimals_for(value), feed_style_);
}

/// The place of the linear axes in their own coordinates, where the text says that of the tip.
std::string PostWriter::place_line(const nc::Move& move) const {
  const Vec3 at = text_point(move, joint_point_mm(move, linear_mm_));
  std::string out = moves_.state_of(move).incremental ? "G90 " : "";
  out += motion_code_ == 0 ? "G0" : "G1";
  const int decimals = moves_.state_of(move).inch ? rounding_.decimals_inch : rounding_.decimals_mm;
  for (int axis = 0; axis < 3; ++axis)
    out += fmt::format(" {}{}", "XYZ"[axis], nc::format_number(at[axis], decimals, style_));
  return out;
}

/// Tool-centre-point control off.
std::vector<std::string> PostWriter::codes_behind(const nc::Move& last, std::size_t next) {
  if (options_.frame) return options_.frame->behind;
  std::vector<std::string> out;
  if (options_.target == PostTarget::joints || next >= moves_.moves.size()) return out;
  if (dialect_.tip_control_on_m != 0) {
    out.push_back(fmt::format("M{}", dialect_.tip_control_off_m));
    if (!length_active_) out.push_back("G49");
  } else {
    out.push_back(length_active_ ? "G43 H" + (length_number_.empty() ? "0" : length_number_) : "G49");
  }
  if (deg_.isZero(0)) return out;
  out.push_back(place_line(last));
  if (moves_.state_of(last).incremental) out.push_back("G91");
  return out;
}

/// Behind rewritten moves: what was modal in the given text is modal again.
void PostWriter::close_run(std::size_t last, std::size_t next) {
  const nc::Move& move = moves_.moves[last];
  std::vector<std::string>& lines = behind_[move.block];
  for (std::string& line : codes_behind(move, next)) lines.push_back(std::move(line));
  if (next >= moves_.moves.size() || !feed_is_ours_) return;
  const nc::FeedMode mode = moves_.state_of(move).feed_mode;
  std::string words;
  if (feed_mode_ != mode) words = fmt::format("G{}", code_of(mode));
  std::size_t cut = next;
  while (cut < moves_.moves.size() && moves_.moves[cut].feed_mm_per_s <= 0) ++cut;
  const bool relies = cut < moves_.moves.size() && !moves_.moves[cut].feed_given && mode != nc::FeedMode::inverse_time;
  const double given = relies ? 60 * moves_.moves[cut].feed_mm_per_s / unit_mm(moves_.state_of(moves_.moves[cut])) : 0;
  if (relies && (!words.empty() || std::abs(given - feed_) > 1e-6 * given))
    words += (words.empty() ? "" : " ") + modal_feed_word(moves_.moves[cut]);
  if (!words.empty()) lines.push_back(words);
  feed_mode_ = mode;
  feed_is_ours_ = false;
}

/// A move that stays as it is.
void PostWriter::keep(const nc::Move& move) {
  if (move.kind == nc::MoveKind::dwell) return;
  look_at_codes_until(move.block + 1);
  all_words_ = true;
  feed_ = -1;
}

void PostWriter::write(const PostMotions& motions, const std::vector<DividedMotion>& divided, Posted& out) {
  if (options_.target == PostTarget::joints) replace_codes();
  std::size_t last = PostMotions::kKept;
  for (std::size_t i = 0; i < moves_.moves.size(); ++i) {
    const std::size_t k = motions.of_move[i];
    if (k == PostMotions::kKept) {
      if (last != PostMotions::kKept && moves_.moves[i].kind != nc::MoveKind::dwell) {
        close_run(last, i);
        last = PostMotions::kKept;
      }
      keep(moves_.moves[i]);
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
  const auto rules = nc::language_of(program_).text_rules(program_);
  nc::EmittedText text(program_, *rules);
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
