#include "nc/heidenhain/klartext.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/canned_cycles.h"
#include "nc/durations.h"
#include "nc/heidenhain/heidenhain_language.h"
#include "nc/heidenhain/klartext_reader.h"

namespace camber::nc::heidenhain {

Klartext::Klartext(const Program& main, const InterpreterOptions& options, Diagnostics& diagnostics, Reporter& report,
                   Interpretation& out)
    : main_(main),
      options_(options),
      diagnostics_(diagnostics),
      report_(report),
      out_(out),
      offsets_(options.work_offsets_mm) {
  runs_.assign(main.blocks.size(), 0);
  inch_ = tree_of(main).inch;
  state_.inch = inch_;
  start_open_ = !options.rotary_axes.empty();
  levels_.push_back({&main, tree_of(main).begin_statement, true, 0});
  parameters_.system = [this](int number) { return system_value(number); };
  for (const auto& [number, offset] : options.tool_offsets)
    if (number >= 0) tools_[number] = {offset.length_mm, offset.effective_radius_mm()};
  update_frame();
}

Klartext::~Klartext() = default;

void Klartext::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  report_.set_source(file().source);
  report_.error(offset, check, std::move(message), alike);
}

void Klartext::warn(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  report_.set_source(file().source);
  report_.warning(offset, check, std::move(message), alike);
}

std::string Klartext::text_of(const Statement& s) const {
  std::string_view text = file().source.text();
  text = text.substr(s.begin, s.end - s.begin);
  text = text.substr(0, text.find_first_of("\r\n;"));
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

void Klartext::run() {
  while (!ended_ && !levels_.empty() && !report_.full()) {
    if (!step()) break;
  }
  if (levels_.empty()) levels_.push_back({&main_, 0, true, 0});
  finish();
}

/// The next statement; false at the end of the program.
bool Klartext::step() {
  Level& here = level();
  const Tree& statements = tree();
  if (here.next >= statements.statements.size()) {
    end_program();
    return !levels_.empty();
  }
  const Statement& s = statements.statements[here.next++];
  if (s.kind == Kind::nothing || (s.skip != 0 && options_.skip_slash_blocks)) return true;
  const bool is_main = here.file == &main_;
  if (is_main) {
    std::uint8_t& runs = runs_[s.block];
    if (runs > 0) ++repeated_;
    if (runs < 255) ++runs;
  } else {
    ++repeated_;
  }
  if (repeated_ > options_.max_repeated_blocks) {
    error(s.begin, "endless",
          fmt::format("loops and subprograms have run {} blocks again; the program seems to have no end",
                      options_.max_repeated_blocks));
    return false;
  }
  statement_ = &s;
  block_ = is_main ? s.block : here.called_from;
  editable_ = is_main && s.lines == 1;
  try {
    execute(s);
  } catch (const FormulaError& e) {
    error(e.offset, e.check, e.what());
    // Where a value or a jump is lacking, loops may never end: what follows says nothing more.
    if (s.kind >= Kind::call_label && s.kind <= Kind::function) return false;
  }
  return !levels_.empty();
}

void Klartext::execute(const Statement& s) {
  if (has_words(s.kind)) return run_path(s);
  using Run = void (Klartext::*)(const Statement&);
  static constexpr std::pair<Kind, Run> kRun[] = {{Kind::tool_call, &Klartext::call_tool},
                                                  {Kind::tool_def, &Klartext::define_tool},
                                                  {Kind::blank_form, &Klartext::read_blank_form},
                                                  {Kind::call_label, &Klartext::call_label},
                                                  {Kind::assignment, &Klartext::assign},
                                                  {Kind::function, &Klartext::run_function},
                                                  {Kind::cycle_def, &Klartext::define_cycle},
                                                  {Kind::cycle_call, &Klartext::run_cycle_call},
                                                  {Kind::plane, &Klartext::run_plane},
                                                  {Kind::tcpm, &Klartext::run_tcpm},
                                                  {Kind::transform, &Klartext::run_transform},
                                                  {Kind::pattern, &Klartext::define_pattern},
                                                  {Kind::dwell, &Klartext::run_dwell},
                                                  {Kind::refused, &Klartext::refuse}};
  for (const auto& [kind, run] : kRun)
    if (s.kind == kind) return (this->*run)(s);
  switch (s.kind) {
    case Kind::end_program:
      note_rest(s);
      end_program();
      break;
    case Kind::label: {
      const auto number = cursor(s).integer();
      if (number && *number == 0 && !level().is_program) levels_.pop_back();
      break;
    }
    case Kind::call_program:
    case Kind::select_program:
      call_program(s, s.kind == Kind::select_program);
      break;
    case Kind::stop: {
      add_event(EventKind::m_code, 0);
      Cursor at = cursor(s);
      if (at.accept('M'))
        if (const auto code = at.integer()) run_m({*code, std::nullopt, s.begin});
      break;
    }
    case Kind::noted: {
      Cursor at(file().source.text(), s.begin, s.end);
      std::string name = at.letters();
      at.advance(name.size());
      at.more();
      const std::string first = at.letters();
      name += " " + (first == "S" ? std::string("S-PULSE") : first);
      warn(s.begin, "no-effect", fmt::format("{} is read without effect", name), name);
      break;
    }
    default:
      break;
  }
}

/// Blocks behind END PGM are never read.
void Klartext::note_rest(const Statement& s) {
  const auto& all = tree().statements;
  for (std::size_t i = static_cast<std::size_t>(&s - all.data()) + 1; i < all.size(); ++i)
    if (all[i].kind != Kind::nothing)
      return warn(all[i].begin, "after-end", "text behind END PGM is no part of the program and is not read",
                  "after-end");
}

/// FUNCTION DWELL TIME 2.5, in seconds; REV 3, in turns of the spindle.
void Klartext::run_dwell(const Statement& s) {
  Cursor at = cursor(s);
  const bool turns = at.accept_prefix("REV");
  if (!turns && !at.accept_prefix("TIME"))
    throw FormulaError(at.offset(), "dwell", "FUNCTION DWELL without TIME or REV; TIME10 was expected");
  const std::size_t offset = at.offset();
  const double count = known(read_value(at, parameters_), offset);
  const double rate = turns ? turns_per_s("FUNCTION DWELL REV") : 1;
  if (!(count > 0) || rate <= 0) return;
  Move& move = add_move(MoveKind::dwell, position_mm_);
  move.dwell_s = count / rate;
  move.editable = false;
}

void Klartext::refuse(const Statement& s) {
  const Refusal refusal = refusal_of(std::string_view(file().source.text()).substr(s.begin, s.end - s.begin));
  error(s.begin, refusal.check, refusal.message, refusal.alike);
}

// --- labels and calls

std::string Klartext::label_name(Cursor& at) {
  if (auto text = at.quoted()) return *text;
  const std::size_t offset = at.offset();
  if (at.peek() == 'Q') {
    if (const auto name = read_parameter(at)) {
      if (name->kind == 'S' && !parameters_.is_defined(*name))
        throw FormulaError(offset, "undefined-parameter",
                           name->text() + " has no text here; a name was expected before");
      if (name->kind == 'S') return parameters_.text(name->number);
      return fmt::format("{}", std::lround(known(parameters_.value(*name, offset), offset)));
    }
  }
  if (const auto number = at.integer()) return fmt::format("{}", *number);
  throw FormulaError(offset, "label",
                     "a label without a number or a name in quotes; LBL 1 or LBL \"NAME\" was expected");
}

void Klartext::jump(const std::string& label, std::size_t offset) {
  const auto found = tree().labels.find(label);
  if (found == tree().labels.end())
    throw FormulaError(offset, "label", fmt::format("LBL {} is not in the program", label));
  level().next = found->second;
}

/// CALL LBL 1: a subprogram, up to LBL 0; CALL LBL 1 REP 3: three times more from there up to here.
void Klartext::call_label(const Statement& s) {
  Cursor at = cursor(s);
  const std::string label = label_name(at);
  const std::size_t index = static_cast<std::size_t>(&s - tree().statements.data());
  if (at.accept_prefix("REP") && at.more()) {  // REP without a number: a subprogram, as older controls write it
    const std::size_t offset = at.offset();
    const double count = known(read_value(at, parameters_), offset);
    if (count < 0 || count > 65534)
      throw FormulaError(offset, "label", fmt::format("REP {}; a number from 0 to 65534 was expected", count));
    const auto [left, is_new] = repeats_left_.emplace(std::pair(&tree(), index), static_cast<int>(std::lround(count)));
    if (left->second > 0) {
      --left->second;
      if (const auto found = tree().labels.find(label); found != tree().labels.end() && found->second > index)
        warn(s.begin, "label",
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
  if (!tree().labels.contains(label))
    throw FormulaError(s.begin, "label", fmt::format("LBL {} is not in the program", label));
  levels_.push_back({here.file, 0, false, here.called_from});
  jump(label, s.begin);
  ++level().next;
}

void Klartext::call_program(const Statement& s, bool selected) {
  std::string_view text = file().source.text();
  if (selected) {
    Cursor keyword(text, s.begin, s.end);
    if (keyword.accept("CALL")) {
      if (selected_program_.empty())
        return error(s.begin, "program-missing", "CALL SELECTED PGM without SEL PGM before");
      return open_program(selected_program_, s.begin);
    }
  }
  Cursor at = cursor(s);
  std::string path;
  if (auto quoted = at.quoted()) {
    path = *quoted;
  } else if (at.peek() == 'Q' && at.behind(1) == 'S') {
    const auto name = read_parameter(at);
    path = name ? parameters_.text(name->number) : std::string();
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
void Klartext::open_program(const std::string& path, std::size_t offset) {
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
    fs::path folder = fs::path(main_.source.name()).parent_path();
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
    warn(offset, "program-missing",
         fmt::format("CALL PGM {}: there is no {} beside the program; what it does is not known, and it is passed over",
                     path, name.find('.') == std::string::npos ? name + ".h" : name));
    return;
  }
  const std::uint32_t from = level().file == &main_ ? block_ : level().called_from;
  levels_.push_back({found->second.get(), tree_of(*found->second).begin_statement, true, from});
  parameters_.enter_program();
  if (tree().inch != inch_) {
    inch_ = state_.inch = tree().inch;
    state_changed_ = true;
  }
}

/// END PGM, or the end of the file: back behind the call.
void Klartext::end_program() {
  while (!levels_.empty() && !levels_.back().is_program) levels_.pop_back();
  if (!levels_.empty()) levels_.pop_back();
  if (levels_.empty()) {
    ended_ = true;
    return;
  }
  parameters_.leave_program();
  inch_ = state_.inch = tree().inch;
  state_changed_ = true;
}

// --- parameters

/// The value, unless only the machine knows it.
double Klartext::known(double value, std::size_t offset) {
  if (std::isnan(value))
    throw FormulaError(
        offset, "unknown-parameter",
        fmt::format("this depends on a parameter whose value is not known: {}", parameters_.why_unknown()));
  return value;
}

std::optional<double> Klartext::system_value(int number) const {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  switch (number) {
    case 108:
      if (const auto radius = cutter_radius_mm()) return *radius / unit_mm();
      return kUnknown;
    case 109:
      return tool_called_ ? tool_axis_ : -1;
    case 110:
      return state_.spindle == SpindleDirection::clockwise           ? 0
             : state_.spindle == SpindleDirection::counter_clockwise ? 1
                                                                     : -1;
    case 111:
      return state_.coolant ? 1 : 0;
    case 113:
      return inch_ ? 1 : 0;
    case 114: {
      const auto tool = tools_.find(state_.tool);
      if (tool != tools_.end() && tool->second.length_mm) return *tool->second.length_mm / unit_mm();
      return kUnknown;
    }
    case 120:
    case 121:
    case 122:
      return kUnknown;
    default:
      return std::nullopt;
  }
}

/// Q5 = ..., and further ones behind it (the parameters of a cycle).
void Klartext::assign(const Statement& s) {
  Cursor at = cursor(s);
  while (at.more()) {
    const std::size_t begin = at.offset();
    const auto name = read_parameter(at);
    if (!name || !at.accept('='))
      return error(begin, "expression", fmt::format("{}: Q5 = and a formula was expected", at.word()));
    if (name->kind == 'S')
      parameters_.set_text(name->number, read_text_formula(at, parameters_));
    else if (!set_or_say(*name, s, [&] { return read_formula(at, parameters_); }))
      return;
  }
}

/// Where the value has an error: says it, and what depends on it is not known. Returns whether there is a value.
bool Klartext::set_or_say(const ParameterName& name, const Statement& s, const std::function<double()>& value) {
  try {
    parameters_.set(name, value());
    return true;
  } catch (const FormulaError& e) {
    error(e.offset, e.check, e.what());
    parameters_.set_unknown(
        name, fmt::format("{} has an error in line {}", name.text(), file().source.location(s.begin).line));
    return false;
  }
}

/// Q1 IS DEFINED, QS2 IS UNDEFINED: whether it holds. Nothing, and no move, where another condition stands there.
std::optional<bool> Klartext::definition_asked(Cursor& at) const {
  Cursor ahead = at;
  const auto name = read_parameter(ahead);
  if (!name || !ahead.accept("IS")) return std::nullopt;
  const bool defined = ahead.accept("DEFINED");
  if (!defined && !ahead.accept("UNDEFINED"))
    throw FormulaError(ahead.offset(), "function", "IS without DEFINED or UNDEFINED");
  at = ahead;
  return parameters_.is_defined(*name) == defined;
}

/// GOTO LBL 5, where the condition holds.
void Klartext::jump_behind_goto(Cursor& at, const Statement& s, bool holds) {
  if (!at.accept("GOTO")) throw FormulaError(s.begin, "function", "IF without GOTO LBL");
  at.accept("LBL");
  const std::string label = label_name(at);
  if (holds) jump(label, s.begin);
}

/// = ID50 NR2 IDX5: number, length and radius of a tool, where they are given.
std::optional<double> Klartext::asked_of_control(Cursor at) {
  const auto number = [&](std::string_view word) { return at.accept_prefix(word) ? read_value(at, parameters_) : -1; };
  at.accept('=');
  const double group = number("ID"), which = number("NR"), index = number("IDX");
  const int tool = index < 0 ? state_.tool : static_cast<int>(index);
  if (group == 20 && which == 1) return state_.tool;
  if (group != 50 || (which != 1 && which != 2)) return std::nullopt;
  const auto found = tools_.find(tool);
  std::optional<double> value = found == tools_.end() ? std::nullopt
                                : which == 1          ? found->second.length_mm
                                                      : found->second.radius_mm;
  if (!value && which == 2) value = nc::cutter_radius_mm(options_.tool_offsets, tool);
  return value ? std::optional(*value / unit_mm()) : std::nullopt;
}

/// FN 0 to FN 38.
void Klartext::run_function(const Statement& s) {
  Cursor at = cursor(s);
  const auto number = at.integer();
  if (!number) throw FormulaError(s.begin, "function", "FN without a number; FN 0: was expected");
  at.accept(':');
  const auto is = [&](std::initializer_list<int> numbers) {
    return std::ranges::find(numbers, *number) != numbers.end();
  };
  const auto refused = [&](const char* what) { error(s.begin, "not-supported", what, what); };
  if (*number == 14) {
    at.accept("ERROR");
    at.accept('=');
    error(s.begin, "program-error",
          fmt::format("the program ends here with error {} (FN 14); conditions that do not lead here were expected",
                      read_value(at, parameters_)));
    ended_ = true;
    return;
  }
  if (is({15, 16})) return;  // printing
  if (is({17, 19, 20, 29, 37, 38}))
    return warn(s.begin, "no-effect", fmt::format("FN {} is read without effect on the moves", *number),
                fmt::format("FN {}", *number));
  if (*number == 18) {
    at.accept("SYSREAD");
    const auto name = read_parameter(at);
    if (!name) throw FormulaError(s.begin, "function", "FN 18 without a parameter; FN 18: SYSREAD Q1 = was expected");
    if (const auto value = asked_of_control(at)) return parameters_.set(*name, *value);
    return parameters_.set_unknown(*name, fmt::format("{} is read from the control (FN 18) in line {}", name->text(),
                                                      file().source.location(s.begin).line));
  }
  if (is({26, 27, 28}))
    return refused("FN 26, FN 27 and FN 28 (tables) are not supported; values in Q parameters were expected");
  if (is({23, 24}))
    return refused(
        "FN 23 and FN 24 (circles through points) are not supported; the centre was expected in Q parameters");
  if (*number > 13)
    return error(s.begin, "function", fmt::format("FN {} is not known; FN 0 to FN 20 were expected", *number));
  if (*number >= 9 && *number <= 12) {
    at.accept("IF");
    if (const auto asked = definition_asked(at)) return jump_behind_goto(at, s, *asked);
    const bool texts = is_text(at);
    const std::string first_text = texts ? read_text_formula(at, parameters_) : std::string();
    if (first_text.find('\0') != std::string::npos)
      throw FormulaError(s.begin, "unknown-parameter", "this depends on a text that is read from the control");
    const std::size_t begin = at.offset();
    const double a = texts ? 0 : known(read_formula(at, parameters_), begin);
    std::string relation = at.letters();
    at.advance(relation.size());
    const std::size_t second = at.offset();
    // Of texts the order counts: 0 where they are the same.
    const double b = texts ? -static_cast<double>(first_text.compare(read_text_formula(at, parameters_)))
                           : known(read_formula(at, parameters_), second);
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
  const auto operand = [&] { return read_value(at, parameters_); };
  set_or_say(*name, s, [&]() -> double {
    // FN 5 to 7: SQRT, SIN or COS stands there.
    if (*number == 0 || (*number >= 5 && *number <= 7)) return read_formula(at, parameters_);
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

// --- the blank

void Klartext::read_blank_form(const Statement& s) {
  Cursor at = cursor(s);
  if (!at.accept("FORM")) return error(s.begin, "blank", "BLK without FORM; BLK FORM 0.1 was expected");
  for (const char* form : {"FILE", "ROTATION"})
    if (at.accept(form))
      return warn(s.begin, "no-effect",
                  fmt::format("BLK FORM {} is read without effect; the stock is given in the job", form));
  if (at.accept("CYLINDER")) {
    double radius = 0, length = 0, distance = 0;
    const char axis = at.peek();
    at.advance();
    while (at.more()) {
      if (at.accept_prefix("DIST"))
        distance = read_value(at, parameters_);
      else if (at.accept_prefix("RI") || at.accept_prefix("DI"))
        read_value(at, parameters_);
      else if (at.accept('R'))
        radius = read_value(at, parameters_);
      else if (at.accept('D'))
        radius = 0.5 * read_value(at, parameters_);
      else if (at.accept('L'))
        length = read_value(at, parameters_);
      else
        throw FormulaError(at.offset(), "blank",
                           fmt::format("{} in BLK FORM CYLINDER; R, L or DIST was expected", at.word()));
    }
    if (axis != 'Z' || radius <= 0 || length <= 0 || out_.stock) return;
    const double unit = unit_mm();
    out_.stock = ProgramStock{true, Vec3(-radius, -radius, distance - length) * unit,
                              Vec3(radius, radius, distance) * unit, block_};
    return;
  }
  const auto part = at.number();
  const bool first = part && std::abs(*part - 0.1) < 1e-9, second = part && std::abs(*part - 0.2) < 1e-9;
  if (!first && !second) return error(s.begin, "blank", "BLK FORM 0.1, 0.2, CYLINDER or FILE was expected");
  if (first && (at.peek() == 'X' || at.peek() == 'Y' || at.peek() == 'Z') && !is_digit(at.behind(1)) &&
      at.behind(1) != '+' && at.behind(1) != '-')
    at.advance();  // the tool axis
  Vec3 corner = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  while (at.more()) {
    const std::size_t begin = at.offset();
    const bool step = at.peek() == 'I';
    if (step) at.advance();
    const char axis = at.peek();
    if (axis < 'X' || axis > 'Z')
      throw FormulaError(begin, "blank", fmt::format("{} in BLK FORM; X, Y and Z were expected", at.word()));
    at.advance();
    double value = read_value(at, parameters_) * unit_mm();
    if (step && blank_min_mm_) value += (*blank_min_mm_)[axis - 'X'];
    corner[axis - 'X'] = value;
  }
  if (first) {
    blank_min_mm_ = corner;
    return;
  }
  if (!blank_min_mm_ || out_.stock) return;
  // Some posts have the corners the other way round.
  const Vec3 low = blank_min_mm_->cwiseMin(corner), high = blank_min_mm_->cwiseMax(corner);
  if ((high - low).minCoeff() > 0) out_.stock = ProgramStock{false, low, high, block_};
}

// --- the end

void Klartext::finish() {
  end_compensation();
  place_stock();
  if (corner_.waits && !report_.has_errors())
    error(corner_.offset, "corner", fmt::format("{} is not followed by a further block of the contour", corner_.text));
  if (approach_.waits && !report_.has_errors())
    error(approach_.offset, "approach", "APPR is not followed by a block of the contour; L, C or CR was expected");
  for (Move& move : out_.moves)
    if (runs_[move.block] > 1) move.editable = false;
  relied_ends_.fix(out_);
  out_.tool_names = tool_numbers_.names();
}

Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  Interpretation out;
  Reporter report(program.source, diagnostics);
  {
    Klartext run(program, options, diagnostics, report, out);
    run.run();
    report.set_source(program.source);
    check_durations(program, out, report);
    report.finish();
  }
  return out;
}

}  // namespace camber::nc::heidenhain
