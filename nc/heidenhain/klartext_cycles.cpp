// Cycles: definitions, calls, patterns.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/heidenhain/klartext.h"
#include "nc/mode_words.h"

namespace camber::nc::heidenhain {
namespace {

constexpr double kAboveLastDepthMm = 0.2;  ///< rapids in a hole stop so far above the last depth (MP7410 and its like)
constexpr double kFastFeed = 99999;        ///< FMAX in a parameter of a cycle

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

// --- definitions

void Klartext::define_cycle(const Statement& s) {
  Cursor at = cursor(s);
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
    error(s.begin, "not-supported",
          fmt::format("CYCL DEF {} ({}) is not supported; {}", *number, refused->what, refused->instead));
  const auto pass = [&] {
    cycle_ = {};
    cycle_.number = *number;
    cycle_.passed = true;
  };
  if (refused != kRefused.end()) return pass();
  if (*number < 200) return define_old_cycle(*number, part, at, s);

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
      parameters_.set(*name, kFastFeed);
    else if (at.accept_prefix("FAUTO") || at.accept("AUTO"))
      parameters_.set(*name, tool_feed_ ? mm_per_min_from_mm_per_s(*tool_feed_) / unit_mm() : 0);
    else if (at.accept_prefix("FU"))
      parameters_.set(*name, read_value(at, parameters_) * 60 * turns_per_s("FU"));
    else if (at.accept_prefix("FZ"))
      parameters_.set(*name, read_value(at, parameters_) * 60 * teeth() * turns_per_s("FZ"));
    else if (at.letters() == "PREDEF")
      throw FormulaError(at.offset(), "not-supported", "PREDEF (GLOBAL DEF) is not supported; a number was expected");
    else if (name->kind == 'S')
      parameters_.set_text(name->number, read_text_formula(at, parameters_));
    else
      parameters_.set(*name, read_formula(at, parameters_));
  }
  if (*number == 247) {
    const int preset = static_cast<int>(q_if_set(339).value_or(0));
    if (preset_ >= 0 && preset != preset_ && !preset_told_) {
      preset_told_ = true;
      warn(s.begin, "work-offsets",
           "the program uses more than one preset (CYCL DEF 247); their distance is not known, and all are treated as "
           "one "
           "frame");
    }
    preset_ = preset;
    return;
  }
  if (*number == 220 || *number == 221) return run_pattern(*number);
  if (*number >= 300) {
    return warn(
        s.begin, "machine-cycle",
        fmt::format("CYCL DEF {} is a cycle of the machine's maker; what it does is not known, and it is passed over",
                    *number));
  }
  if (std::ranges::find(kMade, *number) == kMade.end())
    return error(
        s.begin, "not-supported",
        fmt::format("CYCL DEF {} is not supported; 200 to 209, 240, 241 and 251 to 253 were expected", *number));
  cycle_ = {};
  cycle_.number = *number;
  cycle_.offset = s.begin;
}

/// Cycles in parts, CYCL DEF 7.1: each part has one value.
void Klartext::define_old_cycle(int number, int part, Cursor at, const Statement& s) {
  const bool in_parts = number == 7 || number == 8 || number == 10 || number == 11 || number == 26;
  if (in_parts && part <= 0) return;
  if (number == 7) return shift_datum(at, s.begin);
  if (number == 8) return set_mirror(at);
  if (number == 10) return set_rotation(at);
  if (number == 11) return set_scale(at);
  if (number == 26) return set_axis_scale(at);
  if (number == 19) return set_working_plane(at, part);
  if (number == 32) return set_tolerance(part, at);
  if (number == 13) {
    if (part > 0) add_event(EventKind::spindle_orient, 19);
    return;
  }
  if (number == 12) {
    if (part == 0) {
      cycle_ = {};
      cycle_.number = 12;
      cycle_.offset = s.begin;
      return;
    }
    at.accept("PGM");
    std::string_view text = file().source.text();
    at.more();
    text = text.substr(at.offset(), s.end - at.offset());
    text = text.substr(0, text.find_first_of(" ;\r\n"));
    selected_program_ = std::string(text);
    return;
  }
  if (number != 9 && std::ranges::find(kMade, number) == kMade.end())
    return error(s.begin, "not-supported",
                 fmt::format("CYCL DEF {} is not supported; cycles 1, 2, 4, 5, 7 to 13, 17, 19, 26, "
                             "32 or 200 to 209 were expected",
                             number),
                 fmt::format("cycle {}", number));
  if (part == 0) {
    if (number == 9) return;
    cycle_ = {};
    cycle_.number = number;
    cycle_.offset = s.begin;
    return;
  }
  // A word, a value, perhaps a feed: ZUSTLG 4 F100, V.ZEIT 0.5, X+145, F200 DR- RADIUS 16.
  std::optional<double> value, feed;
  while (at.more()) {
    const std::size_t begin = at.offset();
    const std::string word = at.letters();
    if (word == "RADIUS") {
      at.advance(word.size());
      cycle_.radius = known(read_value(at, parameters_), begin) * unit_mm();
      if (!value) value = cycle_.radius / unit_mm();
    } else if (word == "DR") {
      at.advance(word.size());
      cycle_.sense = at.peek() == '-' ? -1 : 1;
      at.advance();
    } else if (Cursor behind = at; word == "F" && (behind.advance(), begins_number(behind))) {
      at = behind;
      feed = known(read_value(at, parameters_), begin);
    } else if (Cursor ahead = at; word.starts_with('Q') && read_parameter(ahead)) {
      value = known(read_value(at, parameters_), begin);
    } else if (!word.empty()) {
      at.advance(word.size());
      if (at.behind(0) == '.') at.advance();
    } else if (begins_number(at)) {
      value = known(read_value(at, parameters_), begin);
    } else {
      at.advance();
    }
  }
  if (number == 9) {
    if (value && *value > 0) {
      Move& move = add_move(MoveKind::dwell, position_mm_);
      move.dwell_s = *value;
      move.editable = false;
    } else {
      error(s.begin, "dwell", "CYCL DEF 9 without a time; seconds were expected in CYCL DEF 9.1");
    }
    return;
  }
  if (cycle_.number != number) return;
  if (value) cycle_.values[part] = *value;
  if (feed) cycle_.feeds[part] = mm_per_s_from_mm_per_min(*feed * unit_mm());
}

/// CYCL DEF 32.1 T0.05, 32.2 HSC-MODE:1 TA0.5; 32.1 without a value: off.
void Klartext::set_tolerance(int part, Cursor at) {
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
    const double tolerance = known(read_value(at, parameters_), begin) * unit_mm();
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

// --- calls

double Klartext::q(int number) {
  const double value = parameters_.value({'Q', number}, cycle_.offset);
  return known(value, cycle_.offset);
}

std::optional<double> Klartext::q_if_set(int number) {
  try {
    return q(number);
  } catch (const FormulaError&) {
    return std::nullopt;
  }
}

/// mm/s; infinite: rapid.
double Klartext::feed_q(int number) {
  const double value = q(number);
  if (value >= 9999 * (inch_ ? 0.1 : 10)) return std::numeric_limits<double>::infinity();
  return mm_per_s_from_mm_per_min(value * unit_mm());
}

/// CYCL CALL, CYCL CALL PAT, CYCL CALL POS X Y Z F.
void Klartext::run_cycle_call(const Statement& s) {
  Cursor at = cursor(s);
  std::vector<BlockValues::Function> functions;
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
        if (const auto code = at.integer()) functions.push_back({*code, std::nullopt, begin});
      } else if (c == 'F') {
        BlockValues b;
        b.feed = known(read_value(at, parameters_), begin);
        set_feed(b);
      } else if (const char axis = c == 'I' ? at.peek() : c; place && axis >= 'X' && axis <= 'Z') {
        if (c == 'I') at.advance();
        double& value = (*place)[axis - 'X'];
        value = (c == 'I' ? value : 0) + known(read_value(at, parameters_), begin) * unit_mm();
        given = static_cast<std::uint8_t>(given | 1U << (axis - 'X'));
      } else {
        at.go_to(begin);
        throw FormulaError(begin, "not-a-word", fmt::format("{} in CYCL CALL; M or F was expected", at.word()));
      }
    }
    return given;
  };
  const auto with_functions = [&](const auto& body) {
    BlockValues b;
    b.functions = functions;
    functions_before(b);
    body();
    functions_after(b);
  };
  editable_ = false;
  if (at.accept("POS")) {
    Vec3 place = programmed();
    const std::uint8_t given = read_rest(&place);
    with_functions([&] {
      Vec3 over = programmed();
      const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
      over[axes.first] = place[axes.first];
      over[axes.second] = place[axes.second];
      if (place[axes.normal] > over[axes.normal]) {
        Vec3 up = programmed();
        up[axes.normal] = place[axes.normal];
        cycle_move(MoveKind::rapid, up, 0);
        over[axes.normal] = place[axes.normal];
      }
      cycle_move(MoveKind::rapid, over, 0);
      settle(given);
      cycle_move(MoveKind::rapid, place, 0);
      call_cycle(s.begin);
    });
    return;
  }
  if (at.accept("PAT")) {
    read_rest(nullptr);
    if (pattern_.empty())
      throw FormulaError(s.begin, "cycle", "CYCL CALL PAT without a pattern; PATTERN DEF was expected before");
    with_functions([&] {
      const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
      for (const Vec3& place : pattern_) {
        parameters_.set({'Q', 203}, place[axes.normal] / unit_mm());
        Vec3 over = programmed();
        over[axes.first] = place[axes.first];
        over[axes.second] = place[axes.second];
        cycle_move(MoveKind::rapid, over, 0);
        settle(static_cast<std::uint8_t>(1U << axes.first | 1U << axes.second));
        call_cycle(s.begin);
      }
    });
    return;
  }
  read_rest(nullptr);
  with_functions([&] { call_cycle(s.begin); });
}

void Klartext::call_cycle(std::size_t offset) {
  if (cycle_.number < 0) {
    error(offset, "cycle", "a cycle is called and none is defined; CYCL DEF was expected before");
    return;
  }
  if (cycle_.passed) return;
  if (radius_.active && radius_.radius_mm != 0) {
    error(offset, "cutter-radius", "a cycle under RL or RR; R0 was expected before");
    end_compensation();
  }
  const bool editable = std::exchange(editable_, false);
  cycle_.offset = offset;
  if (cycle_.number == 12)
    open_program(selected_program_, offset);
  else if (cycle_.number == 208)
    mill_bore();
  else if (cycle_.number == 262)
    mill_thread();
  else if (cycle_.number == 4 || cycle_.number == 5)
    mill_old_pocket();
  else if (cycle_.number >= 251 && cycle_.number <= 253)
    mill_pocket_cycle();
  else if (cycle_.is_old())
    drill_old();
  else
    drill(cycle_.number);
  cycle_g_ = 0;
  editable_ = editable;
}

void Klartext::cycle_move(MoveKind kind, const Vec3& programmed_end, double feed_mm_per_s, double dwell_s) {
  const Vec3 end = end_in_moves(programmed_end, 7);
  if (kind != MoveKind::dwell && end == position_mm_) return;
  if (++cycle_moves_ > kMaxCycleMoves)
    refuse("cycle", fmt::format("the cycles make more than {} moves; fewer pecks were expected", kMaxCycleMoves));
  const bool rapid = kind == MoveKind::linear && std::isinf(feed_mm_per_s);
  Move& move = add_move(rapid ? MoveKind::rapid : kind, end);
  move.canned = true;
  move.editable = false;
  move.cycle = static_cast<std::uint8_t>(cycle_g_);
  move.dwell_s = dwell_s;
  if (kind == MoveKind::linear && !rapid) move.feed_mm_per_s = feed_mm_per_s;
}

void Klartext::drill_hole(const Hole& h) {
  const int normal = tool_axis_;
  const double top = h.surface_mm + h.clearance_mm, bottom = h.surface_mm + h.depth_mm;
  const auto go = [&](MoveKind kind, double to, double feed) {
    Vec3 end = programmed();
    end[normal] = to;
    cycle_move(kind, end, feed);
  };
  const auto dwell = [&](double seconds) {
    if (seconds > 0) cycle_move(MoveKind::dwell, programmed(), 0, seconds);
  };
  if (h.depth_mm < 0 && place_[static_cast<std::size_t>(normal)] == Place::machine) {
    go(MoveKind::rapid, top, 0);  // from a machine coordinate; the height of the cycle is absolute
    settle(static_cast<std::uint8_t>(1U << normal));
  }
  prepare_cutting("a cycle", 0);
  if (h.depth_mm == 0) return;
  if (h.depth_mm > 0)
    refuse("cycle", fmt::format("the depth of cycle {} is positive ({}); a negative one was expected", cycle_.number,
                                h.depth_mm / unit_mm()));
  if (h.feed_mm_per_s <= 0)
    refuse("feed-missing", fmt::format("cycle {} has no feed; a feed greater than zero was expected", cycle_.number));
  go(MoveKind::rapid, top, 0);
  const double begin = h.start_mm < 0 ? h.surface_mm + h.start_mm : top;
  if (h.start_mm < 0) go(MoveKind::linear, begin + std::min(h.clearance_mm, top - begin), h.pre_feed_mm_per_s);
  double depth = h.start_mm < 0 ? h.surface_mm + h.start_mm : h.surface_mm;
  double peck = h.peck_mm > 0 ? h.peck_mm : depth - bottom;
  if ((depth - bottom) / std::max(1e-12, h.less_mm > 0 ? std::min(peck, std::max(h.least_mm, 1e-12)) : peck) >
      kMaxPecks)
    refuse("cycle", "the cycle would peck more than 100000 times; a larger Q202 was expected");
  int breaks = h.breaks;
  while (depth > bottom) {
    const double next = std::max(depth - peck, bottom);
    peck = h.less_mm > 0 ? std::max(peck - h.less_mm, std::max(h.least_mm, 1e-6)) : peck;
    go(MoveKind::linear, next, h.feed_mm_per_s);
    depth = next;
    if (depth <= bottom) break;
    if (breaks > 0) {
      --breaks;
      go(MoveKind::linear, depth + h.break_mm, std::numeric_limits<double>::infinity());
      continue;
    }
    breaks = h.breaks;
    go(MoveKind::rapid, top, 0);
    dwell(h.dwell_top_s);
    go(MoveKind::rapid, std::min(depth + h.above_mm, top), 0);
  }
  dwell(h.dwell_s);
  Vec3 off = Vec3::Zero();
  if (h.off_mm != Vec3::Zero()) {
    off = h.off_mm;
    cycle_move(MoveKind::rapid, programmed() + off, 0);
  }
  if (h.feed_out_mm_per_s)
    go(MoveKind::linear, top, *h.feed_out_mm_per_s);
  else
    go(MoveKind::rapid, top, 0);
  go(MoveKind::rapid, std::max(top, h.surface_mm + h.second_mm), 0);
  if (off != Vec3::Zero()) cycle_move(MoveKind::rapid, programmed() - off, 0);
}

/// Cycles 200 to 209, 240, 241 at the place of the tool.
void Klartext::drill(int number) {
  const double unit = unit_mm();
  Hole h;
  h.surface_mm = q_if_set(203).value_or(0) * unit;
  h.clearance_mm = q(200) * unit;
  h.second_mm = q_if_set(204).value_or(0) * unit;
  h.dwell_s = q_if_set(211).value_or(0);
  if (number != 240) h.depth_mm = number == 204 ? 0 : q(201) * unit;
  const auto tap = [&](double pitch) {
    const double rpm = state_.spindle_speed_rpm;
    if (rpm <= 0) refuse("spindle-speed", "tapping without a spindle speed; S was expected");
    cycle_g_ = pitch < 0 ? 74 : 84;
    h.feed_mm_per_s = std::abs(pitch) * unit * rpm / 60;
    h.feed_out_mm_per_s = h.feed_mm_per_s;
    h.dwell_s = 0;
  };
  if (number != 204 && number != 207 && number != 209) h.feed_mm_per_s = feed_q(206);
  // 201 and 202 must have it; of the others it is not known where it is negative.
  const double out = number == 201 || number == 202 || q_if_set(208) ? feed_q(208) : -1;
  switch (number) {
    case 200:
      h.peck_mm = q(202) * unit;
      h.above_mm = h.clearance_mm;
      h.dwell_top_s = q_if_set(210).value_or(0);
      cycle_g_ = h.peck_mm < -h.depth_mm ? 83 : h.dwell_s > 0 ? 82 : 81;
      break;
    case 201:
      h.feed_out_mm_per_s = out > 0 ? out : h.feed_mm_per_s;
      cycle_g_ = h.dwell_s > 0 ? 89 : 85;
      break;
    case 202: {
      h.feed_out_mm_per_s = out > 0 ? out : h.feed_mm_per_s;
      if (std::isinf(*h.feed_out_mm_per_s)) h.feed_out_mm_per_s.reset();
      const int direction = static_cast<int>(q_if_set(214).value_or(0));
      const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
      // 1: the tool leaves the wall towards minus of the first axis, 2: of the second, 3 and 4: towards plus.
      if (direction >= 1 && direction <= 4)
        h.off_mm[direction % 2 == 1 ? axes.first : axes.second] =
            direction <= 2 ? -kAboveLastDepthMm : kAboveLastDepthMm;
      cycle_g_ = 76;
      break;
    }
    case 203:
      h.above_mm = h.clearance_mm;
      h.peck_mm = q(202) * unit;
      h.less_mm = q_if_set(212).value_or(0) * unit;
      h.least_mm = q_if_set(205).value_or(0) * unit;
      h.breaks = static_cast<int>(q_if_set(213).value_or(0));
      h.break_mm = q_if_set(256).value_or(kAboveLastDepthMm) * unit;
      h.dwell_top_s = q_if_set(210).value_or(0);
      if (out > 0 && !std::isinf(out)) h.feed_out_mm_per_s = out;
      if (out == 0) h.feed_out_mm_per_s = h.feed_mm_per_s;
      cycle_g_ = h.peck_mm < -h.depth_mm ? (h.breaks > 0 ? 73 : 83) : 81;
      break;
    case 205:
      h.peck_mm = q(202) * unit;
      h.less_mm = q_if_set(212).value_or(0) * unit;
      h.least_mm = q_if_set(205).value_or(0) * unit;
      h.above_mm = q_if_set(258).value_or(kAboveLastDepthMm) * unit;
      h.start_mm = -std::abs(q_if_set(379).value_or(0) * unit);
      h.pre_feed_mm_per_s = q_if_set(253) ? feed_q(253) : h.feed_mm_per_s;
      h.break_mm = q_if_set(256).value_or(kAboveLastDepthMm) * unit;
      if (const auto every = q_if_set(257); every && *every > 0 && h.peck_mm > 0) {
        // Chip breaks every so much; the chip is cleared after each depth of Q202.
        h.breaks = std::max(0, static_cast<int>(std::ceil(h.peck_mm / (*every * unit) - 1e-9)) - 1);
        h.peck_mm = *every * unit;
      }
      cycle_g_ = h.breaks > 0 ? 73 : 83;
      break;
    case 206:
      h.feed_out_mm_per_s = h.feed_mm_per_s;
      cycle_g_ = 84;
      break;
    case 207:
    case 209:
      tap(q(239));
      if (const auto every = q_if_set(257); number == 209 && every && *every > 0) {
        h.peck_mm = *every * unit;
        h.break_mm = q_if_set(256).value_or(0) * unit;
        h.breaks = h.break_mm > 0 ? 1'000'000 : 0;
      }
      break;
    case 240:
      if (q_if_set(343).value_or(0) == 1) {
        // By the diameter of the cone: the point angle is in the tool table; 90 degrees are taken.
        h.depth_mm = -0.5 * std::abs(q(344)) * unit;
        warn(cycle_.offset, "point-angle",
             "cycle 240 by its diameter needs the point angle of the tool table; 90 degrees are assumed");
      } else {
        h.depth_mm = q(201) * unit;
      }
      cycle_g_ = 82;
      break;
    case 241:
      h.start_mm = -std::abs(q_if_set(379).value_or(0) * unit);
      h.pre_feed_mm_per_s = q_if_set(253) ? feed_q(253) : h.feed_mm_per_s;
      if (out > 0 && !std::isinf(out)) h.feed_out_mm_per_s = out;
      cycle_g_ = h.dwell_s > 0 ? 82 : 81;
      break;
    default:  // 204
      return bore_back();
  }
  drill_hole(h);
}

/// Cycle 204: a counterbore from below.
void Klartext::bore_back() {
  const double unit = unit_mm();
  const double surface = q_if_set(203).value_or(0) * unit, clearance = q(200) * unit;
  const double depth = q(249) * unit, thickness = q(250) * unit, off = q(251) * unit, edge = q(252) * unit;
  const double feed = feed_q(254), pre_feed = feed_q(253), dwell = q_if_set(255).value_or(0);
  const int direction = static_cast<int>(q_if_set(214).value_or(1));
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  Vec3 shift = Vec3::Zero();
  if (direction >= 1 && direction <= 4)
    shift[direction % 2 == 1 ? axes.first : axes.second] = direction <= 2 ? -off : off;
  if (feed <= 0) refuse("feed-missing", "cycle 204 has no feed; Q254 greater than zero was expected");
  cycle_g_ = 87;
  prepare_cutting("a cycle", 0);
  const auto go = [&](double height, double at_feed) {
    Vec3 end = programmed();
    end[tool_axis_] = height;
    cycle_move(MoveKind::linear, end, at_feed);
  };
  constexpr double kRapid = std::numeric_limits<double>::infinity();
  const Vec3 centre = programmed();
  go(surface + clearance, kRapid);
  cycle_move(MoveKind::rapid, programmed() + shift, 0);
  go(surface - thickness - edge - clearance, pre_feed);
  cycle_move(MoveKind::linear, programmed() - shift, pre_feed);
  go(surface - thickness - edge + depth, feed);
  if (dwell > 0) cycle_move(MoveKind::dwell, programmed(), 0, dwell);
  go(surface - thickness - edge - clearance, pre_feed);
  cycle_move(MoveKind::linear, programmed() + shift, pre_feed);
  go(surface + std::max(clearance, q_if_set(204).value_or(0) * unit), kRapid);
  Vec3 back = centre;
  back[tool_axis_] = programmed()[tool_axis_];
  cycle_move(MoveKind::rapid, back, 0);
}

/// The value of CYCL DEF 1.2 and the like.
double Klartext::old_value(int part) const {
  if (const auto found = cycle_.values.find(part); found != cycle_.values.end()) return found->second;
  refuse("cycle", fmt::format("cycle {0} without its part {0}.{1}", cycle_.number, part));
}

/// Cycles 1, 2 and 17: the tool stands at the clearance above the surface.
void Klartext::drill_old() {
  const double unit = unit_mm();
  const auto value = [&](int part) { return old_value(part); };
  Hole h;
  h.clearance_mm = std::abs(value(1)) * unit;
  h.surface_mm = programmed()[tool_axis_] - h.clearance_mm;
  h.depth_mm = value(2) * unit;
  const auto feed = [&](int part) {
    const auto found = cycle_.feeds.find(part);
    return found != cycle_.feeds.end() ? found->second : feed_.value_or(0);
  };
  if (cycle_.number == 1) {
    h.peck_mm = std::abs(value(3)) * unit;
    h.above_mm = std::clamp(-h.depth_mm / 50, 0.6, 7.0);  // t of the manuals
    h.dwell_s = cycle_.values.contains(4) ? value(4) : 0;
    h.feed_mm_per_s = feed(5);
    cycle_g_ = h.peck_mm < -h.depth_mm ? 83 : 81;
  } else if (cycle_.number == 2) {
    h.dwell_s = cycle_.values.contains(3) ? value(3) : 0;
    h.feed_mm_per_s = feed(4);
    h.feed_out_mm_per_s = h.feed_mm_per_s;
    cycle_g_ = 84;
  } else {
    const double pitch = value(3) * unit, rpm = state_.spindle_speed_rpm;
    if (rpm <= 0) refuse("spindle-speed", "tapping without a spindle speed; S was expected");
    h.feed_mm_per_s = std::abs(pitch) * rpm / 60;
    h.feed_out_mm_per_s = h.feed_mm_per_s;
    cycle_g_ = pitch < 0 ? 74 : 84;
  }
  drill_hole(h);
}

/// A circle or helix about `centre` from where the tool stands.
void Klartext::cycle_circle(const Vec3& centre, double sweep_rad, double end_height_mm, double feed_mm_per_s) {
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  const Vec3 start = programmed();
  Arc arc;
  arc.normal = normal_of(plane_of_axis(tool_axis_));
  arc.center_mm = centre;
  arc.center_mm[axes.normal] = start[axes.normal];
  arc.sweep_rad = sweep_rad;
  const double x = start[axes.first] - centre[axes.first], y = start[axes.second] - centre[axes.second];
  Vec3 end = start;
  const double turn = std::fmod(sweep_rad, 2 * kPi);
  if (std::abs(turn) > 1e-12) {
    end[axes.first] = centre[axes.first] + std::cos(turn) * x - std::sin(turn) * y;
    end[axes.second] = centre[axes.second] + std::sin(turn) * x + std::cos(turn) * y;
  }
  end[axes.normal] = end_height_mm;
  const auto in_moves = frame_.plain ? std::optional(arc) : from_program(frame_, arc);
  if (!in_moves) refuse("scaling", "a circle of a cycle under a scale of single axes is an ellipse");
  out_.arcs.push_back(*in_moves);
  Move& move = add_move(MoveKind::arc, end_in_moves(end, 7));
  move.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
  move.canned = true;
  move.editable = false;
  move.feed_mm_per_s = feed_mm_per_s;
  ++cycle_moves_;
}

/// Cycle 208: a helix down to the depth, a full circle, back to the middle.
void Klartext::mill_bore() {
  const double unit = unit_mm();
  const double surface = q_if_set(203).value_or(0) * unit, top = surface + q(200) * unit,
               bottom = surface + q(201) * unit;
  const double feed = feed_q(206), pitch = std::abs(q(334)) * unit, diameter = q(335) * unit;
  const bool climb = q_if_set(351).value_or(1) >= 0;
  const double high = std::max(top, surface + q_if_set(204).value_or(0) * unit);
  const auto tool = cutter_radius_mm();
  if (feed <= 0 || std::isinf(feed))
    refuse("feed-missing", "cycle 208 has no feed; Q206 greater than zero was expected");
  if (bottom >= top) refuse("cycle", "the depth of cycle 208 is positive; a negative one was expected");
  prepare_cutting("a cycle", 0);
  if (!tool)
    warn(cycle_.offset, "radius-unknown",
         fmt::format(
             "cycle 208 needs the radius of tool {}, which nothing gives (TOOL DEF with R); its helix is read as a "
             "plunge at its middle",
             state_.tool),
         "cycle 208");
  const double radius = tool ? 0.5 * diameter - *tool : 0;
  if (tool && radius < 0)
    refuse("cutter-too-large",
           fmt::format("the hole of cycle 208 ({:.4f} mm) is smaller than the tool ({:.4f} mm)", diameter, 2 * *tool));
  const Vec3 middle = programmed();
  const auto go = [&](MoveKind kind, double height) {
    Vec3 end = programmed();
    end[tool_axis_] = height;
    cycle_move(kind, end, feed);
  };
  go(MoveKind::rapid, top);
  if (radius > 1e-6) {
    Vec3 beside = programmed();
    beside[axes_of(plane_of_axis(tool_axis_)).first] += radius;
    cycle_move(MoveKind::linear, beside, feed);
    const double turns = pitch > 0 ? (top - bottom) / pitch : 1;
    if (turns > kMaxPecks) refuse("cycle", "cycle 208 would make more than 100000 turns; a larger Q334 was expected");
    const double sense = climb ? 1 : -1;
    cycle_circle(middle, sense * 2 * kPi * turns, bottom, feed);
    cycle_circle(middle, sense * 2 * kPi, bottom, feed);
    Vec3 back = middle;
    back[tool_axis_] = bottom;
    cycle_move(MoveKind::linear, back, feed);
  } else {
    go(MoveKind::linear, bottom);
  }
  go(MoveKind::rapid, high);
}

/// Cycle 262: an inside thread by helices, with semicircles in and out. Q355: 0 one turn at the depth, 1 the whole
/// length at once, else single turns so many pitches apart.
void Klartext::mill_thread() {
  const double unit = unit_mm(), surface = q_if_set(203).value_or(0) * unit, top = surface + std::abs(q(200)) * unit;
  const double depth = -q(201) * unit, pitch = std::abs(q(239)) * unit,
               apart = std::max(0.0, q_if_set(355).value_or(0));
  const double feed = feed_q(207), down = q_if_set(253) ? feed_q(253) : feed;
  if (!(feed > 0) || std::isinf(feed) || !(down > 0))
    refuse("feed-missing", "cycle 262 has no feed; Q207 greater than zero was expected");
  if (!(depth > 0) || !(pitch > 0) || depth / pitch > kMaxPecks)
    refuse("cycle", "cycle 262 needs a negative depth Q201 and a pitch Q239");
  prepare_cutting("a cycle", 0);
  const double tool = cutter_radius_mm().value_or(0), radius = 0.5 * q(335) * unit - tool;
  if (tool == 0)
    warn(cycle_.offset, "radius-unknown", fmt::format("no radius is given for tool {}; cycle 262 takes 0", state_.tool),
         "cycle 262");
  if (!(radius > 0))
    refuse("cutter-too-large", fmt::format("the thread of cycle 262 ({:.4f} mm) is smaller than the tool ({:.4f} mm)",
                                           q(335) * unit, 2 * tool));
  warn(cycle_.offset, "cycle", "the ways in and out of cycle 262 are taken as semicircles; the control's are helices",
       "cycle 262 ways");
  const bool clockwise_spindle = state_.spindle != SpindleDirection::counter_clockwise;
  const double sense = (q_if_set(351).value_or(1) >= 0) == clockwise_spindle ? 1 : -1;
  const bool up = (q(239) > 0) == (sense > 0);
  const double length = apart == 1 ? depth : pitch, count = apart > 1 ? std::ceil(depth / (apart * pitch) - 1e-9) : 1;
  const Vec3 middle = programmed();
  const int first = axes_of(plane_of_axis(tool_axis_)).first;
  const auto at = [&](double beside, double height) {
    Vec3 p = middle;
    p[first] += beside;
    p[tool_axis_] = height;
    return p;
  };
  cycle_move(MoveKind::rapid, at(0, top), 0);
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double low = surface - depth + (up ? i : count - 1 - i) * apart * pitch;
    const double from = up ? low : low + length, to = up ? low + length : low;
    cycle_move(MoveKind::linear, at(0, from), down);
    cycle_circle(at(radius / 2, from), sense * kPi, from, feed);
    cycle_circle(middle, sense * 2 * kPi * length / pitch, to, feed);
    cycle_circle(0.5 * (at(0, to) + programmed()), sense * kPi, to, feed);
  }
  cycle_move(MoveKind::rapid, at(0, std::max(top, surface + q_if_set(204).value_or(0) * unit)), 0);
}

// --- pockets: cycles 4, 5 and 251 to 253

PocketMoves Klartext::pocket_moves() {
  return {[this](const Vec3& end, double feed) { cycle_move(MoveKind::linear, end, feed); },
          [this](const Vec3& centre, double sweep, double feed) {
            cycle_circle(centre, sweep, programmed()[tool_axis_], feed);
          }};
}

/// Radius of the cutter; without it there is no pocket.
double Klartext::pocket_cutter_mm() const {
  if (const auto tool = cutter_radius_mm(); tool && *tool > 0) return *tool;
  refuse("radius-unknown",
         fmt::format("cycle {} (pocket milling) needs the radius of tool {}, which nothing gives; TOOL DEF {} "
                     "with R, or the finished path, was expected",
                     cycle_.number, state_.tool, state_.tool));
}

/// Cycles 4 and 5: a pocket from its middle outwards, in depths. The tool stands at the clearance above the middle.
void Klartext::mill_old_pocket() {
  const double unit = unit_mm();
  const bool round = cycle_.number == 5;
  const double tool = pocket_cutter_mm();
  const auto value = [&](int part) { return old_value(part) * unit; };
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  const double clearance = std::abs(value(1)), depth = std::abs(value(2)), step = std::abs(value(3));
  const double plunge = cycle_.feeds.contains(3) ? cycle_.feeds[3] : feed_.value_or(0);
  const int feed_part = round ? 5 : 6;
  const double feed = cycle_.feeds.contains(feed_part) ? cycle_.feeds[feed_part] : feed_.value_or(0);
  if (plunge <= 0 || feed <= 0) refuse("feed-missing", "the pocket has no feed; F was expected in its parts");
  if (step <= 0) refuse("cycle", "the pocket has no depth of each cut; its part 3 was expected");
  PocketCycle pocket;
  pocket.round = round;
  pocket.half_mm[0] = round ? value(4) - tool : 0.5 * std::abs(value(4)) - tool;
  pocket.half_mm[1] = round ? pocket.half_mm[0] : 0.5 * std::abs(value(5)) - tool;
  if (pocket.least_mm() < -1e-9 || pocket.half_mm[1] < -1e-9)
    refuse("cutter-too-large", "the pocket is smaller than the tool");
  constexpr double kOverlap = 1.4;  // of the radius: MP7430
  pocket.sideways_mm = kOverlap * tool;
  pocket.sense = cycle_.sense;
  pocket.feed_mm_per_s = feed;
  pocket.middle_mm = programmed();
  const Vec3 middle = pocket.middle_mm;
  const double surface = middle[axes.normal] - clearance;
  prepare_cutting("a cycle", 0);
  for (double z = surface; z > surface - depth + 1e-9;) {
    z = std::max(z - step, surface - depth);
    Vec3 floor = middle;
    floor[axes.normal] = z;
    cycle_move(MoveKind::linear, floor, plunge);
    if (!mill_pocket_level(pocket, axes, z, pocket.least_mm(), 0, pocket_moves())) return too_many_cuts();
    cycle_move(MoveKind::linear, floor, feed);
  }
  cycle_move(MoveKind::rapid, middle, 0);
}

void Klartext::refuse(const char* check, const std::string& message) const {
  throw FormulaError(cycle_.offset, check, message);
}

void Klartext::too_many_cuts() const {
  refuse("cycle",
         fmt::format("cycle {} would take more than 100000 rings or depths; larger ones were expected", cycle_.number));
}

/// Cycles 251 to 253.
void Klartext::mill_pocket_cycle() {
  const double unit = unit_mm();
  const int number = cycle_.number;
  const double tool = pocket_cutter_mm();
  PocketCycle pocket;
  pocket.round = number == 252;
  pocket.side_mm = q_if_set(368).value_or(0) * unit;
  pocket.floor_mm = q_if_set(369).value_or(0) * unit;
  pocket.surface_mm = q_if_set(203).value_or(0) * unit;
  pocket.bottom_mm = pocket.surface_mm + q(201) * unit;
  pocket.clearance_mm = pocket.surface_mm + std::abs(q(200)) * unit;
  pocket.step_mm = std::abs(q(202)) * unit;
  pocket.plunge_mm_per_s = feed_q(206);
  pocket.finishing_step_mm = std::abs(q_if_set(338).value_or(0)) * unit;
  const int operation = static_cast<int>(q_if_set(215).value_or(0));
  pocket.roughs = operation != 2;
  pocket.finishes = operation != 1;
  const bool slot = number == 253;
  const double overlap = slot ? 1 : q_if_set(370).value_or(1);
  pocket.feed_mm_per_s = feed_q(207);
  pocket.finishing_mm_per_s = q_if_set(385) ? feed_q(385) : pocket.feed_mm_per_s;
  if (pocket.feed_mm_per_s <= 0 || pocket.plunge_mm_per_s <= 0 || pocket.finishing_mm_per_s <= 0 ||
      std::isinf(pocket.feed_mm_per_s))
    refuse("feed-missing", fmt::format("cycle {} has no feed; Q206 and Q207 greater than zero were expected", number));
  if (pocket.bottom_mm >= pocket.surface_mm || pocket.step_mm <= 0)
    refuse("cycle", fmt::format("cycle {} needs a negative depth Q201 and a depth of each cut Q202", number));
  if (!(overlap > 0 && overlap < 2))
    refuse("cycle", fmt::format("an overlap Q370 of {:g}; greater than 0 and less than 2 was expected", overlap));
  const double whole_x = (pocket.round ? q(223) : q(218)) * unit, whole_y = (pocket.round ? q(223) : q(219)) * unit;
  pocket.half_mm[0] = 0.5 * std::abs(whole_x) - tool;
  pocket.half_mm[1] = 0.5 * std::abs(whole_y) - tool;
  if (pocket.least_mm() - pocket.side_mm < -1e-9)
    refuse("cutter-too-large",
           fmt::format("the pocket of cycle {} is smaller than the tool of {:.4f} mm and its allowance", number,
                       2 * tool));
  if (!pocket.round) {
    pocket.corner_mm = slot ? pocket.half_mm[1] : std::max(0.0, std::abs(q_if_set(220).value_or(0)) * unit - tool);
    pocket.angle_rad = rad_from_deg(q_if_set(slot ? 374 : 224).value_or(0));
  }
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  pocket.middle_mm = programmed();
  if (const int place = static_cast<int>(q_if_set(367).value_or(0)); place > 0 && !pocket.round) {
    // The tool stands at a corner: 1 lower left, 2 lower right, 3 upper right, 4 upper left. Of a slot: 1 left end, 2
    // and 3 centres of its left and right arc, 4 right end.
    const bool left = slot ? place <= 2 : place == 1 || place == 4, at_arc = slot && (place == 2 || place == 3);
    const double x = (left ? 0.5 : -0.5) * (std::abs(whole_x) - (at_arc ? std::abs(whole_y) : 0)),
                 y = slot ? 0 : (place <= 2 ? 0.5 : -0.5) * std::abs(whole_y);
    const double c = std::cos(pocket.angle_rad), s = std::sin(pocket.angle_rad);
    pocket.middle_mm[axes.first] += c * x - s * y;
    pocket.middle_mm[axes.second] += s * x + c * y;
  }
  // Climb cutting inside goes round counter-clockwise where the spindle turns clockwise.
  const bool climb = q_if_set(351).value_or(1) >= 0;
  pocket.sense = climb == (state_.spindle != SpindleDirection::counter_clockwise) ? 1 : -1;
  pocket.sideways_mm = overlap * tool;
  prepare_cutting("a cycle", 0);
  if (q_if_set(366).value_or(0) != 0 && operation != 2)
    warn(cycle_.offset, "cycle",
         fmt::format("the plunge of cycle {} along a helix or to and fro (Q366) takes ANGLE of the tool table; it is "
                     "read as a vertical one",
                     number),
         "Q366");
  if (!mill_pocket(pocket, axes, programmed(), pocket_moves())) return too_many_cuts();
  Vec3 high = programmed();
  high[axes.normal] = std::max(pocket.clearance_mm, pocket.surface_mm + q_if_set(204).value_or(0) * unit);
  cycle_move(MoveKind::rapid, high, 0);
}

// --- patterns

/// Cycles 220 (circle) and 221 (rows): the last cycle at each place, at once.
void Klartext::run_pattern(int number) {
  cycle_.offset = statement_->begin;
  if (cycle_.number < 0)
    return error(statement_->begin, "cycle",
                 fmt::format("cycle {} repeats a cycle and none is defined; CYCL DEF was expected before", number));
  const double unit = unit_mm();
  const double surface = q_if_set(203).value_or(0) * unit, clearance = q(200) * unit;
  const double second = q_if_set(204).value_or(0) * unit;
  const bool high = q_if_set(301).value_or(1) != 0;
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  std::vector<Vec2> places;
  const auto count_of = [&](int parameter) {
    const double count = q(parameter);
    if (count < 1 || count > 100000)
      throw FormulaError(statement_->begin, "cycle",
                         fmt::format("Q{} is {}; a number of holes was expected", parameter, count));
    return static_cast<int>(std::lround(count));
  };
  if (number == 220) {
    const Vec2 middle(q(216) * unit, q(217) * unit);
    const int count = count_of(241);
    const double radius = 0.5 * q(244) * unit, first = q(245), last = q_if_set(246).value_or(360);
    double angle = q_if_set(247).value_or(0);
    if (angle == 0) {
      const double all = last - first;
      const bool whole = std::abs(std::abs(all) - 360) < 1e-9;
      angle = count > 1 ? all / (whole ? count : count - 1) : 0;
    }
    for (int i = 0; i < count; ++i) places.push_back(middle + radius * direction_at_deg(first + i * angle));
  } else {
    const Vec2 start(q(225) * unit, q(226) * unit);
    const double dx = q(237) * unit, dy = q(238) * unit;
    const Vec2 along = direction_at_deg(q_if_set(224).value_or(0));
    const int columns = count_of(242), rows = count_of(243);
    for (int row = 0; row < rows; ++row)
      for (int i = 0; i < columns; ++i) {
        const int column = row % 2 == 0 ? i : columns - 1 - i;
        const Vec2 p(column * dx, row * dy);
        places.push_back(start + Vec2(along.x() * p.x() - along.y() * p.y(), along.y() * p.x() + along.x() * p.y()));
      }
  }
  const bool editable = std::exchange(editable_, false);
  const double above = surface + std::max(clearance, second), low = surface + clearance;
  bool first = true;
  for (const Vec2& place : places) {
    Vec3 up = programmed();
    up[axes.normal] = first ? std::max(up[axes.normal], above) : high ? above : low;
    cycle_move(MoveKind::rapid, up, 0);
    Vec3 over = up;
    over[axes.first] = place.x();
    over[axes.second] = place.y();
    cycle_move(MoveKind::rapid, over, 0);
    settle(7);
    Vec3 down = over;
    down[axes.normal] = low;
    cycle_move(MoveKind::rapid, down, 0);
    call_cycle(statement_->begin);
    first = false;
  }
  editable_ = editable;
}

/// PATTERN DEF POS1 (X+25 Y+33 Z+0) ROW1 (...) PAT1 (...) FRAME1 (...) CIRC1 (...) PITCHCIRC1 (...).
void Klartext::define_pattern(const Statement& s) {
  Cursor at = cursor(s);
  at.accept("DEF");
  pattern_.clear();
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
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
      const double value = known(read_value(at, parameters_), here);
      if (step && pattern_.empty())
        throw FormulaError(here, "cycle",
                           fmt::format("{} in the first place of PATTERN DEF; X and Y were expected", word));
      if (step)
        values[word.substr(1)] = value + pattern_.back()[word == "IX" ? axes.first : axes.second] / unit_mm();
      else
        values[word] = value;
    }
    if (!at.accept(')')) throw FormulaError(begin, "cycle", "the bracket ( of PATTERN DEF is not closed");
    const auto value = [&](const char* name) {
      const auto found = values.find(name);
      return found == values.end() ? 0.0 : found->second;
    };
    const double unit = unit_mm();
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
