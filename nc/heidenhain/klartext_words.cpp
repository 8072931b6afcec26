// The words of a block: values, feeds, M functions, tools.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/heidenhain/klartext.h"
#include "nc/mode_words.h"

namespace camber::nc::heidenhain {

namespace {

/// Returns the word by which programs say `letter`, such as FMAX for kRapid.
std::string name_of(char letter) {
  struct Name {
    char letter;
    const char* text;
  };
  static constexpr std::array kNames{Name{letter::kCompensation, "R0, RL or RR"},
                                     Name{letter::kSense, "DR"},
                                     Name{letter::kRapid, "FMAX"},
                                     Name{letter::kAutoFeed, "FAUTO"},
                                     Name{letter::kFeedPerTurn, "FU"},
                                     Name{letter::kFeedPerTooth, "FZ"},
                                     Name{letter::kPolarRadius, "PR"},
                                     Name{letter::kPolarAngle, "PA"},
                                     Name{letter::kLength, "LEN"},
                                     Name{letter::kArcAngle, "CCA"}};
  for (const Name& n : kNames)
    if (n.letter == letter) return n.text;
  for (std::size_t i = 0; i < 3; ++i) {
    if (letter == letter::kNormal[i]) return std::string("N") + "XYZ"[i];
    if (letter == letter::kTool[i]) return std::string("T") + "XYZ"[i];
  }
  return {letter};
}

std::string_view keyword_of(Kind kind) {
  constexpr std::array<std::string_view, 11> kNames{"L", "LN", "LP", "C", "CR", "CT", "CP", "CTP", "CC", "RND", "CHF"};
  const auto i = static_cast<std::size_t>(kind) - static_cast<std::size_t>(Kind::line);
  return i < kNames.size() ? kNames[i] : "L";
}

/// Whether blocks of this kind use the word. Others the control does not accept.
bool belongs_to(char letter, Kind kind) {
  const bool polar = kind == Kind::polar_line || kind == Kind::polar_circle || kind == Kind::polar_tangent_arc;
  const bool corner = kind == Kind::rounding || kind == Kind::chamfer;
  const bool contour = kind == Kind::approach || kind == Kind::departure;
  if (contour || kind == Kind::functions) return true;
  if (kind == Kind::centre) return (letter >= 'X' && letter <= 'Z') || letter == 'M';
  switch (letter) {
    case letter::kPolarRadius:
      return polar && kind != Kind::polar_circle;
    case letter::kPolarAngle:
      return polar;
    case letter::kSense:
      return kind == Kind::circle || kind == Kind::radius_arc || kind == Kind::polar_circle;
    case 'R':
      return kind == Kind::radius_arc || corner;
    case letter::kLength:
    case letter::kArcAngle:
      return false;
    default:
      break;
  }
  const bool direction = std::ranges::find(letter::kNormal, letter) != std::end(letter::kNormal) ||
                         std::ranges::find(letter::kTool, letter) != std::end(letter::kTool);
  return !direction || kind == Kind::normal_line;
}

}  // namespace

/// The number of the word, or its parameter's.
double Klartext::value_of(const Word& word) {
  if (!std::isnan(word.value)) return word.value;
  Cursor at(file().source.text(), word.offset + word.value_at, std::size_t{word.offset} + word.length);
  return read_value(at, parameters_);
}

BlockValues Klartext::read_values(const Statement& s) {
  BlockValues b;
  const Program& program = file();
  for (const Word& word : tree().words_of(program, s)) {
    const bool by_parameter = std::isnan(word.value);
    const auto number = [&] { return by_parameter ? known(value_of(word), word.offset) : word.value; };
    const auto once = [&](bool stands_already) {
      if (stands_already)
        error(word.offset, "repeated-word",
              fmt::format("{} stands twice in the block; once was expected", name_of(word.letter)), "repeated");
    };
    const auto place = [&](std::optional<double>& out) {
      once(out.has_value());
      out = number();
      b.by_parameter |= by_parameter;
    };
    if (!belongs_to(word.letter, s.kind)) {
      error(word.offset, "not-a-word",
            fmt::format("{} has no meaning in a block that begins with {}", name_of(word.letter), keyword_of(s.kind)),
            fmt::format("{} {}", word.letter, static_cast<int>(s.kind)));
      continue;
    }
    switch (word.letter) {
      case 'X':
      case 'Y':
      case 'Z': {
        const auto axis = static_cast<std::size_t>(word.letter - 'X');
        place(b.axis[axis]);
        if (is_incremental(program, word)) b.step = static_cast<std::uint8_t>(b.step | 1U << axis);
        break;
      }
      case 'A':
      case 'B':
      case 'C': {
        const auto axis = static_cast<std::size_t>(word.letter - 'A');
        double value = word.value;
        if (by_parameter) {
          const std::size_t at = word.offset + word.value_at;
          Cursor name_at(program.source.text(), at, std::size_t{word.offset} + word.length);
          if (!name_at.accept('+')) name_at.accept('-');
          const auto name = read_parameter(name_at);
          value = value_of(word);
          if (name && name->kind == 'Q' && name->number >= 120 && name->number <= 122 && std::isnan(value)) {
            b.to_plane = static_cast<std::uint8_t>(b.to_plane | 1U << axis);
            value = 0;
          }
          value = known(value, word.offset);
        }
        once(b.rotary[axis].has_value());
        b.rotary[axis] = value;
        b.by_parameter |= by_parameter;
        if (is_incremental(program, word)) b.rotary_step = static_cast<std::uint8_t>(b.rotary_step | 1U << axis);
        break;
      }
      case 'U':
      case 'V':
      case 'W':
        error(word.offset, "not-supported",
              fmt::format("the axis {} is not supported; X, Y, Z, A, B and C were expected", word.letter), "axis");
        break;
      case 'F':
        once(b.feed.has_value());
        b.feed = number();
        b.feed_by_variable = by_parameter;
        break;
      case letter::kRapid:
        b.rapid = true;
        break;
      case letter::kAutoFeed:
        b.auto_feed = true;
        break;
      case letter::kFeedPerTurn:
        once(b.feed_per_turn.has_value());
        b.feed_per_turn = number();
        break;
      case letter::kFeedPerTooth:
        b.feed_per_tooth = number();
        break;
      case 'R':
        place(b.radius);
        break;
      case letter::kCompensation:
        once(b.compensation.has_value());
        b.compensation = static_cast<int>(word.value);
        break;
      case letter::kSense:
        b.sense = static_cast<int>(word.value);
        break;
      case letter::kPolarRadius:
        once(b.polar_radius.has_value());
        b.polar_radius = number();
        b.polar_radius_step = is_incremental(program, word);
        break;
      case letter::kPolarAngle:
        once(b.polar_angle.has_value());
        b.polar_angle = number();
        b.polar_angle_step = is_incremental(program, word);
        break;
      case letter::kLength:
        b.length = number();
        break;
      case letter::kArcAngle:
        b.arc_angle = number();
        break;
      case 'M': {
        const double code = number();
        if (code < 0 || code > 9999 || code != std::floor(code))
          error(word.offset, "unknown-m", fmt::format("M{} is no M function; a whole number was expected", code));
        else
          b.functions.push_back({static_cast<int>(code), std::nullopt, word.offset});
        break;
      }
      case letter::kArgument:
        if (!b.functions.empty()) b.functions.back().argument = std::isinf(word.value) ? word.value : number();
        break;
      case 'S':
        if (s.kind == Kind::functions) {
          set_spindle_speed(number(), word.offset);
        } else {
          warn(word.offset, "no-effect", "S in a path block is read without effect; the speed is set by TOOL CALL",
               "S");
        }
        break;
      default:
        for (std::size_t i = 0; i < 3; ++i) {
          if (word.letter == letter::kNormal[i]) b.normal[i] = number();
          if (word.letter == letter::kTool[i]) b.tool[i] = number();
        }
        break;
    }
  }
  return b;
}

// --- feeds

/// M136, M137: the F of their own block counts in the new unit.
void Klartext::set_feed_mode(const BlockValues& b) {
  for (const auto& f : b.functions) {
    if (f.code != 136 && f.code != 137) continue;
    const FeedMode mode = f.code == 136 ? FeedMode::per_revolution : FeedMode::per_minute;
    if (mode == state_.feed_mode) continue;
    state_.feed_mode = mode;
    state_changed_ = true;
    feed_.reset();
  }
}

void Klartext::set_feed(const BlockValues& b) {
  if (b.feed) {
    if (*b.feed < 0) {
      error(statement_->begin, "feed-negative",
            fmt::format("F{} is negative; a feed greater than zero was expected", *b.feed));
      return;
    }
    feed_ = state_.feed_mode == FeedMode::per_revolution ? *b.feed * unit_mm()
                                                         : mm_per_s_from_mm_per_min(*b.feed * unit_mm());
    feed_given_ = true;
    feed_by_variable_ = b.feed_by_variable;
  } else if (b.auto_feed) {
    if (!tool_feed_)
      error(statement_->begin, "feed-missing", "FAUTO without a feed in TOOL CALL; F was expected there");
    feed_ = tool_feed_;
    feed_given_ = true;
    feed_by_variable_ = true;
  } else if (b.feed_per_turn) {
    feed_ = *b.feed_per_turn * unit_mm() * turns_per_s("FU");
    feed_given_ = feed_by_variable_ = true;
  } else if (b.feed_per_tooth) {
    feed_ = *b.feed_per_tooth * unit_mm() * teeth() * turns_per_s("FZ");
    feed_given_ = feed_by_variable_ = true;
  }
}

double Klartext::turns_per_s(const char* word) {
  if (state_.spindle_speed_rpm <= 0)
    error(statement_->begin, "feed-per-turn", fmt::format("{} without a spindle speed; S was expected before", word),
          word);
  return state_.spindle_speed_rpm / 60;
}

double Klartext::teeth() {
  constexpr int kAssumed = 2;
  warn(statement_->begin, "teeth-unknown",
       fmt::format("FZ needs the number of teeth of tool {}, which stands in the tool table of the control; {} are "
                   "assumed",
                   state_.tool, kAssumed),
       fmt::format("teeth of {}", state_.tool));
  return kAssumed;
}

double Klartext::cutting_feed(const std::string& what) {
  if (!feed_) {
    error(statement_->begin, "feed-missing",
          fmt::format("{} without a feed; F greater than zero was expected before or in this block", what), "feed");
    return 0;
  }
  if (*feed_ == 0) {
    error(statement_->begin, "feed-zero", fmt::format("F0 on {}; the feed must be greater than zero", what), "feed");
    return 0;
  }
  if (state_.feed_mode != FeedMode::per_revolution) return *feed_;
  if (state_.spindle_speed_rpm > 0) return *feed_ * state_.spindle_speed_rpm / 60;
  error(statement_->begin, "feed-per-turn",
        "a feed per revolution (M136) without a spindle speed; S was expected before", "feed-per-turn");
  return 0;
}

/// M103: the part of the feed into the material is at most the factor times the feed.
double Klartext::plunging_feed(double feed, const Vec3& way_mm) const {
  if (!plunge_factor_ || way_mm[tool_axis_] >= 0) return feed;
  const double down = -way_mm[tool_axis_] / way_mm.norm();
  return std::min(feed, feed * *plunge_factor_ / down);
}

// --- M functions

namespace {

constexpr std::array kAtEnd{0, 1, 2, 5, 6, 9, 30};
/// Read, without effect on the moves; M functions of the control itself. Others are the machine maker's own.
constexpr std::array kPassed{10,  11,  90,  93,  94,  96,  97,  98,  101, 102, 104, 107, 108,
                             109, 110, 111, 112, 114, 115, 116, 117, 118, 120, 121, 124, 132,
                             133, 134, 135, 138, 141, 142, 143, 144, 145, 148, 149};

bool acts_at_end(int code) { return std::ranges::find(kAtEnd, code) != kAtEnd.end(); }

}  // namespace

void Klartext::functions_before(const BlockValues& b) {
  for (const auto& f : b.functions)
    if (!acts_at_end(f.code)) run_m(f);
}

void Klartext::functions_after(const BlockValues& b) {
  for (const auto& f : b.functions)
    if (acts_at_end(f.code)) run_m(f);
}

void Klartext::run_m(const BlockValues::Function& f) {
  const auto spindle = [&](SpindleDirection direction, EventKind kind) {
    state_.spindle = direction;
    state_changed_ = true;
    add_event(kind, f.code);
  };
  const auto coolant = [&](bool on) {
    state_.coolant = on;
    state_changed_ = true;
    add_event(EventKind::m_code, f.code);
  };
  switch (f.code) {
    case 3:
    case 4:
    case 13:
    case 14:
      f.code % 10 == 3 ? spindle(SpindleDirection::clockwise, EventKind::spindle_clockwise)
                       : spindle(SpindleDirection::counter_clockwise, EventKind::spindle_counter_clockwise);
      if (f.code > 10) coolant(true);
      break;
    case 5:
      spindle(SpindleDirection::stopped, EventKind::spindle_stop);
      break;
    case 7:
    case 8:
    case 9:
      coolant(f.code != 9);
      break;
    case 19:
      add_event(EventKind::spindle_orient, f.code);
      break;
    case 2:
    case 30:
      add_event(EventKind::m_code, f.code);
      ended_ = levels_.size() <= 1 || level().file == &main_;
      if (!ended_) end_program();
      break;
    case 91:
    case 92:
    case 99:
    case 130:
    case 136:
    case 137:
    case 140:
      break;  // run_path reads them
    case 89:
      cycle_modal_ = true;
      break;
    case 120:
      state_.mode_words = f.argument && *f.argument == 0 ? state_.mode_words & ~mode_word_bit("m120")
                                                         : with_mode_word(state_.mode_words, "m120");
      state_changed_ = true;
      add_event(EventKind::m_code, f.code);
      break;
    case 103:
      plunge_factor_ = f.argument;
      break;
    case 126:
    case 127:
      shortest_way_ = f.code == 126;
      add_event(EventKind::m_code, f.code);
      break;
    case 128:
    case 129:
      set_tip_control(f.code == 128);
      break;
    case 97:
    case 98:
      if (radius_.active && radius_.radius_mm != 0)
        warn(f.offset, "no-effect",
             fmt::format("M{} is read without effect on the path that RL or RR makes here", f.code), "M97");
      add_event(EventKind::m_code, f.code);
      break;
    default:
      add_event(EventKind::m_code, f.code);
      if (f.code <= 1 || f.code == 6 || std::ranges::find(kPassed, f.code) != kPassed.end()) break;
      warn(f.offset, "machine-function",
           fmt::format("M{} is a function of the machine's maker; what it moves is not known, and it is passed over",
                       f.code),
           fmt::format("M{}", f.code));
      break;
  }
}

void Klartext::add_event(EventKind kind, double value) {
  out_.events.push_back({value, block_, static_cast<std::uint32_t>(out_.moves.size()), kind, false});
}

// --- tools

std::optional<double> Klartext::tool_radius_mm() const {
  const auto found = tools_.find(state_.tool);
  if (found == tools_.end() || !found->second.radius_mm) return std::nullopt;
  return *found->second.radius_mm + tool_delta_radius_mm_;
}

std::optional<double> Klartext::cutter_radius_mm() const {
  const auto known = tool_radius_mm();
  return known ? known : nc::cutter_radius_mm(options_.tool_offsets, state_.tool);
}

/// The length of the tool counts from TOOL CALL on.
void Klartext::update_tool_length() {
  if (options_.rotary_axes.empty()) return;
  std::optional<double> length = 0.0;
  if (state_.tool != 0) {
    const auto tool = tools_.find(state_.tool);
    length = tool == tools_.end() ? std::nullopt : tool->second.length_mm;
  }
  if (length == state_.tool_length_mm) return;
  state_.tool_length_mm = length;
  state_changed_ = true;
}

void Klartext::set_spindle_speed(double rpm, std::size_t offset) {
  if (rpm < 0) {
    error(offset, "spindle-speed", fmt::format("S{} is negative; zero or more was expected", rpm));
    return;
  }
  state_.programmed_spindle_speed_rpm = rpm;
  state_.spindle_speed_rpm = std::min(rpm, options_.max_spindle_speed_rpm);
  state_changed_ = true;
  add_event(EventKind::spindle_speed, rpm);
}

/// TOOL CALL 5 Z S1000 F500 DL+0 DR+0: number, name or parameter; the axis or S may stand alone.
void Klartext::call_tool(const Statement& s) {
  Cursor at = cursor(s);
  std::optional<int> number;
  const std::size_t begin = (at.more(), at.offset());
  if (auto name = at.quoted()) {
    number = tool_numbers_.of(*name);
  } else if (at.peek() == 'Q') {
    const auto parameter = read_parameter(at);
    if (parameter && parameter->kind == 'S')
      number = tool_numbers_.of(parameters_.text(parameter->number));
    else if (parameter)
      number = static_cast<int>(std::lround(known(parameters_.value(*parameter, begin), begin)));
  } else if (is_digit(at.peek())) {
    const double value = at.number().value_or(0);
    if (value > 32767)
      throw FormulaError(begin, "tool", fmt::format("TOOL CALL {}; a number up to 32767 was expected", value));
    number = static_cast<int>(value);  // 5.1 is tool 5 with its second length
    tool_numbers_.reserve(*number);
  }
  if (number) {
    end_compensation();
    if (state_.tool != *number || !tool_called_) state_changed_ = true;
    state_.tool = *number;
    tool_called_ = true;
    tool_delta_radius_mm_ = 0;
    update_tool_length();
    add_event(EventKind::tool_change, *number);
  }
  BlockValues b;
  while (at.more()) {
    const std::size_t offset = at.offset();
    const char c = at.peek();
    if (at.accept_prefix("DR2")) {
      read_value(at, parameters_);
    } else if (at.accept_prefix("DR")) {
      tool_delta_radius_mm_ = known(read_value(at, parameters_), offset) * unit_mm();
    } else if (at.accept_prefix("DL")) {
      read_value(at, parameters_);
    } else if (c == 'S') {
      at.advance();
      const bool bracket = at.accept('('), cutting_speed = at.accept("VC");
      if (cutting_speed) at.accept(':') || at.accept('=');
      double speed = known(read_value(at, parameters_), offset);
      if (bracket) at.accept(')');
      const auto radius = cutter_radius_mm();
      if (cutting_speed && (!radius || *radius <= 0)) {
        warn(offset, "no-effect",
             "a cutting speed in TOOL CALL needs the radius of the tool, which nothing gives; S with the speed was "
             "expected");
        continue;
      }
      if (cutting_speed) speed *= (inch_ ? 12 * 25.4 : 1000) / (2 * kPi * *radius);  // m, or feet, a minute
      set_spindle_speed(speed, offset);
    } else if (c == 'F') {
      at.advance();
      if (at.accept("AUTO") || at.accept("MAX")) continue;
      const char per = at.peek();
      if (per == 'Z' || per == 'U') at.advance();
      const double feed = known(read_value(at, parameters_), offset);
      if (per == 'Z')
        b.feed_per_tooth = feed;
      else if (per == 'U')
        b.feed_per_turn = feed;
      else
        b.feed = feed;
    } else if (c >= 'X' && c <= 'Z') {
      at.advance();
      tool_axis_ = c - 'X';
      state_.plane_g = static_cast<std::uint8_t>(c == 'Z' ? 17 : c == 'Y' ? 18 : 19);
      state_changed_ = true;
    } else if (c == 'M') {
      at.advance();
      if (const auto code = at.integer()) run_m({*code, std::nullopt, offset});
    } else {
      throw FormulaError(offset, "not-a-word",
                         fmt::format("{} in TOOL CALL; the axis, S, F, DL, DR or DR2 was expected", at.word()));
    }
  }
  if (!b.feed && !b.feed_per_tooth && !b.feed_per_turn) return;
  set_feed(b);
  tool_feed_ = feed_;
}

/// TOOL DEF 5 L+0 R+3: a tool of the program; without L and R the next one is made ready.
void Klartext::define_tool(const Statement& s) {
  Cursor at = cursor(s);
  const std::size_t begin = (at.more(), at.offset());
  std::optional<int> number;
  if (auto name = at.quoted())
    number = tool_numbers_.of(*name);
  else if (at.peek() == 'Q')
    number = static_cast<int>(std::lround(known(read_value(at, parameters_), begin)));
  else if (is_digit(at.peek()))
    number = static_cast<int>(at.number().value_or(0));
  if (!number) throw FormulaError(begin, "tool", "TOOL DEF without a tool; a number or a name was expected");
  bool defined = false;
  while (at.more()) {
    const std::size_t offset = at.offset();
    // L+0 and R+0 of a post that leaves them to the tool table say nothing.
    if (at.accept('L')) {
      const double length = known(read_value(at, parameters_), offset) * unit_mm();
      if (length != 0 || !tools_[*number].length_mm) tools_[*number].length_mm = length;
    } else if (at.accept('R')) {
      const double radius = known(read_value(at, parameters_), offset) * unit_mm();
      if (radius != 0 || !tools_[*number].radius_mm) tools_[*number].radius_mm = radius;
    } else {
      throw FormulaError(offset, "not-a-word", fmt::format("{} in TOOL DEF; L or R was expected", at.word()));
    }
    defined = true;
  }
  if (!defined && *number != 0) add_event(EventKind::tool_select, *number);
}

}  // namespace camber::nc::heidenhain
