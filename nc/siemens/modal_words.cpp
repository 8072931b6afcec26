// Words that change the state of the control.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/mode_words.h"
#include "nc/siemens/block_runner.h"

namespace camber::nc::siemens {

constexpr std::uint8_t kCompressorGroup = 4, kRoundingGroup = 8;  // of kModeWords

BlockRunner::BlockRunner(const Program& program, const InterpreterOptions& options, Reporter& report,
                         Interpretation& out)
    : main_(&program),
      program_(&program),
      options_(options),
      report_(report),
      out_(out),
      offsets_(options.work_offsets_mm),
      tool_offsets_(options.tool_offsets) {
  for (const auto& [number, angles] : options.rotary_offsets_rad) offsets_.at(number).rotary_rad = angles;
  start_open_ = !options.rotary_axes.empty();
  state_.inch = options.inch.value_or(false);
  unit_given_ = options.inch.has_value();
  for (const Word& w : program.words)
    if (w.letter == 'T' && w.value >= 0 && w.value < 1e6) tools_.reserve(static_cast<int>(w.value));
  update_frame();
}

void BlockRunner::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  request_.trouble = true;
  report_.error(offset, check, std::move(message), alike);
}

void BlockRunner::begin(const BlockPlace& place) {
  place_of_block_ = place;
  program_ = place.file;
  editable_ = place.editable;
  request_ = {};
  words_.clear(program_->offset_of(place.block));
}

void BlockRunner::add_plain(std::span<const Word> words) {
  for (const Word& w : words) {
    if (w.letter == 'N') continue;
    if (w.letter == 'G' || w.letter == 'M') {
      const int number =
          w.value >= 0 && w.value < 1e6 && w.value == std::floor(w.value) ? static_cast<int>(w.value) : -1;
      (w.letter == 'G' ? words_.g : words_.m).push_back({number, w.offset, main_spindle_, w.value});
      continue;
    }
    Slot& slot = w.letter == 'R' ? words_.set(Extra::cr) : words_.set(w.letter);
    if (slot.given)
      error(w.offset, "word-twice",
            fmt::format("{} twice in one block; once was expected", w.letter == 'R' ? "CR" : std::string(1, w.letter)));
    slot = {true, false, Dimension::as_modal, w.value, w.offset};
  }
}

void BlockRunner::set_command(const WordRow& row, std::uint32_t offset) {
  switch (row.does) {
    case Does::noted:
      report_.warning(offset, "no-effect", fmt::format("{} ({}) is read without effect", row.name, row.what), row.name);
      return;
    case Does::refused:
      error(offset, "not-supported",
            fmt::format("{} ({}) is not supported; what can stand in its place: {}", row.name, row.what, row.instead),
            row.name);
      return;
    case Does::supa:
      request_.machine_frame = true;
      return;
    case Does::cip:
    case Does::ct:
      motion_ = row.does == Does::cip ? Motion::through_point : Motion::tangential;
      request_.motion_given = true;
      request_.motion_offset = offset;
      return;
    case Does::frame:
      if (request_.frame)
        error(offset, "modal-group",
              fmt::format("{} and {} in one block; one of them was expected", request_.frame->name, row.name));
      request_.frame = &row;
      request_.frame_offset = offset;
      return;
    case Does::transform_on:
    case Does::transform_off:
      return row.does == Does::transform_on ? set_tip_control(TipControl::angles, "TRAORI", offset)
                                            : set_tip_control(TipControl::off, "TRAFOOF", offset);
    case Does::mode_word:
      return set_mode_word(row.name);
    case Does::contour_mode:
      compressor_ = true;
      set_mode_word(row.name);
      return set_contouring();
    case Does::contour_mode_off:
      compressor_ = false;
      state_.mode_words &= ~mode_words_of_group(kCompressorGroup);
      return set_contouring();
    case Does::home:
      go_home(row, offset, place_of_block_);
      return;
    default:
      return;
  }
}

void BlockRunner::set_mode_word(std::string_view upper_name) {
  std::string name;
  for (const char c : upper_name) name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::uint32_t words = with_mode_word(state_.mode_words, name);
  if (words == state_.mode_words) return;
  state_.mode_words = words;
  change_state();
}

void BlockRunner::set_contouring() {
  const bool on = cycle832_ || compressor_;
  state_.high_speed_contouring = on;
  state_.contouring = on ? Contouring::cycle832 : Contouring::none;
  const double tolerance_mm = contour_tolerance_mm_ > 0 ? contour_tolerance_mm_ : cycle832_tolerance_mm_;
  state_.blend_tolerance_mm = blending_ == 641                              ? adis_mm_
                              : on && (blending_ != 60 || before_cycle832_) ? tolerance_mm
                                                                            : -1;
  change_state();
}

void BlockRunner::set_contour_tolerance(double tolerance) {
  contour_tolerance_mm_ = tolerance > 0 ? tolerance * unit_mm() : -1;
  set_contouring();
}

bool BlockRunner::execute(bool& ends_subprogram) {
  ends_subprogram = false;
  moved_ = false;
  if (words_.empty() && !request_.frame && !request_.machine_frame && !request_.motion_given) return true;
  const bool changes_tool = std::ranges::find(words_.m, 6, &CodeWord::number) != words_.m.end();
  if (!changes_tool) read_edge();
  read_g_codes();
  if (words_.has(Extra::adis)) {
    adis_mm_ = std::max(0.0, words_.of(Extra::adis).value * unit_mm());
    set_contouring();
  }
  if (!request_.dwell && !request_.limits) {
    read_feed();
    read_spindle_speed();
  }
  read_tool();
  read_m_codes_before();
  if (changes_tool) read_edge();
  check_letters();
  note_dimensions();
  read_rotary_words();
  const std::size_t moves_before = out_.moves.size();
  const std::optional<double> modal_feed = feed_;
  if (request_.block_feed) feed_ = internal_feed(*request_.block_feed);
  if (request_.frame) {
    run_frame_command();
  } else if (request_.shift != 0) {
    set_programmable_shift();
  } else if (request_.limits) {
  } else if (request_.dwell) {
    dwell();
  } else if (request_.pole != 0) {
    set_pole();
  } else if (request_.fixed_point) {
    go_to_fixed_point();
  } else if (request_.machine_frame) {
    go_in_machine_frame();
  } else {
    move();
  }
  if (request_.block_feed) feed_ = modal_feed;
  finish_corner(moves_before);
  read_corner(moves_before);
  for (std::size_t i = moves_before; i < out_.moves.size(); ++i) moved_ |= out_.moves[i].kind != MoveKind::dwell;
  return read_m_codes_after(ends_subprogram);
}

// --- G codes

namespace {

/// Groups of which a block has one function at most; 0: others.
int modal_group(int g) {
  if ((g >= 0 && g <= 3) || g == 331 || g == 332) return 1;
  if (g >= 17 && g <= 19) return 6;
  if (g >= 40 && g <= 42) return 7;
  if ((g >= 54 && g <= 59) || g == 500 || (g >= 505 && g <= 599)) return 8;
  if (g == 70 || g == 71 || g == 700 || g == 710) return 13;
  return g == 90 || g == 91 ? 14 : 0;
}

}  // namespace

void BlockRunner::read_g_codes() {
  for (std::size_t i = 1; i < words_.g.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const int g = words_.g[i].number, other = words_.g[k].number;
      if (g != other && modal_group(g) != 0 && modal_group(g) == modal_group(other))
        error(words_.g[i].offset, "modal-group",
              fmt::format("G{} and G{} in one block; one of them was expected", other, g));
    }
  // Those that others depend on first: units and dimensions.
  for (const CodeWord& code : words_.g) {
    const int g = code.number;
    if (g == 70 || g == 71 || g == 700 || g == 710 || g == 20 || g == 21) {
      state_.inch = g == 70 || g == 700 || g == 20;
      unit_given_ = true;
      change_state();
      if (g == 20 || g == 21)
        report_.warning(code.offset, "iso-word",
                        fmt::format("G{} is no word of a Sinumerik program outside ISO mode; it is read as G{}", g,
                                    g == 20 ? 700 : 710),
                        "G20");
      if (g == 70 && !options_.inch)
        report_.warning(code.offset, "feed-unit",
                        "F under G70 counts in the basic unit of the control, which is not known; inch per minute is "
                        "assumed (G700 says it)",
                        "G70");
    } else if (g == 90 || g == 91) {
      absolute_ = g == 90;
    } else if (g >= 17 && g <= 19) {
      const Plane wanted = g == 17 ? Plane::xy : g == 18 ? Plane::zx : Plane::yz;
      if (radius_.active && radius_.radius_mm != 0 && wanted != plane_)
        error(code.offset, "cutter-radius", fmt::format("G{} under G{}; G40 was expected before", g, radius_.g));
      plane_ = wanted;
      state_.plane_g = static_cast<std::uint8_t>(g);
      change_state();
    }
  }
  for (const CodeWord& code : words_.g) read_g_code(code);
}

void BlockRunner::read_g_code(const CodeWord& code) {
  const int g = code.number;
  const auto set_motion = [&](Motion motion) {
    motion_ = motion;
    request_.motion_given = true;
    request_.motion_offset = code.offset;
  };
  const auto set_blending = [&](int number) {
    blending_ = number;
    before_cycle832_.reset();
    const bool stops = number == 60;
    state_.path_control = stops ? PathControl::exact_stop : PathControl::blend;
    state_.path_g = stops ? 61 : 64;
    state_.mode_words &= ~mode_words_of_group(kRoundingGroup);
    set_mode_word(fmt::format("G{}", number));
    set_contouring();
  };
  // Units, planes and dimensions were read before; the others change no move. DISC: corners are arcs.
  constexpr std::array kPassed{17,  18,  19,  20,  21,  62,  70,  71,  90,  91,  97,  140, 141, 142, 143,
                               290, 340, 341, 450, 451, 460, 461, 462, 621, 700, 710, 971, 972, 973};
  const auto is = [g](std::initializer_list<int> codes) { return std::ranges::find(codes, g) != codes.end(); };
  if (is({96, 961, 962})) return begin_cutting_speed(code);
  if (is({97, 971, 972, 973})) cutting_speed_ = false;
  if (std::ranges::find(kPassed, g) != kPassed.end()) return;
  struct Refused {
    int first, last;
    std::string_view what, instead;
  };
  constexpr std::array kRefused{Refused{33, 35, "thread cutting", "a tapping cycle"},
                                Refused{147, 148, "smooth approach and retraction", "G1 to G3"},
                                Refused{247, 248, "smooth approach and retraction", "G1 to G3"},
                                Refused{291, 291, "ISO mode", "a program in ISO G code"},
                                Refused{347, 348, "smooth approach and retraction", "G1 to G3"},
                                Refused{931, 931, "feed by duration", "G94"}};
  for (const Refused& r : kRefused)
    if (g >= r.first && g <= r.last)
      return error(code.offset, "not-supported",
                   fmt::format("G{} ({}) is not supported; {} was expected", g, r.what, r.instead),
                   fmt::format("G{}", g));
  if (g >= 810 && g <= 829)
    return report_.warning(code.offset, "no-effect",
                           fmt::format("G{} of the machine's maker is read without effect", g), fmt::format("G{}", g));
  if (g >= 0 && g <= 3) return set_motion(static_cast<Motion>(g));
  if (is({60, 64, 641, 642, 643, 644, 645, 646})) return set_blending(g);
  if (is({601, 602, 603})) return set_mode_word(fmt::format("G{}", g));
  if (is({94, 942})) return set_feed_mode(FeedMode::per_minute);
  if (is({95, 952})) return set_feed_mode(FeedMode::per_revolution);
  if (g == 93) return set_feed_mode(FeedMode::inverse_time);
  if (is({41, 42})) return read_radius_code(code);
  if (g == 40) return end_radius();
  if (is({63, 331, 332}))
    return set_motion(g == 63 ? Motion::linear : g == 331 ? Motion::tapping_in : Motion::tapping_out);
  request_.dwell |= g == 4;
  request_.exact_stop |= g == 9;
  request_.limits |= is({25, 26});
  request_.machine_frame |= is({53, 153});
  request_.fixed_point |= is({74, 75});
  if (is({110, 111, 112})) request_.pole = g;
  if (is({4, 9, 25, 26, 53, 153, 74, 75, 110, 111, 112})) return;
  if (is({43, 44, 49, 80})) {
    words_.set('H').given = false;
    return report_.warning(code.offset, "iso-word",
                           fmt::format("G{} is no word of a Sinumerik program outside ISO mode; it is read without "
                                       "effect (tool lengths come with D)",
                                       g),
                           fmt::format("G{}", g));
  }
  if (is({58, 59})) {
    // With coordinates a programmable shift, else the work offset that an 828D has under this number.
    const bool moves = std::ranges::any_of(words_.g, [](const CodeWord& c) { return c.number >= 0 && c.number <= 3; });
    if (moves || !words_.has_any("XYZ")) return set_work_offset(g);
    request_.shift = g;
    return;
  }
  if ((g >= 54 && g <= 57) || g == 500 || (g >= 505 && g <= 599)) return set_work_offset(g);
  error(code.offset, "unknown-g",
        g < 0 ? fmt::format("G{:g} is no G function; a whole number was expected", code.value)
              : fmt::format("G{} is not a G function of a Sinumerik program that Camber knows", g),
        fmt::format("G{}", g));
}

/// Sets ModalState::work_offset: G54 to G57 by their number, G505 to G599 as G54.1 P5 to P99, G500 as 500.
void BlockRunner::set_work_offset(int g) {
  const int number = g > 500 ? 540000 + g - 500 : g;
  if (radius_.active && radius_.radius_mm != 0 && number != state_.work_offset)
    error(words_.offset(), "cutter-radius", fmt::format("G{} under G{}; G40 was expected before", g, radius_.g));
  if (g == 500 && !options_.work_offsets_mm.empty()) offsets_.at(500).known = true;
  state_.work_offset = number;
  change_state();
  update_frame();
}

void BlockRunner::set_feed_mode(FeedMode mode) {
  if (mode != state_.feed_mode) {
    feed_.reset();
    state_.feed_mode = mode;
    change_state();
  }
  feed_given_ = true;
}

// --- F, S, T, D

void BlockRunner::read_feed() {
  const Slot& f = words_.of('F');
  if (!f.given) return;
  if (f.value < 0 || std::isnan(f.value)) {
    error(f.offset, "feed", fmt::format("F {:g} is negative; a feed greater than zero was expected", f.value));
    return;
  }
  feed_ = internal_feed(f.value);
  feed_given_ = true;
  feed_by_variable_ = f.by_expression;
}

double BlockRunner::internal_feed(double value) const {
  return state_.feed_mode == FeedMode::inverse_time     ? value / 60
         : state_.feed_mode == FeedMode::per_revolution ? value * unit_mm()
                                                        : mm_per_s_from_mm_per_min(value * unit_mm());
}

/// G96 (F per revolution), G961, G962: S is a cutting speed until G97.
void BlockRunner::begin_cutting_speed(const CodeWord& code) {
  cutting_speed_ = true;
  if (code.number != 962) set_feed_mode(code.number == 96 ? FeedMode::per_revolution : FeedMode::per_minute);
  report_.warning(code.offset, "spindle-speed",
                  fmt::format("under G{} S is a cutting speed, and the spindle speed follows the diameter turned; S is "
                              "read without effect until G97",
                              code.number),
                  "G96");
}

void BlockRunner::read_spindle_speed() {
  if (cutting_speed_) return;
  const Slot& s = words_.of('S');
  if (!s.given) return;
  if (s.value < 0) {
    error(s.offset, "spindle-speed", fmt::format("S {:g} is negative; zero or more was expected", s.value));
    return;
  }
  state_.programmed_spindle_speed_rpm = s.value;
  state_.spindle_speed_rpm = std::min(s.value, options_.max_spindle_speed_rpm);
  if (s.value > options_.max_spindle_speed_rpm)
    report_.warning(s.offset, "spindle-speed",
                    fmt::format("S{:g} is above the machine's largest spindle speed, {:g} rpm, at which it turns",
                                s.value, options_.max_spindle_speed_rpm),
                    fmt::format("S{:g}", s.value));
  change_state();
  add_event(EventKind::spindle_speed, s.value);
}

void BlockRunner::set_tool_name(const std::string& name, std::uint32_t offset) {
  next_tool_ = name.empty() ? 0 : tools_.of(name);
  tool_word_offset_ = offset;
  out_.tool_names = tools_.names();
  add_event(EventKind::tool_select, next_tool_);
}

void BlockRunner::read_tool() {
  const Slot& t = words_.of('T');
  if (!t.given) return;
  if (t.value < 0 || t.value != std::floor(t.value) || t.value > 1e8) {
    error(t.offset, "tool", fmt::format("T{:g} is no tool; a whole number of zero or more was expected", t.value));
    return;
  }
  next_tool_ = static_cast<int>(t.value);
  tool_word_offset_ = t.offset;
  add_event(EventKind::tool_select, next_tool_);
}

void BlockRunner::change_tool(std::uint32_t offset) {
  if (radius_.active && radius_.radius_mm != 0)
    error(offset, "cutter-radius", fmt::format("a tool change under G{}; G40 was expected before", radius_.g));
  if (next_tool_ < 0) {
    report_.warning(offset, "tool", "M6 without a tool; T was expected before", "M6");
    return;
  }
  tool_changed_ = true;
  state_.tool = next_tool_;
  edge_ = next_tool_ == 0 ? 0 : 1;
  change_state();
  update_tool_length();
  add_event(EventKind::tool_change, next_tool_);
}

/// D: the edge of the tool, whose radius and length hold.
void BlockRunner::read_edge() {
  const Slot& d = words_.of('D');
  if (!d.given) return;
  if (d.value < 0 || d.value != std::floor(d.value) || d.value > 32000) {
    error(d.offset, "tool",
          fmt::format("D{:g} is no cutting edge; a whole number of zero or more was expected", d.value));
    return;
  }
  edge_ = static_cast<int>(d.value);
  update_tool_length();
}

void BlockRunner::update_tool_length() {
  if (options_.rotary_axes.empty()) return;
  std::optional<double> length = 0.0;
  if (edge_ != 0 && state_.tool != 0) {
    length.reset();
    const auto found = tool_offsets_.find(state_.tool);
    if (found != tool_offsets_.end() && found->second.length_mm)
      length = *found->second.length_mm + found->second.length_wear_mm.value_or(0);
  }
  if (length == state_.tool_length_mm) return;
  state_.tool_length_mm = length;
  change_state();
}

// --- M codes

/// M3, M4; M13 and M14 with coolant, as most makers of machines have them. The first spindle that turns is the one that
/// cuts, whatever its number, unless SETMS has named another.
void BlockRunner::start_spindle(const CodeWord& code) {
  if (code.spindle != main_spindle_) {
    if (main_spindle_named_ || state_.spindle != SpindleDirection::stopped) return;
    main_spindle_ = code.spindle;
    if (const auto speed = other_speeds_.find(code.spindle); speed != other_speeds_.end()) {
      words_.set('S') = speed->second;
      read_spindle_speed();
    }
  }
  const bool clockwise = code.number == 3 || code.number == 13;
  state_.spindle = clockwise ? SpindleDirection::clockwise : SpindleDirection::counter_clockwise;
  state_.coolant |= code.number >= 13;
  change_state();
  add_event(clockwise ? EventKind::spindle_clockwise : EventKind::spindle_counter_clockwise, state_.spindle_speed_rpm);
}

void BlockRunner::read_m_codes_before() {
  const auto add_coolant = [this](int m) {
    state_.coolant = true;
    change_state();
    add_event(EventKind::m_code, m);
  };
  for (const CodeWord& code : words_.m) {
    const int m = code.number;
    const auto is = [m](std::initializer_list<int> codes) { return std::ranges::find(codes, m) != codes.end(); };
    if (is({0, 1, 2, 5, 9, 17, 30})) continue;  // at the end of the block
    if (is({3, 4, 13, 14})) {
      start_spindle(code);
    } else if (m == 6) {
      change_tool(code.offset);
    } else if (is({7, 8})) {
      add_coolant(m);
    } else if (m == 19) {
      add_event(EventKind::spindle_orient, 0);
    } else if (m == 60) {
      add_event(EventKind::pallet, 60);
    } else if (m < 0) {
      error(code.offset, "unknown-m", fmt::format("M{:g} is no M function; a whole number was expected", code.value));
    } else {
      add_event(EventKind::m_code, m);
      if (!is({10, 11, 40, 41, 42, 43, 44, 45, 48, 49, 70}))
        report_.warning(code.offset, "machine-function",
                        fmt::format("M{} is a function of the machine's maker; what it moves is not known, and it is "
                                    "passed over",
                                    m),
                        "machine-function");
    }
  }
}

bool BlockRunner::read_m_codes_after(bool& ends_subprogram) {
  bool go_on = true;
  for (const CodeWord& code : words_.m) {
    const int m = code.number;
    if ((m == 5 && code.spindle == main_spindle_) || m == 9) {
      if (m == 5) state_.spindle = SpindleDirection::stopped;
      if (m == 9) state_.coolant = false;
      change_state();
      add_event(m == 5 ? EventKind::spindle_stop : EventKind::m_code, m == 5 ? 0 : 9);
    }
    if (m == 0 || m == 1 || m == 2 || m == 30) add_event(EventKind::m_code, m);
    if (m == 2 || m == 30) go_on = false;
    if (m == 17) ends_subprogram = true;
  }
  return go_on;
}

void BlockRunner::add_event(EventKind kind, double value) {
  out_.events.push_back(
      {value, place_of_block_.called_from, static_cast<std::uint32_t>(out_.moves.size()), kind, false});
}

/// Letters that belong to no axis or function of a milling machine.
void BlockRunner::check_letters() {
  for (const char letter : std::string_view("ABC")) {
    if (!words_.has(letter) || rotary_axis(letter)) continue;
    check_rotary_letter(letter);
  }
  for (const char letter : std::string_view("UVWQE")) {
    if (!words_.has(letter)) continue;
    error(words_.of(letter).offset, "axis",
          fmt::format("{} is not an axis that Camber knows; X, Y, Z, A, B or C was expected", letter),
          std::string(1, letter));
  }
}

void BlockRunner::finish() {
  if (corner_.waits && !corner_.modal && !report_.has_errors())
    report_.error(corner_.offset, "corner-word",
                  fmt::format("{} is not followed by a further move; G1, G2 or G3 was expected", corner_.text));
  if (radius_.active) {
    const Radius radius = radius_;
    end_radius();
    const std::string message = fmt::format(
        "G{} is never cancelled; G40 with a straight move off the contour was expected before the end", radius.g);
    if (radius.radius_mm != 0 && !report_.has_errors())
      report_.error(radius.offset, "cutter-radius", message);
    else if (radius.radius_mm == 0)
      report_.warning(radius.offset, "cutter-radius", message);
  }
  if (next_tool_ >= 0 && !tool_changed_)
    report_.warning(tool_word_offset_, "tool-not-changed",
                    "the program selects tools (T) but never changes one; M6 was expected, all moves count as tool 0");
  relied_ends_.fix(out_);
  out_.tool_names = tools_.names();
}

// --- SAVE, system variables

std::shared_ptr<const BlockRunner::Saved> BlockRunner::saved_modes() const {
  return std::make_shared<const Saved>(
      Saved{motion_, plane_, absolute_, state_.inch, state_.feed_mode, programmable_, state_.work_offset});
}

void BlockRunner::restore(const Saved& saved) {
  motion_ = saved.motion;
  plane_ = saved.plane;
  state_.plane_g = static_cast<std::uint8_t>(plane_ == Plane::xy ? 17 : plane_ == Plane::zx ? 18 : 19);
  absolute_ = saved.absolute;
  state_.inch = saved.inch;
  if (state_.feed_mode != saved.feed_mode) feed_.reset();
  state_.feed_mode = saved.feed_mode;
  programmable_ = saved.programmable;
  state_.work_offset = saved.work_offset;
  change_state();
  update_frame();
}

std::optional<Value> BlockRunner::system_value(const std::string& name, const std::vector<Value>& indexes,
                                               const std::vector<std::string>& index_names) {
  const auto number = [](double value) { return Value{value, {}, {}}; };
  const std::string axis = index_names.empty() ? std::string() : index_names[0];
  const int which = axis == "X" ? 0 : axis == "Y" ? 1 : axis == "Z" ? 2 : -1;
  if (name == "$P_EP" || name == "$AA_IW") {
    if (which >= 0) {
      if (place_[static_cast<std::size_t>(which)] != AxisPlace::known) return std::nullopt;
      return number(programmed()[which] / unit_mm());
    }
    if (axis.size() == 1 && rotary_axis(axis[0]) && angles_unknown_ == 0)
      return number(deg_from_rad(rotary_rad_[axis[0] - 'A']));
    return std::nullopt;
  }
  if (name == "$P_F") {
    if (!feed_) return std::nullopt;
    return number(state_.feed_mode == FeedMode::per_minute       ? *feed_ * 60 / unit_mm()
                  : state_.feed_mode == FeedMode::per_revolution ? *feed_ / unit_mm()
                                                                 : *feed_ * 60);
  }
  if (name == "$P_S") return number(state_.programmed_spindle_speed_rpm);
  if (name == "$P_SDIR")
    return number(state_.spindle == SpindleDirection::clockwise ? 3
                  : state_.spindle == SpindleDirection::stopped ? 5
                                                                : 4);
  if (name == "$P_MSNUM") return number(main_spindle_);
  if (name == "$P_TOOLNO") return number(state_.tool);
  if (name == "$P_TOOLP") return number(std::max(next_tool_, 0));
  if (name == "$P_TOOL") return number(edge_);
  if (name == "$P_ISTEST" || name == "$P_SEARCH" || name == "$P_SIM" || name == "$P_DRYRUN" || name == "$P_SEARCHL" ||
      name == "$AC_PROG" || name == "$P_SIMU" || name == "$P_SEARCH1" || name == "$P_SEARCH_S" ||
      name == "$P_TRAFO_ACTIVE")
    return number(0);
  const auto tool_value = [&](int tool, bool radius) -> std::optional<Value> {
    const auto found = tool_offsets_.find(tool);
    if (found == tool_offsets_.end()) return std::nullopt;
    const auto value = radius ? found->second.effective_radius_mm() : found->second.length_mm;
    if (!value) return std::nullopt;
    return number(*value / unit_mm());
  };
  if (name == "$P_TOOLR") return edge_ == 0 ? number(0) : tool_value(state_.tool, true);
  if (name == "$P_TOOLL") return edge_ == 0 ? number(0) : tool_value(state_.tool, false);
  if ((name == "$TC_DP6" || name == "$TC_DP3") && !indexes.empty() && !indexes[0].text)
    return tool_value(static_cast<int>(std::clamp(indexes[0].number, 0.0, 1e8)), name == "$TC_DP6");
  if (name == "$P_GG" && !indexes.empty()) {
    const double group = indexes[0].number;
    if (group == 1 && motion_ <= Motion::counter_clockwise) return number(static_cast<int>(motion_) + 1);
    if (group == 6) return number(plane_ == Plane::xy ? 1 : plane_ == Plane::zx ? 2 : 3);
    if (group == 7) return number(!radius_.active ? 1 : radius_.g == 41 ? 2 : 3);
    if (group == 13) return number(state_.inch ? 1 : 2);
    if (group == 14) return number(absolute_ ? 1 : 2);
    if (group == 15 && state_.feed_mode != FeedMode::inverse_time)
      return number(state_.feed_mode == FeedMode::per_minute ? 2 : 3);
    return std::nullopt;
  }
  if (name == "$P_PFRAME") {
    Value out;
    out.frame = std::make_shared<const Affine>(programmable_);
    return out;
  }
  if (name == "$P_UIFR" && indexes.size() == 3 && !indexes[0].text) {
    const int n = static_cast<int>(std::clamp(indexes[0].number, 0.0, 99.0));
    const int axis3 = index_names[1] == "X" ? 0 : index_names[1] == "Y" ? 1 : index_names[1] == "Z" ? 2 : -1;
    const int offset = n == 0 ? 500 : n <= 4 ? 53 + n : 540000 + n;
    if (axis3 < 0 || index_names[2] != "TR" || !offsets_.known(offset)) return std::nullopt;
    return number(offsets_.at(offset).value_mm[axis3] / unit_mm());
  }
  return std::nullopt;
}

}  // namespace camber::nc::siemens
