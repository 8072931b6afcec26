// Cycles: definitions, calls, patterns.
#include "nc/heidenhain/klartext_flow.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc::heidenhain {
namespace {

constexpr double kFastFeed = 99999;  ///< FMAX in a parameter of a cycle

/// Machining cycles that are made.
constexpr std::array kMade{1,   2,   4,   5,   12,  17,  200, 201, 202, 203, 204,
                           205, 206, 207, 208, 209, 240, 241, 251, 252, 253, 262};

struct Named {
  int first, last;
  std::string_view what, instead;
};
/// Cycles that are refused by name.
constexpr std::array kRefused{
    Named{3, 3, "slot milling", "L blocks of the slot were expected"},
    Named{6, 6, "an SL cycle", "the finished path was expected"},
    Named{14, 16, "an SL cycle", "the finished path was expected"},
    Named{18, 18, "thread cutting", "cycle 206 or 207 was expected"},
    Named{20, 25, "an SL cycle", "the finished path was expected"},
    Named{27, 29, "a cylinder surface", "a path in X, Y and Z was expected"},
    Named{39, 39, "a cylinder surface", "a path in X, Y and Z was expected"},
    Named{210, 219, "a slot, pocket or stud", "the finished path was expected"},
    Named{222, 233, "a milling cycle", "the finished path was expected"},
    Named{254, 258, "a slot or stud", "the finished path was expected"},
    Named{263, 267, "thread milling", "CP blocks of the helix were expected"},
    Named{268, 277, "an SL or OCM cycle", "the finished path was expected"},
    Named{278, 299, "a milling or turning cycle", "the finished path was expected"},
    Named{400, 499, "a probing cycle", "leave out probing, or set the datum that it would set (CYCL DEF 247)"},
    Named{800, 899, "a turning cycle", "milling blocks were expected"},
};

}  // namespace

void Cycles::define(const Statement& s) {
  Cursor at = at_.cursor(s);
  const auto number = at.integer();
  if (!number) throw FormulaError(s.begin, "cycle", "CYCL DEF without a number; CYCL DEF 200 was expected");
  int part = -1;
  if (Cursor point = at; point.peek() == '.' && is_digit(point.behind(1))) {  // CYCL DEF9 .0 of some posts
    at = point;
    at.advance();
    part = at.integer().value_or(0);
  }
  if (*number < 200 && part < 0 && *number != 247) part = 0;
  const auto refused =
      std::ranges::find_if(kRefused, [&](const Named& n) { return *number >= n.first && *number <= n.last; });
  if (refused != kRefused.end() && part <= 0)
    at_.error(s.begin, "not-supported",
              fmt::format("CYCL DEF {} ({}) is not supported; {}", *number, refused->what, refused->instead));
  const auto pass = [&] { moves_.cycle() = {*number, 0, true}; };
  if (refused != kRefused.end()) return pass();
  if (*number < 200) return define_old(*number, part, at, s);

  if (*number != 247 && *number != 220 && *number != 221) pass();  // until the end of the definition is read
  // The name, then the parameters.
  for (bool named = false; at.more();) {
    const std::size_t begin = at.offset();
    Cursor parameter = at;
    const auto name = read_parameter(parameter);
    if (!name || !parameter.accept('=')) {
      at.go_to(begin);
      if (named || at.word().find('=') != std::string::npos)
        throw FormulaError(begin, "not-a-word",
                           fmt::format("{} in CYCL DEF {}; Q parameters were expected", at.word(), *number));
      at.go_to(begin + 1);
      continue;
    }
    at = parameter;
    named = true;
    if (at.accept_prefix("FMAX") || at.accept("MAX"))
      at_.parameters.set(*name, kFastFeed);
    else if (at.accept_prefix("FAUTO") || at.accept("AUTO"))
      at_.parameters.set(*name, modes_.tool_feed() ? mm_per_min_from_mm_per_s(*modes_.tool_feed()) / at_.unit_mm() : 0);
    else if (at.accept_prefix("FU"))
      at_.parameters.set(*name, read_value(at, at_.parameters) * 60 * modes_.turns_per_s("FU"));
    else if (at.accept_prefix("FZ"))
      at_.parameters.set(*name, read_value(at, at_.parameters) * 60 * modes_.teeth() * modes_.turns_per_s("FZ"));
    else if (at.letters() == "PREDEF")
      throw FormulaError(at.offset(), "not-supported", "PREDEF (GLOBAL DEF) is not supported; a number was expected");
    else if (name->kind == 'S')
      at_.parameters.set_text(name->number, read_text_formula(at, at_.parameters));
    else
      at_.parameters.set(*name, read_formula(at, at_.parameters));
  }
  if (*number == 247) {
    return frames_.use_preset(static_cast<int>(moves_.q_if_set(339).value_or(0)), s.begin);
  }
  if (*number == 220 || *number == 221) return run_pattern(*number);
  if (*number >= 300) {
    return at_.warn(
        s.begin, "machine-cycle",
        fmt::format("CYCL DEF {} is a cycle of the machine's maker; what it does is not known, and it is passed over",
                    *number));
  }
  if (std::ranges::find(kMade, *number) == kMade.end())
    return at_.error(
        s.begin, "not-supported",
        fmt::format("CYCL DEF {} is not supported; 200 to 209, 240, 241 and 251 to 253 were expected", *number));
  begin(*number, s.begin);
}

/// Cycles in parts, CYCL DEF 7.1: each part has one value.
void Cycles::define_old(int number, int part, Cursor at, const Statement& s) {
  const bool in_parts = number == 7 || number == 8 || number == 10 || number == 11 || number == 26;
  if (in_parts && part <= 0) return;
  if (number == 7) return frames_.shift_datum(at, s.begin);
  if (number == 8) return frames_.set_mirror(at);
  if (number == 10) return frames_.set_rotation(at);
  if (number == 11) return frames_.set_scale(at);
  if (number == 26) return frames_.set_axis_scale(at);
  if (number == 19) return orientation_.set_working_plane(at, part);
  if (number == 32) return modes_.set_tolerance(part, at);
  if (number == 13) {
    if (part > 0) at_.add_event(EventKind::spindle_orient, 19);
    return;
  }
  if (number == 12) {
    if (part == 0) {
      begin(12, s.begin);
      return;
    }
    at.accept("PGM");
    std::string_view text = at_.file().source.text();
    at.more();
    text = text.substr(at.offset(), s.end - at.offset());
    text = text.substr(0, text.find_first_of(" ;\r\n"));
    flow_.select_program(text);
    return;
  }
  if (number != 9 && std::ranges::find(kMade, number) == kMade.end())
    return at_.error(s.begin, "not-supported",
                     fmt::format("CYCL DEF {} is not supported; cycles 1, 2, 4, 5, 7 to 13, 17, 19, 26, "
                                 "32 or 200 to 209 were expected",
                                 number),
                     fmt::format("cycle {}", number));
  if (part == 0) {
    if (number == 9) return;
    begin(number, s.begin);
    return;
  }
  // A word, a value, perhaps a feed: ZUSTLG 4 F100, V.ZEIT 0.5, X+145, F200 DR- RADIUS 16.
  std::optional<double> value, feed;
  while (at.more()) {
    const std::size_t begin = at.offset();
    const std::string word = at.letters();
    if (word == "RADIUS") {
      at.advance(word.size());
      moves_.cycle().radius = at_.known_value(at, begin) * at_.unit_mm();
      if (!value) value = moves_.cycle().radius / at_.unit_mm();
    } else if (word == "DR") {
      at.advance(word.size());
      moves_.cycle().sense = at.peek() == '-' ? -1 : 1;
      at.advance();
    } else if (Cursor behind = at; word == "F" && (behind.advance(), begins_number(behind))) {
      at = behind;
      feed = at_.known_value(at, begin);
    } else if (Cursor ahead = at; word.starts_with('Q') && read_parameter(ahead)) {
      value = at_.known_value(at, begin);
    } else if (!word.empty()) {
      at.advance(word.size());
      if (at.behind(0) == '.') at.advance();
    } else if (begins_number(at)) {
      value = at_.known_value(at, begin);
    } else {
      at.advance();
    }
  }
  if (number == 9) {
    if (value && *value > 0) {
      Move& move = mover_.add_move(MoveKind::dwell, mover_.position_mm());
      move.dwell_s = *value;
      move.editable = false;
    } else {
      at_.error(s.begin, "dwell", "CYCL DEF 9 without a time; seconds were expected in CYCL DEF 9.1");
    }
    return;
  }
  if (moves_.cycle().number != number) return;
  if (value) moves_.cycle().values[part] = *value;
  if (feed) moves_.cycle().feeds[part] = mm_per_s_from_mm_per_min(*feed * at_.unit_mm());
}

void Cycles::run_call(const Statement& s, Functions& functions) {
  Cursor at = at_.cursor(s);
  BlockValues said;
  const auto read_rest = [&](Vec3* place) {
    std::uint8_t given = 0;
    while (at.more()) {
      const std::size_t begin = at.offset();
      const char c = at.peek();
      at.advance();
      if (c == 'F' && !begins_number(at)) {
        at.accept("MAX") || at.accept("AUTO");
        continue;
      }
      if (c == 'M') {
        if (const auto code = at.integer()) said.functions.push_back({*code, std::nullopt, begin});
      } else if (c == 'F') {
        BlockValues b;
        b.feed.value = at_.known_value(at, begin);
        modes_.set_feed(b);
      } else if (const char axis = c == 'I' ? at.peek() : c; place && axis >= 'X' && axis <= 'Z') {
        if (c == 'I') at.advance();
        double& value = (*place)[axis - 'X'];
        value = (c == 'I' ? value : 0) + at_.known_value(at, begin) * at_.unit_mm();
        given = static_cast<std::uint8_t>(given | 1U << (axis - 'X'));
      } else {
        at.go_to(begin);
        throw FormulaError(begin, "not-a-word", fmt::format("{} in CYCL CALL; M or F was expected", at.word()));
      }
    }
    return given;
  };
  const auto with_functions = [&](const auto& body) {
    functions.run_before(said);
    body();
    functions.run_after(said);
  };
  at_.editable = false;
  if (at.accept("POS")) {
    Vec3 place = mover_.programmed();
    const std::uint8_t given = read_rest(&place);
    with_functions([&] {
      Vec3 over = mover_.programmed();
      const PlaneAxes axes = tools_.axes();
      over[axes.first] = place[axes.first];
      over[axes.second] = place[axes.second];
      if (place[axes.normal] > over[axes.normal]) {
        Vec3 up = mover_.programmed();
        up[axes.normal] = place[axes.normal];
        moves_.go(MoveKind::rapid, up, 0);
        over[axes.normal] = place[axes.normal];
      }
      moves_.go(MoveKind::rapid, over, 0);
      mover_.settle(given);
      moves_.go(MoveKind::rapid, place, 0);
      call(s.begin);
    });
    return;
  }
  if (at.accept("PAT")) {
    read_rest(nullptr);
    if (pattern_.empty())
      throw FormulaError(s.begin, "cycle", "CYCL CALL PAT without a pattern; PATTERN DEF was expected before");
    with_functions([&] {
      const PlaneAxes axes = tools_.axes();
      for (const Vec3& place : pattern_) {
        at_.parameters.set({'Q', 203}, place[axes.normal] / at_.unit_mm());
        Vec3 over = mover_.programmed();
        over[axes.first] = place[axes.first];
        over[axes.second] = place[axes.second];
        moves_.go(MoveKind::rapid, over, 0);
        mover_.settle(static_cast<std::uint8_t>(1U << axes.first | 1U << axes.second));
        call(s.begin);
      }
    });
    return;
  }
  read_rest(nullptr);
  with_functions([&] { call(s.begin); });
}

void Cycles::call(std::size_t offset) {
  if (moves_.cycle().number < 0) {
    at_.error(offset, "cycle", "a cycle is called and none is defined; CYCL DEF was expected before");
    return;
  }
  if (moves_.cycle().passed) return;
  if (compensation_.moves_path()) {
    at_.error(offset, "cutter-radius", "a cycle under RL or RR; R0 was expected before");
    compensation_.end();
  }
  const bool editable = std::exchange(at_.editable, false);
  if (moves_.cycle().number == 12) flow_.open_selected(offset);
  moves_.run(offset);
  at_.editable = editable;
}

/// Cycles 220 (circle) and 221 (rows): the last cycle at each place, at once.
void Cycles::run_pattern(int number) {
  moves_.cycle().offset = at_.statement->begin;
  if (moves_.cycle().number < 0)
    return at_.error(at_.statement->begin, "cycle",
                     fmt::format("cycle {} repeats a cycle and none is defined; CYCL DEF was expected before", number));
  const double unit = at_.unit_mm();
  const double surface = moves_.q_if_set(203).value_or(0) * unit, clearance = moves_.q(200) * unit;
  const double second = moves_.q_if_set(204).value_or(0) * unit;
  const bool high = moves_.q_if_set(301).value_or(1) != 0;
  const PlaneAxes axes = tools_.axes();
  std::vector<Vec2> places;
  const auto count_of = [&](int parameter) {
    const double count = moves_.q(parameter);
    if (count < 1 || count > 100000)
      throw FormulaError(at_.statement->begin, "cycle",
                         fmt::format("Q{} is {}; a number of holes was expected", parameter, count));
    return static_cast<int>(std::lround(count));
  };
  if (number == 220) {
    const Vec2 middle(moves_.q(216) * unit, moves_.q(217) * unit);
    const int count = count_of(241);
    const double radius = 0.5 * moves_.q(244) * unit, first = moves_.q(245), last = moves_.q_if_set(246).value_or(360);
    double angle = moves_.q_if_set(247).value_or(0);
    if (angle == 0) {
      const double all = last - first;
      const bool whole = std::abs(std::abs(all) - 360) < 1e-9;
      angle = count > 1 ? all / (whole ? count : count - 1) : 0;
    }
    for (int i = 0; i < count; ++i) places.push_back(middle + radius * direction_at_deg(first + i * angle));
  } else {
    const Vec2 start(moves_.q(225) * unit, moves_.q(226) * unit);
    const double dx = moves_.q(237) * unit, dy = moves_.q(238) * unit;
    const Vec2 along = direction_at_deg(moves_.q_if_set(224).value_or(0));
    const int columns = count_of(242), rows = count_of(243);
    for (int row = 0; row < rows; ++row)
      for (int i = 0; i < columns; ++i) {
        const int column = row % 2 == 0 ? i : columns - 1 - i;
        const Vec2 p(column * dx, row * dy);
        places.push_back(start + Vec2(along.x() * p.x() - along.y() * p.y(), along.y() * p.x() + along.x() * p.y()));
      }
  }
  const bool editable = std::exchange(at_.editable, false);
  const double above = surface + std::max(clearance, second), low = surface + clearance;
  bool first = true;
  for (const Vec2& place : places) {
    Vec3 up = mover_.programmed();
    up[axes.normal] = first ? std::max(up[axes.normal], above) : high ? above : low;
    moves_.go(MoveKind::rapid, up, 0);
    Vec3 over = up;
    over[axes.first] = place.x();
    over[axes.second] = place.y();
    moves_.go(MoveKind::rapid, over, 0);
    mover_.settle(7);
    Vec3 down = over;
    down[axes.normal] = low;
    moves_.go(MoveKind::rapid, down, 0);
    call(at_.statement->begin);
    first = false;
  }
  at_.editable = editable;
}

/// PATTERN DEF POS1 (X+25 Y+33 Z+0) ROW1 (...) PAT1 (...) FRAME1 (...) CIRC1 (...) PITCHCIRC1 (...).
void Cycles::define_pattern(const Statement& s) {
  Cursor at = at_.cursor(s);
  at.accept("DEF");
  pattern_.clear();
  const PlaneAxes axes = tools_.axes();
  while (at.more()) {
    const std::size_t begin = at.offset();
    const std::string form = at.letters();
    at.advance(form.size());
    at.integer();
    if (!at.accept('('))
      throw FormulaError(begin, "cycle", fmt::format("{} in PATTERN DEF; POS1 (X Y Z) was expected", at.word()));
    std::map<std::string, double> values;
    while (at.more() && at.peek() != ')') {
      const std::size_t here = at.offset();
      const std::string word = at.letters();
      const bool step = word == "IX" || word == "IY";  // from the place before
      constexpr std::array<std::string_view, 14> kWords{"X",    "Y",  "Z",  "D",    "NUM",  "ROT",   "ROTX",
                                                        "ROTY", "DX", "DY", "NUMX", "NUMY", "START", "STEP"};
      if (!step && std::ranges::find(kWords, word) == kWords.end())
        throw FormulaError(here, "cycle", fmt::format("{} in PATTERN DEF; X, Y or Z was expected", at.word()));
      at.advance(word.size());
      const double value = at_.known_value(at, here);
      if (step && pattern_.empty())
        throw FormulaError(here, "cycle",
                           fmt::format("{} in the first place of PATTERN DEF; X and Y were expected", word));
      if (step)
        values[word.substr(1)] = value + pattern_.back()[word == "IX" ? axes.first : axes.second] / at_.unit_mm();
      else
        values[word] = value;
    }
    if (!at.accept(')')) throw FormulaError(begin, "cycle", "the bracket ( of PATTERN DEF is not closed");
    const auto value = [&](const char* name) {
      const auto found = values.find(name);
      return found == values.end() ? 0.0 : found->second;
    };
    const double unit = at_.unit_mm();
    const Vec2 start = Vec2(value("X"), value("Y")) * unit;
    const auto add = [&](const Vec2& p) {
      Vec3 place = Vec3::Zero();
      place[axes.first] = p.x();
      place[axes.second] = p.y();
      place[axes.normal] = value("Z") * unit;
      pattern_.push_back(place);
    };
    const auto turned = [](const Vec2& p, double degrees) {
      const Vec2 d = direction_at_deg(degrees);
      return Vec2(d.x() * p.x() - d.y() * p.y(), d.y() * p.x() + d.x() * p.y());
    };
    const auto count = [&](const char* name) {
      const double n = value(name);
      if (n < 1 || n > 100000)
        throw FormulaError(begin, "cycle",
                           fmt::format("{} of PATTERN DEF is {}; a number of places was expected", name, n));
      return static_cast<int>(std::lround(n));
    };
    if (form == "POS") {
      add(start);
    } else if (form == "ROW") {
      for (int i = 0, n = count("NUM"); i < n; ++i) add(start + turned(Vec2(i * value("D") * unit, 0), value("ROT")));
    } else if (form == "PAT" || form == "FRAME") {
      const int columns = count("NUMX"), rows = count("NUMY");
      for (int row = 0; row < rows; ++row)
        for (int i = 0; i < columns; ++i) {
          const int column = row % 2 == 0 ? i : columns - 1 - i;
          if (form == "FRAME" && row > 0 && row + 1 < rows && column > 0 && column + 1 < columns) continue;
          const Vec2 along = turned(Vec2(column * value("DX") * unit, 0), value("ROTX"));
          const Vec2 across = turned(Vec2(0, row * value("DY") * unit), value("ROTY"));
          add(start + turned(along + across, value("ROT")));
        }
    } else if (form == "CIRC" || form == "PITCHCIRC") {
      const int n = count("NUM");
      const double step = form == "CIRC" ? 360.0 / n : value("STEP");
      for (int i = 0; i < n; ++i) add(start + turned(Vec2(0.5 * value("D") * unit, 0), value("START") + i * step));
    } else {
      throw FormulaError(
          begin, "not-supported",
          fmt::format("{} in PATTERN DEF is not supported; POS, ROW, PAT, FRAME, CIRC or PITCHCIRC was expected",
                      form));
    }
    if (pattern_.size() > 1'000'000) throw FormulaError(begin, "cycle", "a pattern of more than a million places");
  }
}

}  // namespace camber::nc::heidenhain
