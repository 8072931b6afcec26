#include "nc/heidenhain/klartext_flow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/mode_words.h"

namespace camber::nc::heidenhain {

Flow::Flow(StatementContext& at, Modes& modes, Tools& tools, Diagnostics& diagnostics)
    : at_(at), modes_(modes), tools_(tools), diagnostics_(diagnostics), runs_(at.main.blocks.size(), 0) {
  enter({&at.main, tree_of(at.main).begin_statement, true, 0});
}

void Flow::enter(const Level& level) {
  levels_.push_back(level);
  at_.running = level.file;
}

void Flow::leave() {
  levels_.pop_back();
  at_.running = levels_.empty() ? &at_.main : levels_.back().file;
}

const Statement* Flow::next() {
  while (!ended_ && !levels_.empty() && !at_.report.full()) {
    Level& here = level();
    const auto& statements = tree_of(*here.file).statements;
    if (here.next >= statements.size()) {
      end_program();
      continue;
    }
    const Statement& s = statements[here.next++];
    if (s.kind == Kind::nothing || (s.skip != 0 && at_.options.skip_slash_blocks)) continue;
    const bool is_main = here.file == &at_.main;
    if (!is_main || runs_[s.block] > 0) ++repeated_;
    if (is_main && runs_[s.block] < 255) ++runs_[s.block];
    if (repeated_ > at_.options.max_repeated_blocks) {
      at_.error(s.begin, "endless",
                fmt::format("loops and subprograms have run {} blocks again; the program seems to have no end",
                            at_.options.max_repeated_blocks));
      return nullptr;
    }
    at_.statement = &s;
    at_.block = is_main ? s.block : here.called_from;
    at_.editable = is_main && s.lines == 1;
    return &s;
  }
  return nullptr;
}

void Flow::run(const Statement& s) {
  switch (s.kind) {
    case Kind::end_program:
      note_rest(s);
      return end_program();
    case Kind::label: {
      const auto number = at_.cursor(s).integer();
      if (number && *number == 0 && !level().is_program) leave();
      return;
    }
    case Kind::call_label:
      return call_label(s);
    case Kind::assignment:
      return assign(s);
    case Kind::function:
      return run_function(s);
    default:
      return call_program(s, s.kind == Kind::select_program);
  }
}

void Flow::end_by_function() {
  ended_ = levels_.size() <= 1 || level().file == &at_.main;
  if (!ended_) end_program();
}

void Flow::mark_repeated_moves() {
  for (Move& move : at_.out.moves)
    if (runs_[move.block] > 1) move.editable = false;
}

/// Blocks behind END PGM are never read.
void Flow::note_rest(const Statement& s) {
  const auto& all = at_.tree().statements;
  for (std::size_t i = static_cast<std::size_t>(&s - all.data()) + 1; i < all.size(); ++i)
    if (all[i].kind != Kind::nothing)
      return at_.warn(all[i].begin, "after-end", "text behind END PGM is no part of the program and is not read",
                      "after-end");
}

std::string Flow::label_name(Cursor& at) {
  if (auto text = at.quoted()) return *text;
  const std::size_t offset = at.offset();
  if (at.peek() == 'Q') {
    if (const auto name = read_parameter(at)) {
      if (name->kind == 'S' && !at_.parameters.is_defined(*name))
        throw FormulaError(offset, "undefined-parameter",
                           name->text() + " has no text here; a name was expected before");
      if (name->kind == 'S') return at_.parameters.text(name->number);
      return fmt::format("{}", std::lround(at_.known(at_.parameters.value(*name, offset), offset)));
    }
  }
  if (const auto number = at.integer()) return fmt::format("{}", *number);
  throw FormulaError(offset, "label",
                     "a label without a number or a name in quotes; LBL 1 or LBL \"NAME\" was expected");
}

void Flow::jump(const std::string& label, std::size_t offset) {
  const auto found = at_.tree().labels.find(label);
  if (found == at_.tree().labels.end())
    throw FormulaError(offset, "label", fmt::format("LBL {} is not in the program", label));
  level().next = found->second;
}

/// CALL LBL 1: a subprogram, up to LBL 0; CALL LBL 1 REP 3: three times more from there up to here.
void Flow::call_label(const Statement& s) {
  Cursor at = at_.cursor(s);
  const std::string label = label_name(at);
  const std::size_t index = static_cast<std::size_t>(&s - at_.tree().statements.data());
  if (at.accept_prefix("REP") && at.more()) {  // REP without a number: a subprogram, as older controls write it
    const std::size_t offset = at.offset();
    const double count = at_.known_value(at, offset);
    if (count < 0 || count > 65534)
      throw FormulaError(offset, "label", fmt::format("REP {}; a number from 0 to 65534 was expected", count));
    const auto [left, is_new] =
        repeats_left_.emplace(std::pair(&at_.tree(), index), static_cast<int>(std::lround(count)));
    if (left->second > 0) {
      --left->second;
      if (const auto found = at_.tree().labels.find(label); found != at_.tree().labels.end() && found->second > index)
        at_.warn(
            s.begin, "label",
            fmt::format("LBL {} stands behind its CALL LBL REP: the program goes on there, and the blocks between are "
                        "left out; a label before it, or CALL LBL without REP, was expected",
                        label),
            label);
      jump(label, s.begin);
    } else {
      repeats_left_.erase(left);
    }
    return;
  }
  constexpr std::size_t kLevels = 20;  // of TNCs: 19 of labels
  if (levels_.size() > kLevels)
    throw FormulaError(s.begin, "call-depth", fmt::format("more than {} calls inside calls", kLevels));
  const Level here = level();
  if (!at_.tree().labels.contains(label))
    throw FormulaError(s.begin, "label", fmt::format("LBL {} is not in the program", label));
  enter({here.file, 0, false, here.called_from});
  jump(label, s.begin);
  ++level().next;
}

void Flow::call_program(const Statement& s, bool selected) {
  std::string_view text = at_.file().source.text();
  if (selected) {
    Cursor keyword(text, s.begin, s.end);
    if (keyword.accept("CALL")) {
      if (selected_program_.empty())
        return at_.error(s.begin, "program-missing", "CALL SELECTED PGM without SEL PGM before");
      return open_program(selected_program_, s.begin);
    }
  }
  Cursor at = at_.cursor(s);
  std::string path;
  if (auto quoted = at.quoted()) {
    path = *quoted;
  } else if (at.peek() == 'Q' && at.behind(1) == 'S') {
    const auto name = read_parameter(at);
    path = name ? at_.parameters.text(name->number) : std::string();
  } else {
    at.more();
    text = text.substr(at.offset(), s.end - at.offset());
    text = text.substr(0, text.find_first_of(";\r\n"));
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    path = std::string(text);
  }
  if (selected)
    selected_program_ = path;
  else
    open_program(path, s.begin);
}

/// A program of that name beside the main one.
void Flow::open_program(const std::string& path, std::size_t offset) {
  constexpr std::size_t kLevels = 30;
  if (levels_.size() > kLevels)
    throw FormulaError(offset, "call-depth", fmt::format("more than {} calls inside calls", kLevels));
  std::string name = path.substr(path.find_last_of("\\/:") == std::string::npos ? 0 : path.find_last_of("\\/:") + 1);
  const auto lower = [](std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  };
  name = lower(name);
  auto [found, is_new] = files_.try_emplace(name);
  if (is_new) {
    namespace fs = std::filesystem;
    std::error_code ec;
    fs::path folder = fs::path(at_.main.source.name()).parent_path();
    if (folder.empty()) folder = ".";
    std::vector<std::string> candidates;
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
      const std::string there = lower(it->path().filename().string());
      if (it->is_regular_file(ec) && (there == name || there == name + ".h")) candidates.push_back(it->path().string());
    }
    std::ranges::sort(candidates);
    if (!candidates.empty())
      found->second = std::make_unique<Program>(read_text(SourceText::read(candidates.front()), diagnostics_));
  }
  if (!found->second) {
    at_.warn(
        offset, "program-missing",
        fmt::format("CALL PGM {}: there is no {} beside the program; what it does is not known, and it is passed over",
                    path, name.find('.') == std::string::npos ? name + ".h" : name));
    return;
  }
  const std::uint32_t from = level().file == &at_.main ? at_.block : level().called_from;
  enter({found->second.get(), tree_of(*found->second).begin_statement, true, from});
  at_.parameters.enter_program();
  if (at_.tree().inch != at_.inch) modes_.set_unit(at_.tree().inch);
}

/// END PGM, or the end of the file: back behind the call.
void Flow::end_program() {
  while (!levels_.empty() && !levels_.back().is_program) leave();
  if (!levels_.empty()) leave();
  if (levels_.empty()) {
    ended_ = true;
    return;
  }
  at_.parameters.leave_program();
  modes_.set_unit(at_.tree().inch);
}

/// Q5 = ..., and further ones behind it (the parameters of a cycle).
void Flow::assign(const Statement& s) {
  Cursor at = at_.cursor(s);
  while (at.more()) {
    const std::size_t begin = at.offset();
    const auto name = read_parameter(at);
    if (!name || !at.accept('='))
      return at_.error(begin, "expression", fmt::format("{}: Q5 = and a formula was expected", at.word()));
    if (name->kind == 'S')
      at_.parameters.set_text(name->number, read_text_formula(at, at_.parameters));
    else if (!set_or_say(*name, s, [&] { return read_formula(at, at_.parameters); }))
      return;
  }
}

/// Where the value has an error: says it, and what depends on it is not known. Returns whether there is a value.
bool Flow::set_or_say(const ParameterName& name, const Statement& s, const std::function<double()>& value) {
  try {
    at_.parameters.set(name, value());
    return true;
  } catch (const FormulaError& e) {
    at_.error(e.offset, e.check, e.what());
    at_.parameters.set_unknown(
        name, fmt::format("{} has an error in line {}", name.text(), at_.file().source.location(s.begin).line));
    return false;
  }
}

/// Q1 IS DEFINED, QS2 IS UNDEFINED: whether it holds. Nothing, and no move, where another condition stands there.
std::optional<bool> Flow::definition_asked(Cursor& at) const {
  Cursor ahead = at;
  const auto name = read_parameter(ahead);
  if (!name || !ahead.accept("IS")) return std::nullopt;
  const bool defined = ahead.accept("DEFINED");
  if (!defined && !ahead.accept("UNDEFINED"))
    throw FormulaError(ahead.offset(), "function", "IS without DEFINED or UNDEFINED");
  at = ahead;
  return at_.parameters.is_defined(*name) == defined;
}

/// GOTO LBL 5, where the condition holds.
void Flow::jump_behind_goto(Cursor& at, const Statement& s, bool holds) {
  if (!at.accept("GOTO")) throw FormulaError(s.begin, "function", "IF without GOTO LBL");
  at.accept("LBL");
  const std::string label = label_name(at);
  if (holds) jump(label, s.begin);
}

/// FN 0 to FN 38.
void Flow::run_function(const Statement& s) {
  Cursor at = at_.cursor(s);
  const auto number = at.integer();
  if (!number) throw FormulaError(s.begin, "function", "FN without a number; FN 0: was expected");
  at.accept(':');
  const auto is = [&](std::initializer_list<int> numbers) {
    return std::ranges::find(numbers, *number) != numbers.end();
  };
  const auto refused = [&](const char* what) { at_.error(s.begin, "not-supported", what, what); };
  if (*number == 14) {
    at.accept("ERROR");
    at.accept('=');
    at_.error(s.begin, "program-error",
              fmt::format("the program ends here with error {} (FN 14); conditions that do not lead here were expected",
                          read_value(at, at_.parameters)));
    ended_ = true;
    return;
  }
  if (is({15, 16})) return;  // printing
  if (is({17, 19, 20, 29, 37, 38}))
    return at_.warn(s.begin, "no-effect", fmt::format("FN {} is read without effect on the moves", *number),
                    fmt::format("FN {}", *number));
  if (*number == 18) {
    at.accept("SYSREAD");
    const auto name = read_parameter(at);
    if (!name) throw FormulaError(s.begin, "function", "FN 18 without a parameter; FN 18: SYSREAD Q1 = was expected");
    if (const auto value = tools_.asked_of_control(at)) return at_.parameters.set(*name, *value);
    return at_.parameters.set_unknown(*name, fmt::format("{} is read from the control (FN 18) in line {}", name->text(),
                                                         at_.file().source.location(s.begin).line));
  }
  if (is({26, 27, 28}))
    return refused("FN 26, FN 27 and FN 28 (tables) are not supported; values in Q parameters were expected");
  if (is({23, 24}))
    return refused(
        "FN 23 and FN 24 (circles through points) are not supported; the centre was expected in Q parameters");
  if (*number > 13)
    return at_.error(s.begin, "function", fmt::format("FN {} is not known; FN 0 to FN 20 were expected", *number));
  if (*number >= 9 && *number <= 12) {
    at.accept("IF");
    if (const auto asked = definition_asked(at)) return jump_behind_goto(at, s, *asked);
    const bool texts = is_text(at);
    const std::string first_text = texts ? read_text_formula(at, at_.parameters) : std::string();
    if (first_text.find('\0') != std::string::npos)
      throw FormulaError(s.begin, "unknown-parameter", "this depends on a text that is read from the control");
    const std::size_t begin = at.offset();
    const double a = texts ? 0 : at_.known(read_formula(at, at_.parameters), begin);
    std::string relation = at.letters();
    at.advance(relation.size());
    const std::size_t second = at.offset();
    // Of texts the order counts: 0 where they are the same.
    const double b = texts ? -static_cast<double>(first_text.compare(read_text_formula(at, at_.parameters)))
                           : at_.known(read_formula(at, at_.parameters), second);
    constexpr std::array<std::string_view, 4> kRelations{"EQU", "NE", "GT", "LT"};
    if (relation != kRelations[static_cast<std::size_t>(*number - 9)])
      throw FormulaError(s.begin, "function",
                         fmt::format("FN {} compares with {}, not {}", *number,
                                     kRelations[static_cast<std::size_t>(*number - 9)], relation));
    constexpr double kEqual = 1e-9;
    const bool holds = *number == 9    ? std::abs(a - b) <= kEqual
                       : *number == 10 ? std::abs(a - b) > kEqual
                       : *number == 11 ? a > b
                                       : a < b;
    return jump_behind_goto(at, s, holds);
  }
  const std::size_t begin = at.offset();
  const auto name = read_parameter(at);
  if (!name || !at.accept('='))
    throw FormulaError(begin, "function", fmt::format("FN {} without its parameter; Q1 = was expected", *number));
  const auto operand = [&] { return read_value(at, at_.parameters); };
  set_or_say(*name, s, [&]() -> double {
    // FN 5 to 7: SQRT, SIN or COS stands there.
    if (*number == 0 || (*number >= 5 && *number <= 7)) return read_formula(at, at_.parameters);
    const double a = operand();
    const std::size_t sign = at.offset();
    if (*number == 8) return at.accept("LEN"), std::hypot(a, operand());
    if (*number == 13) {
      at.accept("ANG");
      const double angle = deg_from_rad(std::atan2(a, operand()));
      return angle < 0 ? angle + 360 : angle;
    }
    if (*number == 4)
      at.accept("DIV") || at.accept('/');
    else
      at.accept("+-*"[*number - 1]);
    const double b = operand();
    if (*number == 4 && b == 0) throw FormulaError(sign, "expression", "a division by zero");
    return *number == 1 ? a + b : *number == 2 ? a - b : *number == 3 ? a * b : a / b;
  });
}

// --- M functions, TOOL CALL

namespace {

constexpr std::array kAtEnd{0, 1, 2, 5, 6, 9, 30};
/// Read, without effect on the moves; M functions of the control itself. Others are the machine maker's own.
constexpr std::array kPassed{10,  11,  90,  93,  94,  96,  97,  98,  101, 102, 104, 107, 108,
                             109, 110, 111, 112, 114, 115, 116, 117, 118, 120, 121, 124, 132,
                             133, 134, 135, 138, 141, 142, 143, 144, 145, 148, 149};

bool acts_at_end(int code) { return std::ranges::find(kAtEnd, code) != kAtEnd.end(); }

}  // namespace

void Functions::run_before(const BlockValues& b) {
  for (const auto& f : b.functions)
    if (!acts_at_end(f.code)) run(f);
}

void Functions::run_after(const BlockValues& b) {
  for (const auto& f : b.functions)
    if (acts_at_end(f.code)) run(f);
}

void Functions::run(const BlockValues::Function& f) {
  const auto says = [&](std::initializer_list<int> codes) { return std::ranges::find(codes, f.code) != codes.end(); };
  if (says({3, 4, 13, 14})) {
    if (f.code % 10 == 3)
      modes_.set_spindle(SpindleDirection::clockwise, EventKind::spindle_clockwise, f.code);
    else
      modes_.set_spindle(SpindleDirection::counter_clockwise, EventKind::spindle_counter_clockwise, f.code);
    if (f.code > 10) modes_.set_coolant(true, f.code);
    return;
  }
  if (f.code == 5) return modes_.set_spindle(SpindleDirection::stopped, EventKind::spindle_stop, f.code);
  if (says({7, 8, 9})) return modes_.set_coolant(f.code != 9, f.code);
  if (f.code == 19) return at_.add_event(EventKind::spindle_orient, f.code);
  if (says({91, 92, 99, 130, 136, 137, 140})) return;  // the path block reads them
  if (f.code == 89) {
    cycle_modal_ = true;
    return;
  }
  if (f.code == 103) return modes_.set_plunge_factor(f.argument);
  if (says({128, 129})) return orientation_.set_tip_control(f.code == 128);
  if (says({97, 98}) && compensation_.moves_path())
    at_.warn(f.offset, "no-effect",
             fmt::format("M{} is read without effect on the path that RL or RR makes here", f.code), "M97");
  if (f.code == 120) {
    const std::uint32_t words = modes_.state().mode_words;
    modes_.change().mode_words =
        f.argument && *f.argument == 0 ? words & ~mode_word_bit("m120") : with_mode_word(words, "m120");
  }
  if (says({126, 127})) orientation_.set_shortest_way(f.code == 126);
  at_.add_event(EventKind::m_code, f.code);
  if (says({2, 30})) return flow_.end_by_function();
  if (f.code <= 1 || says({6, 126, 127}) || std::ranges::find(kPassed, f.code) != kPassed.end()) return;
  at_.warn(f.offset, "machine-function",
           fmt::format("M{} is a function of the machine's maker; what it moves is not known, and it is passed over",
                       f.code),
           fmt::format("M{}", f.code));
}

/// TOOL CALL 5 Z S1000 F500 DL+0 DR+0: number, name or parameter; the axis or S may stand alone.
void Functions::call_tool(const Statement& s) {
  Cursor at = at_.cursor(s);
  if (const auto number = tools_.read_number(at)) {
    compensation_.end();
    tools_.call(*number);
  }
  BlockValues b;
  while (at.more()) {
    const std::size_t offset = at.offset();
    const char c = at.peek();
    if (at.accept_prefix("DR2")) {
      read_value(at, at_.parameters);
    } else if (at.accept_prefix("DR")) {
      tools_.set_delta_radius(at_.known_value(at, offset) * at_.unit_mm());
    } else if (at.accept_prefix("DL")) {
      read_value(at, at_.parameters);
    } else if (c == 'S') {
      at.advance();
      const bool bracket = at.accept('('), cutting_speed = at.accept("VC");
      if (cutting_speed) at.accept(':') || at.accept('=');
      double speed = at_.known_value(at, offset);
      if (bracket) at.accept(')');
      const auto radius = tools_.cutter_radius_mm();
      if (cutting_speed && (!radius || *radius <= 0)) {
        at_.warn(offset, "no-effect",
                 "a cutting speed in TOOL CALL needs the radius of the tool, which nothing gives; S with the speed was "
                 "expected");
        continue;
      }
      if (cutting_speed) speed *= (at_.inch ? 12 * 25.4 : 1000) / (2 * kPi * *radius);  // m, or feet, a minute
      modes_.set_spindle_speed(speed, offset);
    } else if (c == 'F') {
      at.advance();
      if (at.accept("AUTO") || at.accept("MAX")) continue;
      const char per = at.peek();
      if (per == 'Z' || per == 'U') at.advance();
      const double feed = at_.known_value(at, offset);
      if (per == 'Z')
        b.feed.per_tooth = feed;
      else if (per == 'U')
        b.feed.per_turn = feed;
      else
        b.feed.value = feed;
    } else if (c >= 'X' && c <= 'Z') {
      at.advance();
      tools_.set_axis(c - 'X');
    } else if (c == 'M') {
      at.advance();
      if (const auto code = at.integer()) run({*code, std::nullopt, offset});
    } else {
      throw FormulaError(offset, "not-a-word",
                         fmt::format("{} in TOOL CALL; the axis, S, F, DL, DR or DR2 was expected", at.word()));
    }
  }
  if (!b.feed.value && !b.feed.per_tooth && !b.feed.per_turn) return;
  modes_.set_feed(b);
  modes_.keep_tool_feed();
}

}  // namespace camber::nc::heidenhain
