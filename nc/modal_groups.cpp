#include "nc/modal_groups.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "nc/shared_states.h"

namespace camber::nc {
namespace {

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

ModalGroups::ModalGroups(BlockContext& at) : at_(at), unit_given_(at.options.inch.has_value()) {
  state_.inch = at.options.inch.value_or(false);
  state_.absolute_arc_centre = at.options.absolute_arc_centre;
}

void ModalGroups::add_event(EventKind kind, double value) {
  at_.out.events.push_back(
      {value, at_.block, static_cast<std::uint32_t>(at_.out.moves.size()), kind, state_.incremental});
}

void ModalGroups::add_m_event(const Code& code) {
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

void ModalGroups::check_one_of_each_group() {
  if (at_.words.g().size() > kMaxGWords) {
    at_.error(at_.words.offset(), "too-many-words",
              fmt::format("{} G words in one block; at most {} are read", at_.words.g().size(), kMaxGWords));
    return;
  }
  for (std::size_t i = 0; i < at_.words.g().size(); ++i)
    for (std::size_t k = i + 1; k < at_.words.g().size(); ++k) {
      const Code &a = at_.words.g()[i], &b = at_.words.g()[k];
      if (at_.dialect().strict) {
        if (strict_group(a.tenths) < 0 || strict_group(a.tenths) != strict_group(b.tenths)) continue;
        at_.error(b.word->offset, "modal-group",
                  fmt::format("{} and {} in one block are of one modal group; one of them was expected",
                              at_.code_text(a), at_.code_text(b)));
        continue;
      }
      if (a.tenths == b.tenths) continue;
      GGroup group_a = g_code(a.tenths).group, group_b = g_code(b.tenths).group;
      if (a.tenths == 800 || b.tenths == 800) continue;  // G80 may stand with G0..G3
      if (group_a == GGroup::cycle) group_a = GGroup::motion;
      if (group_b == GGroup::cycle) group_b = GGroup::motion;
      const bool aside = a.tenths == 90 || b.tenths == 90;  // G9 goes with every other
      if (group_a != group_b || !is_exclusive(group_a) || aside) continue;
      at_.error(b.word->offset, "modal-group",
                fmt::format("{} and {} in one block exclude each other; one of them was expected", at_.code_text(a),
                            at_.code_text(b)));
    }
}

/// Axis words of a block belong to one code, and a cycle needs some.
void ModalGroups::check_strict_block() {
  const bool axes = at_.words.has_any("XYZABCUVW");
  const Word* motion = at_.request.motion_given || at_.request.cycle_given ? at_.request.motion_word : nullptr;
  if (at_.request.cycle_given && !axes)
    at_.error(motion->offset, "cycle", fmt::format("G{:g} without axis words; X, Y or Z was expected", motion->value));
  const auto takes_axes = [](const Code& c) {
    return c.tenths == 100 || c.tenths == 280 || c.tenths == 300 || c.tenths == 520 || c.tenths == 920;
  };
  const auto other = std::ranges::find_if(at_.words.g(), takes_axes);
  if (axes && motion && other != at_.words.g().end())
    at_.error(other->word->offset, "modal-group",
              fmt::format("{} and G{:g} in one block both use axis words; one of them was expected",
                          at_.code_text(*other), motion->value));
  const auto off = std::ranges::find(at_.words.g(), 800, &Code::tenths);
  if (axes && !motion && off != at_.words.g().end() && other == at_.words.g().end())
    at_.error(off->word->offset, "modal-group", "G80 with axis words and no motion; G0, G1, G2 or G3 was expected");
}

/// Checks the groups of M codes of a block on a strict control.
void ModalGroups::check_m_groups() {
  if (!at_.dialect().strict) return;
  const auto& codes = at_.words.m();
  for (std::size_t i = 0; i < std::min(codes.size(), kMaxGWords); ++i)
    for (std::size_t k = i + 1; k < std::min(codes.size(), kMaxGWords); ++k)
      if (const int group = strict_m_group(codes[i].tenths); group >= 0 && group == strict_m_group(codes[k].tenths))
        at_.error(codes[k].word->offset, "modal-group",
                  fmt::format("{} and {} in one block are of one modal group; one of them was expected",
                              at_.code_text(codes[i]), at_.code_text(codes[k])));
}

void ModalGroups::set_motion(const Code& code) {
  constexpr std::array kMotions = {MotionCode::rapid, MotionCode::linear, MotionCode::clockwise,
                                   MotionCode::counter_clockwise};
  motion_ = kMotions[static_cast<std::size_t>(code.tenths / 10)];
  spiral_ = code.tenths % 10 != 0;
  cycle_g_ = 0;
  at_.request.motion_given = true;
  at_.request.motion_word = code.word;
}

void ModalGroups::set_cycle(const Code& code) {
  if (code.tenths == 800) {
    cycle_g_ = 0;
    return;
  }
  cycle_g_ = code.tenths == 843 ? 74 : code.tenths / 10;  // G84.2, G84.3: tapping in step, right and left hand
  at_.request.cycle_given = true;
  at_.request.motion_word = code.word;
}

void ModalGroups::set_plane(const Code& code) {
  const Plane plane = code.tenths == 170 ? Plane::xy : code.tenths == 180 ? Plane::zx : Plane::yz;
  if (plane != plane_ && state_.cutter_radius)
    at_.error(code.word->offset, "cutter-radius",
              fmt::format("{} changes the plane under G{}; G40 was expected before", at_.code_text(code), radius_g_));
  plane_ = plane;
  state_.plane_g = static_cast<std::uint8_t>(plane == Plane::xy ? 17 : plane == Plane::zx ? 18 : 19);
  state_changed_ = true;
}

/// G154 P1 to P99, G110 to G129; 0: another code; negative: an error was reported.
int ModalGroups::additional_work_offset(const Code& code) {
  constexpr double kLast = 99;
  const bool haas = at_.dialect().haas_work_offsets;
  if (haas && haas_work_offset_of(code.tenths) > 0) return haas_work_offset_of(code.tenths);
  if (code.tenths != 1540) return 0;
  if (!haas) {
    at_.error(
        code.word->offset, "unknown-g",
        fmt::format("G154 is the additional work offset of Haas; G54.1 P was expected in a {} program (--dialect)",
                    at_.dialect().title));
    at_.words.use("P");
    return -1;
  }
  const double p = at_.words.has('P') ? at_.words.value('P') : 0;
  if (is_whole(p) && p >= 1 && p <= kLast) return static_cast<int>(p);
  at_.error(at_.words.has('P') ? at_.words.offset_of('P') : code.word->offset, "work-offset",
            at_.words.has('P') ? fmt::format("G154 P{} is not a work offset; P1 to P{} was expected", p, kLast)
                               : fmt::format("G154 has no number; P1 to P{} was expected", kLast));
  return -1;
}

bool ModalGroups::set_work_offset(const Code& code) {
  const int before = state_.work_offset;
  if (const int additional = additional_work_offset(code); additional != 0) {
    if (additional < 0) return false;
    state_.work_offset = 540000 + additional;
  } else if (code.tenths >= 591) {
    state_.work_offset = code.tenths;
  } else if (code.tenths == 541) {
    if (!at_.words.has('P') || !is_whole(at_.words.value('P')))
      at_.error(code.word->offset, "work-offset", "G54.1 needs a P with the number of the offset");
    else
      state_.work_offset = 540000 + static_cast<int>(at_.words.value('P'));
  } else {
    state_.work_offset = code.tenths / 10;
    // G54 P3 is another way to write G54.1 P3.
    if (code.tenths == 540 && at_.words.has('P') && !at_.request.dwell && is_whole(at_.words.value('P')))
      state_.work_offset = 540000 + static_cast<int>(at_.words.value('P'));
  }
  if (state_.work_offset == before) return false;
  if (state_.work_frame != WorkFrame::machine)
    at_.error(code.word->offset, "tilted-frame",
              fmt::format("{} changes the work offset while {} is active; {} was expected before", at_.code_text(code),
                          state_.work_frame == WorkFrame::tilted ? "a tilted frame" : "the dynamic work offset (G254)",
                          state_.work_frame == WorkFrame::tilted ? "G69" : "G255"));
  if (state_.cutter_radius)
    at_.error(
        code.word->offset, "cutter-radius",
        fmt::format("{} changes the work offset under G{}; G40 was expected before", at_.code_text(code), radius_g_));
  return true;
}

void ModalGroups::set_path_control(int tenths) {
  state_.path_control = tenths == 610   ? PathControl::exact_path
                        : tenths == 611 ? PathControl::exact_stop
                                        : PathControl::blend;
  state_.path_g = static_cast<std::uint8_t>(tenths / 10);
  if (tenths != 640) return;
  state_.blend_tolerance_mm = at_.words.scaled('P', unit_mm()).value_or(-1);
  state_.merge_tolerance_mm = at_.words.scaled('Q', unit_mm()).value_or(-1);
  for (const char letter : {'P', 'Q'})
    if (at_.words.has(letter) && at_.words.value(letter) < 0)
      at_.error(at_.words.offset_of(letter), "blend-tolerance",
                fmt::format("the tolerance {} of G64 is negative", letter));
}

void ModalGroups::set_feed_mode(FeedMode mode) {
  at_.request.feed_mode_given = true;
  if (mode == state_.feed_mode) return;
  state_.feed_mode = mode;
  feed_.reset();
  feed_given_ = true;
}

void ModalGroups::set_contouring(const Code& code) {
  if (code.tenths >= static_cast<int>(10 * kCycle832)) {
    state_.contouring = code.tenths == static_cast<int>(10 * kCycle832) ? Contouring::cycle832 : Contouring::none;
    return;
  }
  at_.words.use("PQRL");
  const char letter = code.tenths == 51 ? 'Q' : 'P';
  const bool has_axes = at_.words.has('X') || at_.words.has('Y') || at_.words.has('Z');
  if ((code.tenths == 50 && !at_.words.has('P')) || (code.tenths <= 51 && has_axes)) {
    at_.words.use("XYZIJK");
    at_.error(code.word->offset, "not-read", fmt::format("{} (spline) is not supported", at_.code_text(code)));
    at_.request.skip_motion = true;
    return;
  }
  state_.high_speed_contouring = at_.words.has(letter) && at_.words.value(letter) > 0;
  state_.contouring = !state_.high_speed_contouring ? Contouring::none
                      : code.tenths == 51           ? Contouring::g05_1_q1
                      : code.tenths == 50           ? Contouring::g05_p10000
                                                    : Contouring::g08_p1;
}

void ModalGroups::read_feed() {
  if (!at_.words.has('F')) return;
  const double value = at_.words.value('F');
  if (value < 0) {
    at_.error(at_.words.offset_of('F'), "feed-negative",
              "the feed F is negative; a feed greater than zero was expected");
    return;
  }
  feed_given_ = true;
  feed_by_variable_ = !at_.written_as_number(at_.words.word('F'));
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

void ModalGroups::read_spindle_speed() {
  if (!at_.words.has('S')) return;
  const double value = at_.words.value('S');
  if (value < 0) {
    at_.error(at_.words.offset_of('S'), "spindle-negative",
              "the spindle speed S is negative; zero or more was expected");
    return;
  }
  add_event(EventKind::spindle_speed, value);
  state_changed_ |= value != state_.programmed_spindle_speed_rpm;
  state_.programmed_spindle_speed_rpm = value;
  state_.spindle_speed_rpm = std::min(value, at_.options.max_spindle_speed_rpm);
}

void ModalGroups::read_tool() {
  if (!at_.words.has('T')) return;
  const double value = at_.words.value('T');
  if (!is_whole(value)) {
    at_.error(at_.words.offset_of('T'), "tool-number", "the tool number T is not a whole number of zero or more");
    return;
  }
  if (next_tool_ < 0) tool_word_offset_ = at_.words.offset_of('T');
  next_tool_ = static_cast<int>(value);
  add_event(EventKind::tool_select, value);
}

void ModalGroups::read_m_codes_before(const std::function<bool(const Code&)>& is_read) {
  check_m_groups();
  const Word* spindle = nullptr;
  for (const Code& code : at_.words.m()) {
    if (is_read(code)) continue;
    if (!acts_at_end(code)) add_m_event(code);
    switch (m_code(code.tenths)) {
      case MGroup::spindle:
        if (spindle && spindle->value != code.word->value && !at_.dialect().strict)
          at_.error(code.word->offset, "modal-group",
                    fmt::format("M{} and {} in one block exclude each other; one of them was expected", spindle->value,
                                at_.code_text(code)));
        spindle = code.word;
        if (code.tenths == 130 || code.tenths == 140) state_.coolant = true;
        if (code.tenths != 50)
          state_.spindle = code.tenths == 30 || code.tenths == 130 ? SpindleDirection::clockwise
                                                                   : SpindleDirection::counter_clockwise;
        break;
      case MGroup::tool:
        if (next_tool_ < 0)
          at_.error(code.word->offset, "tool-missing",
                    "M6 without a tool: no T was given so far; T with a number was expected");
        else
          state_.tool = next_tool_;
        if (!at_.out.moves.empty()) at_.out.moves.back().exact_stop = true;
        tool_changed_ = true;
        break;
      case MGroup::coolant:
        if (code.tenths != 90) state_.coolant = true;
        break;
      case MGroup::interruption:
        at_.error(code.word->offset, "not-read",
                  fmt::format("interruption by a macro ({}) is not supported", at_.code_text(code)), "M96");
        at_.request.skip_motion = true;
        break;
      case MGroup::subprogram:
        break;
      case MGroup::unknown:
        if (code.tenths < 0 || code.tenths % 10 != 0 || code.tenths > 9990)
          at_.error(code.word->offset, "unknown-m", fmt::format("{} is not an M code", at_.code_text(code)));
        else
          at_.report.warning(
              code.word->offset, "unknown-m",
              fmt::format("{} is not known; it is assumed to have no effect on the path", at_.code_text(code)));
        at_.words.use("PQR");
        if (code.tenths == 670 || code.tenths == 680) at_.words.use("E");  // an analog output of LinuxCNC
        break;
      case MGroup::no_effect:
        at_.words.use("PQR");
        break;
      case MGroup::stop:
      case MGroup::end:
        break;
    }
    state_changed_ = true;
  }
}

bool ModalGroups::read_m_codes_after() {
  bool go_on = true;
  for (const Code& code : at_.words.m()) {
    if (acts_at_end(code)) add_m_event(code);
    switch (m_code(code.tenths)) {
      case MGroup::end:
        go_on = false;
        [[fallthrough]];
      case MGroup::stop:
        if (!at_.out.moves.empty()) at_.out.moves.back().exact_stop = true;
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

void ModalGroups::check_unit() {
  if (unit_given_) return;
  unit_given_ = true;
  at_.report.warning(at_.words.offset(), "unit-missing",
                     "the program has moves before G20 or G21 says which unit it is in; millimetres are assumed");
}

std::uint32_t ModalGroups::state_index() {
  if (!state_changed_) return state_index_;
  state_changed_ = false;
  return state_index_ = shared_state(at_.out.states, state_);
}

std::optional<double> ModalGroups::cutting_feed(double length_mm, const char* g) {
  if (state_.feed_mode == FeedMode::inverse_time && !at_.words.has('F')) {
    at_.error(at_.words.offset(), "feed-missing",
              fmt::format("{} in inverse time (G93) without F; every cutting block needs its own F", g), "G93");
    return std::nullopt;
  }
  const std::size_t at = at_.request.motion_given ? at_.request.motion_word->offset : at_.words.offset();
  if (!feed_) {
    if (!at_.words.has('F'))
      at_.error(at, "feed-missing",
                fmt::format("{} without a feed; F greater than zero was expected before or in this block", g), "feed");
    return std::nullopt;
  }
  if (*feed_ == 0) {
    at_.error(at_.words.offset_of('F'), "feed-zero",
              fmt::format("F0 on a cutting move ({}); the feed must be greater than zero", g), "feed");
    return std::nullopt;
  }
  switch (state_.feed_mode) {
    case FeedMode::inverse_time:
      return *feed_ * length_mm;
    case FeedMode::per_revolution:
      return per_revolution_feed();
    case FeedMode::per_minute:
      break;
  }
  return feed_;
}

std::optional<double> ModalGroups::per_revolution_feed() {
  if (state_.spindle_speed_rpm > 0) return *feed_ * state_.spindle_speed_rpm / 60.0;
  at_.error(at_.words.offset(), "feed-per-turn",
            "a feed per revolution (G95) without a spindle speed; S was expected before", "feed-per-turn");
  return std::nullopt;
}

void ModalGroups::set_unit(bool inch) {
  state_.inch = inch;
  unit_given_ = state_changed_ = true;
}

void ModalGroups::set_cutter_radius(int g, bool computed) {
  radius_g_ = g;
  change().cutter_radius = computed;
}

void ModalGroups::give_feed_to(Move& move) {
  move.feed_given = feed_given_;
  move.feed_by_variable = feed_by_variable_;
  feed_given_ = false;
}

void ModalGroups::add_facts(MachineFacts& f) const {
  f.unit_mm = unit_mm();
  f.state = &state_;
  f.motion_g = motion_ == MotionCode::none ? 0 : static_cast<int>(motion_) - 1;
  f.plane_g = plane_ == Plane::xy ? 17 : plane_ == Plane::zx ? 18 : 19;
  f.cycle_g = cycle_g_;
  f.return_to_r = return_to_r_;
  if (feed_)
    f.feed = *feed_ * (state_.feed_mode == FeedMode::per_revolution ? 1 / unit_mm()
                       : state_.feed_mode == FeedMode::inverse_time ? 60
                                                                    : 60 / unit_mm());
  f.selected_tool = next_tool_;
}

void ModalGroups::check_tool_changes() {
  if (next_tool_ >= 0 && !tool_changed_)
    at_.report.warning(
        tool_word_offset_, "tool-not-changed",
        "the program selects tools (T) but never changes one; M6 was expected, all moves count as tool 0");
}

void ModalGroups::set_arc_centre(bool absolute) {
  state_.absolute_arc_centre = absolute;
  centre_mode_given_ = true;
}

}  // namespace camber::nc
