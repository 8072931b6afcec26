#include "nc/siemens/siemens_modes.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/mode_words.h"
#include "nc/shared_states.h"

namespace camber::nc::siemens {
namespace {

constexpr std::uint8_t kCompressorGroup = 4, kRoundingGroup = 8;  // of kModeWords

}  // namespace

void BlockContext::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  request.trouble = true;
  report.error(offset, check, std::move(message), alike);
}

bool BlockContext::refuse_under_radius(std::size_t offset, std::string_view what) {
  if (!radius.moves_path()) return false;
  error(offset, "cutter-radius", fmt::format("{} under G{}; G40 was expected before", what, radius.g));
  return true;
}

void BlockContext::refuse_ellipse() {
  error(words.offset(), "scaling",
        "an arc under a scale that differs along its two axes would be an ellipse; one scale for both was expected");
}

void BlockContext::add_event(EventKind kind, double value) {
  out.events.push_back({value, place.called_from, static_cast<std::uint32_t>(out.moves.size()), kind, false});
}

Modes::Modes(BlockContext& at) : at_(at), unit_given_(at.options.inch.has_value()) {
  state_.inch = at.options.inch.value_or(false);
}

void Modes::set_unit(bool inch) {
  change().inch = inch;
  unit_given_ = true;
}

void Modes::set_plane(Plane plane) {
  at_.plane = plane;
  change().plane_g = static_cast<std::uint8_t>(plane == Plane::xy ? 17 : plane == Plane::zx ? 18 : 19);
}

void Modes::give_feed_to(Move& move) {
  move.feed_given = std::exchange(feed_given_, false);
  move.feed_by_variable = feed_by_variable_;
}

void Modes::stop_spindle(const CodeWord& code) {
  if (code.spindle != main_spindle_) return;
  change().spindle = SpindleDirection::stopped;
  at_.add_event(EventKind::spindle_stop, 0);
}

void Modes::set_coolant(bool on, int code) {
  change().coolant = on;
  at_.add_event(EventKind::m_code, code);
}

void Modes::set_feed_mode(FeedMode mode) {
  if (mode != state_.feed_mode) {
    feed_.reset();
    change().feed_mode = mode;
  }
  feed_given_ = true;
}

void Modes::read_feed() {
  const Slot& f = at_.words.of('F');
  if (!f.given) return;
  if (f.value < 0 || std::isnan(f.value)) {
    at_.error(f.offset, "feed", fmt::format("F {:g} is negative; a feed greater than zero was expected", f.value));
    return;
  }
  feed_ = internal_feed(f.value);
  feed_given_ = true;
  feed_by_variable_ = f.by_expression;
}

double Modes::internal_feed(double value) const {
  return state_.feed_mode == FeedMode::inverse_time     ? value / 60
         : state_.feed_mode == FeedMode::per_revolution ? value * unit_mm()
                                                        : mm_per_s_from_mm_per_min(value * unit_mm());
}

/// G96 (F per revolution), G961, G962: S is a cutting speed until G97.
void Modes::begin_cutting_speed(const CodeWord& code) {
  cutting_speed_ = true;
  if (code.number != 962) set_feed_mode(code.number == 96 ? FeedMode::per_revolution : FeedMode::per_minute);
  at_.report.warning(
      code.offset, "spindle-speed",
      fmt::format("under G{} S is a cutting speed, and the spindle speed follows the diameter turned; S is "
                  "read without effect until G97",
                  code.number),
      "G96");
}

void Modes::read_spindle_speed() {
  if (cutting_speed_) return;
  const Slot& s = at_.words.of('S');
  if (!s.given) return;
  if (s.value < 0) {
    at_.error(s.offset, "spindle-speed", fmt::format("S {:g} is negative; zero or more was expected", s.value));
    return;
  }
  change().programmed_spindle_speed_rpm = s.value;
  state_.spindle_speed_rpm = std::min(s.value, at_.options.max_spindle_speed_rpm);
  if (s.value > at_.options.max_spindle_speed_rpm)
    at_.report.warning(s.offset, "spindle-speed",
                       fmt::format("S{:g} is above the machine's largest spindle speed, {:g} rpm, at which it turns",
                                   s.value, at_.options.max_spindle_speed_rpm),
                       fmt::format("S{:g}", s.value));
  at_.add_event(EventKind::spindle_speed, s.value);
}

/// M3, M4; M13 and M14 with coolant, as most makers of machines have them. The first spindle that turns is the one that
/// cuts, whatever its number, unless SETMS has named another.
void Modes::start_spindle(const CodeWord& code) {
  if (code.spindle != main_spindle_) {
    if (main_spindle_named_ || state_.spindle != SpindleDirection::stopped) return;
    main_spindle_ = code.spindle;
    if (const auto speed = other_speeds_.find(code.spindle); speed != other_speeds_.end()) {
      at_.words.set('S') = speed->second;
      read_spindle_speed();
    }
  }
  const bool clockwise = code.number == 3 || code.number == 13;
  change().spindle = clockwise ? SpindleDirection::clockwise : SpindleDirection::counter_clockwise;
  state_.coolant |= code.number >= 13;
  at_.add_event(clockwise ? EventKind::spindle_clockwise : EventKind::spindle_counter_clockwise,
                state_.spindle_speed_rpm);
}

std::uint32_t Modes::state_index() {
  if (!state_changed_) return state_index_;
  state_changed_ = false;
  return state_index_ = shared_state(at_.out.states, state_);
}

void Modes::check_unit() {
  if (unit_given_) return;
  unit_given_ = true;
  at_.report.warning(
      at_.words.offset(), "unit-missing",
      "the program has moves before G70, G71, G700 or G710 says which unit it is in; millimetres are assumed");
}

/// A coordinate in program millimetres.
double Modes::axis_value(const Slot& slot, double start, double unit) const {
  const double value = slot.value * unit;
  return at_.is_incremental(slot) ? start + value : value;
}

/// State that edits go by: the modal dimension. Words of their own (X=IC(5)) say so in the text.
void Modes::note_dimensions() { change().incremental = !at_.absolute; }

std::optional<double> Modes::cutting_feed(double length_mm, const char* g) {
  const std::size_t at = at_.motion_offset();
  if (state_.feed_mode == FeedMode::inverse_time && !at_.words.has('F')) {
    at_.error(at, "feed-missing",
              fmt::format("{} in inverse time (G93) without F; every cutting block needs its own F", g), "G93");
    return std::nullopt;
  }
  if (!feed_) {
    if (!at_.words.has('F'))
      at_.error(at, "feed-missing",
                fmt::format("{} without a feed; F greater than zero was expected before or in this block", g), "feed");
    return std::nullopt;
  }
  if (*feed_ == 0) {
    at_.error(at_.words.has('F') ? at_.words.of('F').offset : at, "feed-zero",
              fmt::format("F0 on a cutting move ({}); the feed must be greater than zero", g), "feed");
    return std::nullopt;
  }
  switch (state_.feed_mode) {
    case FeedMode::inverse_time:
      return *feed_ * length_mm;
    case FeedMode::per_revolution:
      if (state_.spindle_speed_rpm > 0) return *feed_ * state_.spindle_speed_rpm / 60.0;
      at_.error(at_.words.offset(), "feed-per-turn",
                "a feed per revolution (G95) without a spindle speed; S was expected before", "feed-per-turn");
      return std::nullopt;
    case FeedMode::per_minute:
      break;
  }
  return feed_;
}

void ContourModes::set_mode_word(std::string_view upper_name) {
  std::string name;
  for (const char c : upper_name) name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  modes_.change().mode_words = with_mode_word(modes_.state().mode_words, name);
}

/// COMPON ..., COMPOF.
void ContourModes::set_compressor(const WordRow& row) {
  compressor_ = row.does == Does::contour_mode;
  if (compressor_)
    set_mode_word(row.name);
  else
    modes_.change().mode_words &= ~mode_words_of_group(kCompressorGroup);
  update();
}

/// G60, G64, G641 to G646.
void ContourModes::set_blending(int g) {
  blending_ = g;
  before_cycle832_.reset();
  modes_.change().path_control = g == 60 ? PathControl::exact_stop : PathControl::blend;
  modes_.change().path_g = g == 60 ? 61 : 64;
  modes_.change().mode_words &= ~mode_words_of_group(kRoundingGroup);
  set_mode_word(fmt::format("G{}", g));
  update();
}

/// ADIS.
void ContourModes::set_rounding_distance(double mm) {
  adis_mm_ = mm;
  update();
}

/// CTOL.
void ContourModes::set_tolerance(double tolerance) {
  contour_tolerance_mm_ = tolerance > 0 ? tolerance * modes_.unit_mm() : -1;
  update();
}

void ContourModes::update() {
  const bool on = cycle832_ || compressor_;
  const double tolerance_mm = contour_tolerance_mm_ > 0 ? contour_tolerance_mm_ : cycle832_tolerance_mm_;
  modes_.change().high_speed_contouring = on;
  modes_.change().contouring = on ? Contouring::cycle832 : Contouring::none;
  modes_.change().blend_tolerance_mm = blending_ == 641                              ? adis_mm_
                                       : on && (blending_ != 60 || before_cycle832_) ? tolerance_mm
                                                                                     : -1;
}

/// CYCLE832(tolerance, kind, ...): the ones of the kind are 0 (off), 1 finishing, 2 semi-finishing, 3 roughing, 4
/// precision.
void ContourModes::run_cycle832(const CycleCall& call) {
  const int kind = static_cast<int>(std::abs(call.number(1, call.has(0) && call.number(0) > 0 ? 1 : 0))) % 10;
  cycle832_ = kind != 0;
  cycle832_tolerance_mm_ = cycle832_ && call.number(0) > 0 ? call.number(0) * modes_.unit_mm() : -1;
  contour_tolerance_mm_ = -1;
  ModalState& state = modes_.change();
  if (cycle832_ && !before_cycle832_) before_cycle832_.emplace(state.path_control, state.path_g);
  if (before_cycle832_) std::tie(state.path_control, state.path_g) = *before_cycle832_;
  if (cycle832_)
    state.path_control = PathControl::blend, state.path_g = 64;
  else
    before_cycle832_.reset();
  constexpr std::array<std::string_view, 5> kKinds{"", "CYCLE832_FINISH", "CYCLE832_SEMIFIN", "CYCLE832_ROUGH",
                                                   "CYCLE832_FINISH"};
  state.mode_words &= ~mode_words_of_group(0);
  if (kind > 0 && kind < 5) set_mode_word(kKinds[static_cast<std::size_t>(kind)]);
  update();
}

ToolWords::ToolWords(BlockContext& at, Modes& modes) : at_(at), modes_(modes), offsets_(at.options.tool_offsets) {
  for (const Word& w : at.main.words)
    if (w.letter == 'T' && w.value >= 0 && w.value < 1e6) numbers_.reserve(static_cast<int>(w.value));
}

const ToolOffset* ToolWords::offset(int tool) const {
  const auto found = offsets_.find(tool);
  return found == offsets_.end() ? nullptr : &found->second;
}

/// $TC_DP6, $TC_DP3.
void ToolWords::set_offset(int tool, bool radius, double mm) {
  (radius ? offsets_[tool].radius_mm : offsets_[tool].length_mm) = mm;
  update_length();
}

void ToolWords::set_name(const std::string& name, std::uint32_t offset) {
  next_ = name.empty() ? 0 : numbers_.of(name);
  word_offset_ = offset;
  at_.out.tool_names = numbers_.names();
  at_.add_event(EventKind::tool_select, next_);
}

void ToolWords::read_tool() {
  const Slot& t = at_.words.of('T');
  if (!t.given) return;
  if (t.value < 0 || t.value != std::floor(t.value) || t.value > 1e8) {
    at_.error(t.offset, "tool", fmt::format("T{:g} is no tool; a whole number of zero or more was expected", t.value));
    return;
  }
  next_ = static_cast<int>(t.value);
  word_offset_ = t.offset;
  at_.add_event(EventKind::tool_select, next_);
}

void ToolWords::change_tool(std::uint32_t offset) {
  at_.refuse_under_radius(offset, "a tool change");
  if (next_ < 0) {
    at_.report.warning(offset, "tool", "M6 without a tool; T was expected before", "M6");
    return;
  }
  changed_ = true;
  modes_.change().tool = next_;
  edge_ = next_ == 0 ? 0 : 1;
  update_length();
  at_.add_event(EventKind::tool_change, next_);
}

/// D: the edge of the tool, whose radius and length hold.
void ToolWords::read_edge() {
  const Slot& d = at_.words.of('D');
  if (!d.given) return;
  if (d.value < 0 || d.value != std::floor(d.value) || d.value > 32000) {
    at_.error(d.offset, "tool",
              fmt::format("D{:g} is no cutting edge; a whole number of zero or more was expected", d.value));
    return;
  }
  edge_ = static_cast<int>(d.value);
  update_length();
}

void ToolWords::update_length() {
  if (!at_.has_rotary_axes()) return;
  std::optional<double> length = 0.0;
  if (edge_ != 0 && modes_.state().tool != 0) {
    const ToolOffset* tool = offset(modes_.state().tool);
    length.reset();
    if (tool && tool->length_mm) length = *tool->length_mm + tool->length_wear_mm.value_or(0);
  }
  modes_.change().tool_length_mm = length;
}

void ToolWords::finish() {
  if (next_ >= 0 && !changed_)
    at_.report.warning(
        word_offset_, "tool-not-changed",
        "the program selects tools (T) but never changes one; M6 was expected, all moves count as tool 0");
  at_.out.tool_names = numbers_.names();
}

}  // namespace camber::nc::siemens
