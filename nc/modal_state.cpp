// Words that change the modal state: G codes, F, S, T and M codes.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "nc/block_interpreter.h"

namespace camber::nc {
namespace {

constexpr const char* kAxisWords = "XYZ";
constexpr std::size_t kMaxGWords = 64;  ///< there are some 20 modal groups; each word is compared with each

bool is_whole(double value) { return value == std::floor(value) && value >= 0 && value < 1e8; }

/// Groups of which one block may hold one code.
bool is_exclusive(GGroup group) {
  return group != GGroup::no_effect && group != GGroup::not_read && group != GGroup::turning &&
         group != GGroup::unknown && group != GGroup::contouring && group != GGroup::frame;
}

/// Modal group of a strict control (LinuxCNC's manual, modal groups): a number, the same for codes that exclude each
/// other; negative: none.
int strict_group(int tenths) {
  constexpr int kNonModal = 1000;
  constexpr std::array kNonModalCodes{40, 100, 280, 281, 300, 301, 520, 530, 920, 921, 922, 923};
  if (std::ranges::find(kNonModalCodes, tenths) != kNonModalCodes.end()) return kNonModal;
  if (tenths == 800) return -1;  // goes with a motion
  GGroup group = g_code(tenths).group;
  if (group == GGroup::cycle) group = GGroup::motion;
  return is_exclusive(group) && group != GGroup::one_shot ? static_cast<int>(group) : -1;
}

/// Returns the modal group of an M code on a strict control.
int strict_m_group(int tenths) {
  switch (m_code(tenths)) {
    case MGroup::stop:
    case MGroup::end:
      return 4;
    case MGroup::tool:
      return 6;
    case MGroup::spindle:
      return 7;
    case MGroup::coolant:
      return 8;
    default:
      return tenths >= 480 && tenths <= 530 ? 9 : -1;
  }
}

/// M codes that act after the motion of their block.
bool acts_at_end(const Code& code) {
  const MGroup group = m_code(code.tenths);
  return group == MGroup::stop || group == MGroup::end || code.tenths == 50 || code.tenths == 90;
}

}  // namespace

void BlockInterpreter::add_event(EventKind kind, double value) {
  out_.events.push_back({value, block_, static_cast<std::uint32_t>(out_.moves.size()), kind, state_.incremental});
}

void BlockInterpreter::add_m_event(const Code& code) {
  switch (code.tenths) {
    case 30:
    case 130:
      return add_event(EventKind::spindle_clockwise, code.word->value);
    case 40:
    case 140:
      return add_event(EventKind::spindle_counter_clockwise, code.word->value);
    case 50:
      return add_event(EventKind::spindle_stop, code.word->value);
    case 60:
      return add_event(EventKind::tool_change, std::max(next_tool_, 0));
    case 190:
      return add_event(EventKind::spindle_orient, code.word->value);
    case 600:
      return add_event(EventKind::pallet, code.word->value);
    default:
      return add_event(EventKind::m_code, code.word->value);
  }
}

void BlockInterpreter::check_one_of_each_group() {
  if (words_.g().size() > kMaxGWords) {
    error(words_.offset(), "too-many-words",
          fmt::format("{} G words in one block; at most {} are read", words_.g().size(), kMaxGWords));
    return;
  }
  for (std::size_t i = 0; i < words_.g().size(); ++i)
    for (std::size_t k = i + 1; k < words_.g().size(); ++k) {
      const Code &a = words_.g()[i], &b = words_.g()[k];
      if (options_.dialect_or_default().strict) {
        if (strict_group(a.tenths) < 0 || strict_group(a.tenths) != strict_group(b.tenths)) continue;
        error(b.word->offset, "modal-group",
              fmt::format("{} and {} in one block are of one modal group; one of them was expected", code_text(a),
                          code_text(b)));
        continue;
      }
      if (a.tenths == b.tenths) continue;
      GGroup group_a = g_code(a.tenths).group, group_b = g_code(b.tenths).group;
      if (a.tenths == 800 || b.tenths == 800) continue;  // G80 may stand with G0..G3
      if (group_a == GGroup::cycle) group_a = GGroup::motion;
      if (group_b == GGroup::cycle) group_b = GGroup::motion;
      const bool aside = a.tenths == 90 || b.tenths == 90;  // G9 goes with every other
      if (group_a != group_b || !is_exclusive(group_a) || aside) continue;
      error(b.word->offset, "modal-group",
            fmt::format("{} and {} in one block exclude each other; one of them was expected", code_text(a),
                        code_text(b)));
    }
}

/// Axis words of a block belong to one code, and a cycle needs some.
void BlockInterpreter::check_strict_block() {
  const bool axes = words_.has_any("XYZABCUVW");
  const Word* motion = request_.motion_given || request_.cycle_given ? request_.motion_word : nullptr;
  if (request_.cycle_given && !axes)
    error(motion->offset, "cycle", fmt::format("G{:g} without axis words; X, Y or Z was expected", motion->value));
  const auto takes_axes = [](const Code& c) {
    return c.tenths == 100 || c.tenths == 280 || c.tenths == 300 || c.tenths == 520 || c.tenths == 920;
  };
  const auto other = std::ranges::find_if(words_.g(), takes_axes);
  if (axes && motion && other != words_.g().end())
    error(other->word->offset, "modal-group",
          fmt::format("{} and G{:g} in one block both use axis words; one of them was expected", code_text(*other),
                      motion->value));
  const auto off = std::ranges::find(words_.g(), 800, &Code::tenths);
  if (axes && !motion && off != words_.g().end() && other == words_.g().end())
    error(off->word->offset, "modal-group", "G80 with axis words and no motion; G0, G1, G2 or G3 was expected");
}

/// Checks the groups of M codes of a block on a strict control.
void BlockInterpreter::check_m_groups() {
  if (!options_.dialect_or_default().strict) return;
  const auto& codes = words_.m();
  for (std::size_t i = 0; i < std::min(codes.size(), kMaxGWords); ++i)
    for (std::size_t k = i + 1; k < std::min(codes.size(), kMaxGWords); ++k)
      if (const int group = strict_m_group(codes[i].tenths); group >= 0 && group == strict_m_group(codes[k].tenths))
        error(codes[k].word->offset, "modal-group",
              fmt::format("{} and {} in one block are of one modal group; one of them was expected",
                          code_text(codes[i]), code_text(codes[k])));
}

bool BlockInterpreter::read_g_codes() {
  if (words_.g().size() > 1) check_one_of_each_group();
  // Units and feed mode first: they say how the other words of the block are meant.
  for (const Code& code : words_.g()) {
    if (code.tenths == 200 || code.tenths == 210) {
      state_.inch = code.tenths == 200;
      unit_given_ = state_changed_ = true;
    }
  }
  for (const Code& code : words_.g())
    if (!read_g_code(code, g_code(code.tenths))) return false;
  return true;
}

bool BlockInterpreter::read_g_code(const Code& code, const GCode& meaning) {
  if (code.tenths == 500 && words_.has('S')) {
    error(code.word->offset, "turning",
          "G50 with S (largest spindle speed) belongs to a turning program; milling programs are read");
    return false;
  }
  if (options_.dialect_or_default().haas_work_offsets && haas_work_offset_of(code.tenths) > 0) {
    set_work_offset(code);
    return state_changed_ = true;
  }
  switch (meaning.group) {
    case GGroup::motion:
      set_motion(code);
      break;
    case GGroup::cycle:
      set_cycle(code);
      break;
    case GGroup::plane:
      set_plane(code);
      break;
    case GGroup::distance:
      state_.incremental = code.tenths == 910;
      break;
    case GGroup::arc_distance:
      state_.absolute_arc_centre = code.tenths == 901;
      centre_mode_given_ = true;
      break;
    case GGroup::feed_mode:
      set_feed_mode(code.tenths == 930   ? FeedMode::inverse_time
                    : code.tenths == 940 ? FeedMode::per_minute
                                         : FeedMode::per_revolution);
      break;
    case GGroup::unit:
      break;
    case GGroup::cutter_radius:
      read_radius_code(code);
      break;
    case GGroup::frame:
      read_frame_code(code);
      break;
    case GGroup::tool_length:
      set_tool_length(code);
      break;
    case GGroup::work_offset:
      set_work_offset(code);
      break;
    case GGroup::path_control:
      set_path_control(code.tenths);
      break;
    case GGroup::return_level:
      return_to_r_ = code.tenths == 990;
      break;
    case GGroup::one_shot:
      if (code.tenths == 281 || code.tenths == 301) {
        store_reference(code);
        break;
      }
      request_.dwell |= code.tenths == 40;
      request_.exact_stop |= code.tenths == 90;
      request_.machine_frame |= code.tenths == 530;
      if (code.tenths == 280 || code.tenths == 300) {
        request_.reference = true;
        request_.reference_word = code.word;
      }
      request_.return_from_reference |= code.tenths == 290;
      request_.single_direction |= code.tenths == 600;
      break;
    case GGroup::contouring:
      set_contouring(code);
      break;
    case GGroup::macro:
      break;
    case GGroup::no_effect:
      if (code.tenths == 1870 || code.tenths == 1030) words_.use("PE");
      break;
    case GGroup::not_read:
      error(code.word->offset, "not-read", fmt::format("{} ({}) is not supported", code_text(code), meaning.name),
            code_text(code));
      request_.skip_motion |= meaning.owns_words;
      words_.use("D");
      break;
    case GGroup::turning:
      error(code.word->offset, "turning",
            fmt::format("{} ({}) belongs to a turning program; milling programs are read", code_text(code),
                        meaning.name));
      return false;
    case GGroup::unknown:
      error(code.word->offset, "unknown-g", fmt::format("{} is not a G code that Camber knows", code_text(code)));
      request_.skip_motion = true;
      break;
  }
  state_changed_ = true;
  return true;
}

void BlockInterpreter::set_motion(const Code& code) {
  constexpr std::array kMotions = {Motion::rapid, Motion::linear, Motion::clockwise, Motion::counter_clockwise};
  motion_ = kMotions[static_cast<std::size_t>(code.tenths / 10)];
  spiral_ = code.tenths % 10 != 0;
  cycle_ = {};
  request_.motion_given = true;
  request_.motion_word = code.word;
}

void BlockInterpreter::set_cycle(const Code& code) {
  if (code.tenths == 800) {
    cycle_ = {};
    return;
  }
  if (cycle_.g == 0) cycle_.initial_mm = programmed()[axes_of(plane_).normal];
  cycle_.g = code.tenths == 843 ? 74 : code.tenths / 10;  // G84.2, G84.3: tapping in step, right and left hand
  request_.cycle_given = true;
  request_.motion_word = code.word;
}

void BlockInterpreter::set_plane(const Code& code) {
  const Plane plane = code.tenths == 170 ? Plane::xy : code.tenths == 180 ? Plane::zx : Plane::yz;
  if (plane != plane_ && radius_.active && radius_.radius_mm != 0)
    error(
        code.word->offset, "cutter-radius",
        fmt::format("{} changes the plane under G{}; G40 was expected before", code_text(code), radius_.g_tenths / 10));
  plane_ = plane;
  state_.plane_g = static_cast<std::uint8_t>(plane == Plane::xy ? 17 : plane == Plane::zx ? 18 : 19);
  state_changed_ = true;
}

/// G154 P1 to P99, G110 to G129; 0: another code; negative: an error was reported.
int BlockInterpreter::additional_work_offset(const Code& code) {
  constexpr double kLast = 99;
  const bool haas = options_.dialect_or_default().haas_work_offsets;
  if (haas && haas_work_offset_of(code.tenths) > 0) return haas_work_offset_of(code.tenths);
  if (code.tenths != 1540) return 0;
  if (!haas) {
    error(code.word->offset, "unknown-g",
          fmt::format("G154 is the additional work offset of Haas; G54.1 P was expected in a {} program (--dialect)",
                      options_.dialect_or_default().title));
    words_.use("P");
    return -1;
  }
  const double p = words_.has('P') ? words_.value('P') : 0;
  if (is_whole(p) && p >= 1 && p <= kLast) return static_cast<int>(p);
  error(words_.has('P') ? words_.offset_of('P') : code.word->offset, "work-offset",
        words_.has('P') ? fmt::format("G154 P{} is not a work offset; P1 to P{} was expected", p, kLast)
                        : fmt::format("G154 has no number; P1 to P{} was expected", kLast));
  return -1;
}

void BlockInterpreter::set_work_offset(const Code& code) {
  const int before = state_.work_offset;
  if (const int additional = additional_work_offset(code); additional != 0) {
    if (additional < 0) return;
    state_.work_offset = 540000 + additional;
  } else if (code.tenths >= 591) {
    state_.work_offset = code.tenths;
  } else if (code.tenths == 541) {
    if (!words_.has('P') || !is_whole(words_.value('P')))
      error(code.word->offset, "work-offset", "G54.1 needs a P with the number of the offset");
    else
      state_.work_offset = 540000 + static_cast<int>(words_.value('P'));
  } else {
    state_.work_offset = code.tenths / 10;
    // G54 P3 is another way to write G54.1 P3.
    if (code.tenths == 540 && words_.has('P') && !request_.dwell && is_whole(words_.value('P')))
      state_.work_offset = 540000 + static_cast<int>(words_.value('P'));
  }
  if (state_.work_offset == before) return;
  if (!pending_offsets_.empty()) take_pending_offset();
  if (state_.work_frame != WorkFrame::machine)
    error(code.word->offset, "tilted-frame",
          fmt::format("{} changes the work offset while {} is active; {} was expected before", code_text(code),
                      state_.work_frame == WorkFrame::tilted ? "a tilted frame" : "the dynamic work offset (G254)",
                      state_.work_frame == WorkFrame::tilted ? "G69" : "G255"));
  if (radius_.active && radius_.radius_mm != 0)
    error(code.word->offset, "cutter-radius",
          fmt::format("{} changes the work offset under G{}; G40 was expected before", code_text(code),
                      radius_.g_tenths / 10));
  if (frames_used_) update_frame();
}

void BlockInterpreter::set_path_control(int tenths) {
  state_.path_control = tenths == 610   ? PathControl::exact_path
                        : tenths == 611 ? PathControl::exact_stop
                                        : PathControl::blend;
  state_.path_g = static_cast<std::uint8_t>(tenths / 10);
  if (tenths != 640) return;
  state_.blend_tolerance_mm = words_.scaled('P', unit_mm()).value_or(-1);
  state_.merge_tolerance_mm = words_.scaled('Q', unit_mm()).value_or(-1);
  for (const char letter : {'P', 'Q'})
    if (words_.has(letter) && words_.value(letter) < 0)
      error(words_.offset_of(letter), "blend-tolerance", fmt::format("the tolerance {} of G64 is negative", letter));
}

void BlockInterpreter::set_tool_length(const Code& code) {
  words_.use("H");
  if (code.tenths == 431) words_.use("IJK");
  set_tip_control_g(code);
}

void BlockInterpreter::set_feed_mode(FeedMode mode) {
  request_.feed_mode_given = true;
  if (mode == state_.feed_mode) return;
  state_.feed_mode = mode;
  feed_.reset();
  feed_given_ = true;
}

void BlockInterpreter::set_contouring(const Code& code) {
  if (code.tenths >= static_cast<int>(10 * kCycle832)) {
    state_.contouring = code.tenths == static_cast<int>(10 * kCycle832) ? Contouring::cycle832 : Contouring::none;
    return;
  }
  words_.use("PQRL");
  const char letter = code.tenths == 51 ? 'Q' : 'P';
  if (code.tenths == 50 && !words_.has('P')) {
    error(code.word->offset, "not-read", "G5 (spline) is not supported");
    request_.skip_motion = true;
    return;
  }
  state_.high_speed_contouring = words_.has(letter) && words_.value(letter) > 0;
  state_.contouring = !state_.high_speed_contouring ? Contouring::none
                      : code.tenths == 51           ? Contouring::g05_1_q1
                      : code.tenths == 50           ? Contouring::g05_p10000
                                                    : Contouring::g08_p1;
}

void BlockInterpreter::read_feed() {
  if (!words_.has('F')) return;
  const double value = words_.value('F');
  if (value < 0) {
    error(words_.offset_of('F'), "feed-negative", "the feed F is negative; a feed greater than zero was expected");
    return;
  }
  feed_given_ = true;
  feed_by_variable_ = !written_as_number(words_.word('F'));
  switch (state_.feed_mode) {
    case FeedMode::per_minute:
      feed_ = value * unit_mm() / 60.0;
      break;
    case FeedMode::inverse_time:
      feed_ = value / 60.0;
      break;
    case FeedMode::per_revolution:
      feed_ = value * unit_mm();
      break;
  }
}

void BlockInterpreter::read_spindle_speed() {
  if (!words_.has('S')) return;
  const double value = words_.value('S');
  if (value < 0) {
    error(words_.offset_of('S'), "spindle-negative", "the spindle speed S is negative; zero or more was expected");
    return;
  }
  add_event(EventKind::spindle_speed, value);
  state_changed_ |= value != state_.programmed_spindle_speed_rpm;
  state_.programmed_spindle_speed_rpm = value;
  state_.spindle_speed_rpm = std::min(value, options_.max_spindle_speed_rpm);
}

void BlockInterpreter::read_tool() {
  if (!words_.has('T')) return;
  const double value = words_.value('T');
  if (!is_whole(value)) {
    error(words_.offset_of('T'), "tool-number", "the tool number T is not a whole number of zero or more");
    return;
  }
  if (next_tool_ < 0) tool_word_offset_ = words_.offset_of('T');
  next_tool_ = static_cast<int>(value);
  add_event(EventKind::tool_select, value);
}

bool BlockInterpreter::read_m_codes_before() {
  check_m_groups();
  const Word* spindle = nullptr;
  for (const Code& code : words_.m()) {
    if (read_clamp(code) || read_tip_control_m(code)) continue;
    if (!acts_at_end(code)) add_m_event(code);
    switch (m_code(code.tenths)) {
      case MGroup::spindle:
        if (spindle && spindle->value != code.word->value && !options_.dialect_or_default().strict)
          error(code.word->offset, "modal-group",
                fmt::format("M{} and {} in one block exclude each other; one of them was expected", spindle->value,
                            code_text(code)));
        spindle = code.word;
        if (code.tenths == 130 || code.tenths == 140) state_.coolant = true;
        if (code.tenths != 50)
          state_.spindle = code.tenths == 30 || code.tenths == 130 ? SpindleDirection::clockwise
                                                                   : SpindleDirection::counter_clockwise;
        break;
      case MGroup::tool:
        if (next_tool_ < 0)
          error(code.word->offset, "tool-missing",
                "M6 without a tool: no T was given so far; T with a number was expected");
        else
          state_.tool = next_tool_;
        if (!out_.moves.empty()) out_.moves.back().exact_stop = true;
        tool_changed_ = true;
        break;
      case MGroup::coolant:
        if (code.tenths != 90) state_.coolant = true;
        break;
      case MGroup::interruption:
        error(code.word->offset, "not-read",
              fmt::format("interruption by a macro ({}) is not supported", code_text(code)), "M96");
        request_.skip_motion = true;
        break;
      case MGroup::subprogram:
        break;
      case MGroup::unknown:
        if (code.tenths < 0 || code.tenths % 10 != 0 || code.tenths > 9990)
          error(code.word->offset, "unknown-m", fmt::format("{} is not an M code", code_text(code)));
        else
          report_.warning(code.word->offset, "unknown-m",
                          fmt::format("{} is not known; it is assumed to have no effect on the path", code_text(code)));
        words_.use("PQR");
        break;
      case MGroup::no_effect:
        words_.use("PQR");
        break;
      case MGroup::stop:
      case MGroup::end:
        break;
    }
    state_changed_ = true;
  }
  return true;
}

bool BlockInterpreter::read_m_codes_after() {
  bool go_on = true;
  for (const Code& code : words_.m()) {
    if (acts_at_end(code)) add_m_event(code);
    switch (m_code(code.tenths)) {
      case MGroup::end:
        go_on = false;
        [[fallthrough]];
      case MGroup::stop:
        if (!out_.moves.empty()) out_.moves.back().exact_stop = true;
        break;
      case MGroup::spindle:
        if (code.tenths == 50) state_.spindle = SpindleDirection::stopped;
        break;
      case MGroup::coolant:
        if (code.tenths == 90) state_.coolant = false;
        break;
      default:
        break;
    }
    state_changed_ = true;
  }
  return go_on;
}

void BlockInterpreter::check_letters() {
  for (const char letter : {'A', 'B', 'C'}) {
    if (!words_.has(letter)) continue;
    if (letter == 'B' && options_.index_table)
      add_event(EventKind::index, words_.value(letter));
    else if (!rotary_axis(letter))
      check_rotary_letter(letter);
  }
  for (const char letter : {'V', 'W', 'U'}) {
    if (!words_.has(letter) || (letter == 'U' && request_.dwell)) continue;
    error(words_.offset_of(letter), "unknown-letter",
          fmt::format("axis {} is not supported; X, Y and Z were expected", letter), std::string(1, letter));
    words_.use("UVW");
  }
}

/// D and H beside codes that do not use them, which a strict control refuses.
void BlockInterpreter::check_offset_numbers() {
  for (const char letter : {'D', 'H'}) {
    if (!words_.has(letter) || (words_.unused() & (1U << (letter - 'A'))) == 0) continue;
    words_.use(letter == 'D' ? "D" : "H");
    error(words_.offset_of(letter), "offset-number",
          fmt::format("{} in a block without a code that uses it; {} was expected", letter,
                      letter == 'D' ? "G41, G41.1, G42 or G42.1" : "G43"),
          std::string(1, letter));
  }
}

void BlockInterpreter::warn_of_unused_words() {
  if (request_.trouble) return;
  words_.use("NOFST");
  if (options_.dialect_or_default().strict)
    check_offset_numbers();
  else
    words_.use("DH");  // numbers of offsets: the tip is what is programmed
  if (!words_.m().empty()) words_.use("PQRL");
  const std::uint32_t unused = words_.unused();
  if (unused == 0) return;
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    if ((unused & (1u << (letter - 'A'))) == 0) continue;
    const Word& word = words_.word(letter);
    if (letter == 'E')
      error(word.offset, "unknown-letter", "E is not a letter of a milling program", "E");
    else if (word.value != 0 || std::string_view(kAxisWords).find(letter) != std::string_view::npos)
      report_.warning(word.offset, "unused-word",
                      fmt::format("{} has no meaning in this block and is ignored",
                                  program_->source.text().substr(word.offset, word.length)),
                      std::string(1, letter));
  }
}

}  // namespace camber::nc
