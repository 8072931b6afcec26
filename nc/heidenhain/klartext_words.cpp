#include "nc/heidenhain/klartext_words.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/mode_words.h"
#include "nc/shared_states.h"

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

void StatementContext::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  report.set_source(file().source);
  report.error(offset, check, std::move(message), alike);
}

void StatementContext::warn(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  report.set_source(file().source);
  report.warning(offset, check, std::move(message), alike);
}

double StatementContext::known(double value, std::size_t offset) const {
  if (std::isnan(value))
    throw FormulaError(
        offset, "unknown-parameter",
        fmt::format("this depends on a parameter whose value is not known: {}", parameters.why_unknown()));
  return value;
}

void StatementContext::add_event(EventKind kind, double value) {
  out.events.push_back({value, block, static_cast<std::uint32_t>(out.moves.size()), kind, false});
}

/// The number of the word, or its parameter's.
double Modes::value_of(const Word& word) {
  if (!std::isnan(word.value)) return word.value;
  Cursor at(at_.file().source.text(), word.offset + word.value_at, std::size_t{word.offset} + word.length);
  return read_value(at, at_.parameters);
}

BlockValues Modes::read_values(const Statement& s) {
  BlockValues b;
  const Program& program = at_.file();
  for (const Word& word : at_.tree().words_of(program, s)) {
    const bool by_parameter = std::isnan(word.value);
    const auto number = [&] { return by_parameter ? at_.known(value_of(word), word.offset) : word.value; };
    const auto once = [&](bool stands_already) {
      if (stands_already)
        at_.error(word.offset, "repeated-word",
                  fmt::format("{} stands twice in the block; once was expected", name_of(word.letter)), "repeated");
    };
    const auto place = [&](std::optional<double>& out) {
      once(out.has_value());
      out = number();
      b.by_parameter |= by_parameter;
    };
    if (!belongs_to(word.letter, s.kind)) {
      at_.error(
          word.offset, "not-a-word",
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
          value = at_.known(value, word.offset);
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
        at_.error(word.offset, "not-supported",
                  fmt::format("the axis {} is not supported; X, Y, Z, A, B and C were expected", word.letter), "axis");
        break;
      case 'F':
        once(b.feed.value.has_value());
        b.feed.value = number();
        b.feed.by_variable = by_parameter;
        break;
      case letter::kRapid:
        b.feed.rapid = true;
        break;
      case letter::kAutoFeed:
        b.feed.of_tool = true;
        break;
      case letter::kFeedPerTurn:
        once(b.feed.per_turn.has_value());
        b.feed.per_turn = number();
        break;
      case letter::kFeedPerTooth:
        b.feed.per_tooth = number();
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
        once(b.polar.radius.has_value());
        b.polar.radius = number();
        b.polar.radius_step = is_incremental(program, word);
        break;
      case letter::kPolarAngle:
        once(b.polar.angle.has_value());
        b.polar.angle = number();
        b.polar.angle_step = is_incremental(program, word);
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
          at_.error(word.offset, "unknown-m", fmt::format("M{} is no M function; a whole number was expected", code));
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
          at_.warn(word.offset, "no-effect", "S in a path block is read without effect; the speed is set by TOOL CALL",
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

/// M136, M137: the F of their own block counts in the new unit.
void Modes::set_feed_mode(const BlockValues& b) {
  for (const auto& f : b.functions) {
    if (f.code != 136 && f.code != 137) continue;
    const FeedMode mode = f.code == 136 ? FeedMode::per_revolution : FeedMode::per_minute;
    if (mode == state_.feed_mode) continue;
    change().feed_mode = mode;
    feed_.reset();
  }
}

void Modes::set_feed(const BlockValues& b) {
  if (b.feed.value) {
    if (*b.feed.value < 0) {
      at_.error(at_.statement->begin, "feed-negative",
                fmt::format("F{} is negative; a feed greater than zero was expected", *b.feed.value));
      return;
    }
    feed_ = state_.feed_mode == FeedMode::per_revolution ? *b.feed.value * at_.unit_mm()
                                                         : mm_per_s_from_mm_per_min(*b.feed.value * at_.unit_mm());
    feed_given_ = true;
    feed_by_variable_ = b.feed.by_variable;
  } else if (b.feed.of_tool) {
    if (!tool_feed_)
      at_.error(at_.statement->begin, "feed-missing", "FAUTO without a feed in TOOL CALL; F was expected there");
    feed_ = tool_feed_;
    feed_given_ = true;
    feed_by_variable_ = true;
  } else if (b.feed.per_turn) {
    feed_ = *b.feed.per_turn * at_.unit_mm() * turns_per_s("FU");
    feed_given_ = feed_by_variable_ = true;
  } else if (b.feed.per_tooth) {
    feed_ = *b.feed.per_tooth * at_.unit_mm() * teeth() * turns_per_s("FZ");
    feed_given_ = feed_by_variable_ = true;
  }
}

double Modes::turns_per_s(const char* word) {
  if (state_.spindle_speed_rpm <= 0)
    at_.error(at_.statement->begin, "feed-per-turn",
              fmt::format("{} without a spindle speed; S was expected before", word), word);
  return state_.spindle_speed_rpm / 60;
}

double Modes::teeth() {
  constexpr int kAssumed = 2;
  at_.warn(at_.statement->begin, "teeth-unknown",
           fmt::format("FZ needs the number of teeth of tool {}, which stands in the tool table of the control; {} are "
                       "assumed",
                       state_.tool, kAssumed),
           fmt::format("teeth of {}", state_.tool));
  return kAssumed;
}

double Modes::cutting_feed(const std::string& what) {
  if (!feed_) {
    at_.error(at_.statement->begin, "feed-missing",
              fmt::format("{} without a feed; F greater than zero was expected before or in this block", what), "feed");
    return 0;
  }
  if (*feed_ == 0) {
    at_.error(at_.statement->begin, "feed-zero", fmt::format("F0 on {}; the feed must be greater than zero", what),
              "feed");
    return 0;
  }
  if (state_.feed_mode != FeedMode::per_revolution) return *feed_;
  if (state_.spindle_speed_rpm > 0) return *feed_ * state_.spindle_speed_rpm / 60;
  at_.error(at_.statement->begin, "feed-per-turn",
            "a feed per revolution (M136) without a spindle speed; S was expected before", "feed-per-turn");
  return 0;
}

/// M103: the part of the feed into the material is at most the factor times the feed.
double Modes::plunging_feed(double feed, const Vec3& way_mm, int tool_axis) const {
  if (!plunge_factor_ || way_mm[tool_axis] >= 0) return feed;
  const double down = -way_mm[tool_axis] / way_mm.norm();
  return std::min(feed, feed * *plunge_factor_ / down);
}

void Modes::set_spindle_speed(double rpm, std::size_t offset) {
  if (rpm < 0) {
    at_.error(offset, "spindle-speed", fmt::format("S{} is negative; zero or more was expected", rpm));
    return;
  }
  state_.programmed_spindle_speed_rpm = rpm;
  state_.spindle_speed_rpm = std::min(rpm, at_.options.max_spindle_speed_rpm);
  state_changed_ = true;
  at_.add_event(EventKind::spindle_speed, rpm);
}

void Modes::set_spindle(SpindleDirection direction, EventKind kind, int code) {
  change().spindle = direction;
  at_.add_event(kind, code);
}

void Modes::set_coolant(bool on, int code) {
  change().coolant = on;
  at_.add_event(EventKind::m_code, code);
}

void Modes::give_feed_to(Move& move) {
  move.feed_given = std::exchange(feed_given_, false);
  move.feed_by_variable = feed_by_variable_;
}

std::uint32_t Modes::state_index() {
  if (!state_changed_) return state_index_;
  state_changed_ = false;
  return state_index_ = shared_state(at_.out.states, state_);
}

/// CYCL DEF 32.1 T0.05, 32.2 HSC-MODE:1 TA0.5; 32.1 without a value: off.
void Modes::set_tolerance(int part, Cursor at) {
  if (part == 0) {  // CYCL DEF 32.0 alone resets it; 32.1 sets it
    state_.contouring = Contouring::none;
    state_.mode_words &= ~mode_words_of_group(1);
    state_.blend_tolerance_mm = -1;
    state_changed_ = true;
    return;
  }
  if (part == 1) {
    if (!at.accept_prefix("T") && !begins_number(at)) return;
    const std::size_t begin = at.offset();
    if (!begins_number(at))
      throw FormulaError(begin, "tolerance", "CYCL DEF 32.1 without a number; T0.02 or nothing was expected");
    const double tolerance = at_.known_value(at, begin) * at_.unit_mm();
    if (tolerance < 0)
      throw FormulaError(begin, "tolerance", fmt::format("a tolerance of {}; zero or more was expected", tolerance));
    if (tolerance == 0) return;
    state_.contouring = Contouring::cycle32;
    state_.blend_tolerance_mm = tolerance;
    state_changed_ = true;
  }
  if (part != 2 || !at.more()) return;
  const std::size_t begin = at.offset();
  if (at.accept("HSC") && at.accept('-') && at.accept("MODE") && at.accept(':') && at.more()) {
    state_.mode_words = with_mode_word(state_.mode_words, at.peek() == '0' ? "cycle32_finish" : "cycle32_rough");
    state_changed_ = true;
    return;
  }
  at.go_to(begin);
  if (!at.accept_prefix("TA"))
    throw FormulaError(begin, "tolerance",
                       fmt::format("{} in CYCL DEF 32.2; HSC-MODE:0, HSC-MODE:1 or TA was expected", at.word()));
}

Tools::Tools(StatementContext& at, Modes& modes) : at_(at), modes_(modes) {
  for (const auto& [number, offset] : at.options.tool_offsets)
    if (number >= 0) tools_[number] = {offset.length_mm, offset.effective_radius_mm()};
  at.parameters.system = [this](int number) { return system_value(number); };
}

const Tools::Tool& Tools::tool(int number) const {
  static const Tool kNone;
  const auto found = tools_.find(number);
  return found == tools_.end() ? kNone : found->second;
}

std::optional<int> Tools::read_number(Cursor& at) {
  const std::size_t begin = (at.more(), at.offset());
  if (auto name = at.quoted()) return numbers_.of(*name);
  if (at.peek() == 'Q') {
    const auto parameter = read_parameter(at);
    if (!parameter) return std::nullopt;
    if (parameter->kind == 'S') return numbers_.of(at_.parameters.text(parameter->number));
    return static_cast<int>(std::lround(at_.known(at_.parameters.value(*parameter, begin), begin)));
  }
  if (!is_digit(at.peek())) return std::nullopt;
  const double value = at.number().value_or(0);
  if (value > 32767)
    throw FormulaError(begin, "tool", fmt::format("TOOL CALL {}; a number up to 32767 was expected", value));
  const int number = static_cast<int>(value);  // 5.1 is tool 5 with its second length
  numbers_.reserve(number);
  return number;
}

void Tools::call(int number) {
  modes_.change().tool = number;
  called_ = true;
  delta_radius_mm_ = 0;
  update_length();
  at_.add_event(EventKind::tool_change, number);
}

void Tools::set_axis(int axis) {
  axis_ = axis;
  modes_.change().plane_g = static_cast<std::uint8_t>(19 - axis);
}

std::optional<double> Tools::system_value(int number) const {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const ModalState& state = modes_.state();
  const auto in_units = [&](std::optional<double> mm) { return mm ? *mm / at_.unit_mm() : kUnknown; };
  if (number == 108) return in_units(cutter_radius_mm());
  if (number == 109) return called_ ? axis_ : -1;
  if (number == 110 && state.spindle == SpindleDirection::stopped) return -1;
  if (number == 110) return state.spindle == SpindleDirection::clockwise ? 0 : 1;
  if (number == 111) return state.coolant ? 1 : 0;
  if (number == 113) return at_.inch ? 1 : 0;
  if (number == 114) return in_units(tool(state.tool).length_mm);
  if (number >= 120 && number <= 122) return kUnknown;
  return std::nullopt;
}

/// = ID50 NR2 IDX5: number, length and radius of a tool, where they are given.
std::optional<double> Tools::asked_of_control(Cursor at) const {
  const auto number = [&](std::string_view word) {
    return at.accept_prefix(word) ? read_value(at, at_.parameters) : -1;
  };
  at.accept('=');
  const double group = number("ID"), which = number("NR"), index = number("IDX");
  const int asked = index < 0 ? modes_.state().tool : static_cast<int>(index);
  if (group == 20 && which == 1) return modes_.state().tool;
  if (group != 50 || (which != 1 && which != 2)) return std::nullopt;
  std::optional<double> value = which == 1 ? tool(asked).length_mm : tool(asked).radius_mm;
  if (!value && which == 2) value = nc::cutter_radius_mm(at_.options.tool_offsets, asked);
  return value ? std::optional(*value / at_.unit_mm()) : std::nullopt;
}

std::optional<double> Tools::radius_mm() const {
  const auto& radius = tool(modes_.state().tool).radius_mm;
  return radius ? std::optional(*radius + delta_radius_mm_) : std::nullopt;
}

std::optional<double> Tools::cutter_radius_mm() const {
  const auto known = radius_mm();
  return known ? known : nc::cutter_radius_mm(at_.options.tool_offsets, modes_.state().tool);
}

/// The length of the tool counts from TOOL CALL on.
void Tools::update_length() {
  if (!at_.has_rotary_axes()) return;
  modes_.change().tool_length_mm = modes_.state().tool == 0 ? 0.0 : tool(modes_.state().tool).length_mm;
}

/// TOOL DEF 5 L+0 R+3: a tool of the program; without L and R the next one is made ready.
void Tools::define(const Statement& s) {
  Cursor at = at_.cursor(s);
  const std::size_t begin = (at.more(), at.offset());
  std::optional<int> number;
  if (auto name = at.quoted())
    number = numbers_.of(*name);
  else if (at.peek() == 'Q')
    number = static_cast<int>(std::lround(at_.known_value(at, begin)));
  else if (is_digit(at.peek()))
    number = static_cast<int>(at.number().value_or(0));
  if (!number) throw FormulaError(begin, "tool", "TOOL DEF without a tool; a number or a name was expected");
  bool defined = false;
  while (at.more()) {
    const std::size_t offset = at.offset();
    // L+0 and R+0 of a post that leaves them to the tool table say nothing.
    if (at.accept('L')) {
      const double length = at_.known_value(at, offset) * at_.unit_mm();
      if (length != 0 || !tools_[*number].length_mm) tools_[*number].length_mm = length;
    } else if (at.accept('R')) {
      const double radius = at_.known_value(at, offset) * at_.unit_mm();
      if (radius != 0 || !tools_[*number].radius_mm) tools_[*number].radius_mm = radius;
    } else {
      throw FormulaError(offset, "not-a-word", fmt::format("{} in TOOL DEF; L or R was expected", at.word()));
    }
    defined = true;
  }
  if (!defined && *number != 0) at_.add_event(EventKind::tool_select, *number);
}

Plane plane_of_axis(int axis) { return axis == 2 ? Plane::xy : axis == 1 ? Plane::zx : Plane::yz; }

Vec2 direction_at_deg(double degrees) {
  const double turn = std::fmod(std::fmod(degrees, 360.0) + 360.0, 360.0);
  if (turn == 0) return {1, 0};
  if (turn == 90) return {0, 1};
  if (turn == 180) return {-1, 0};
  if (turn == 270) return {0, -1};
  return {std::cos(rad_from_deg(turn)), std::sin(rad_from_deg(turn))};
}

bool begins_number(Cursor& at) {
  const char c = at.peek();
  return is_digit(c) || c == '+' || c == '-' || c == '.' ||
         (c == 'Q' && (is_digit(at.behind(1)) || at.behind(1) == 'L'));
}

}  // namespace camber::nc::heidenhain
