#include "nc/siemens/block_runner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc::siemens {
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

BlockRunner::BlockRunner(const Program& program, const InterpreterOptions& options, Reporter& report,
                         Interpretation& out)
    : at_{program, options, report, out} {}

void BlockRunner::begin(const BlockPlace& place) {
  at_.place = place;
  at_.program = place.file;
  at_.editable = place.editable;
  at_.request = {};
  at_.words.clear(at_.program->offset_of(place.block));
}

void BlockRunner::add_plain(std::span<const Word> words) {
  for (const Word& w : words) {
    if (w.letter == 'N') continue;
    if (w.letter == 'G' || w.letter == 'M') {
      const int number =
          w.value >= 0 && w.value < 1e6 && w.value == std::floor(w.value) ? static_cast<int>(w.value) : -1;
      (w.letter == 'G' ? at_.words.g : at_.words.m).push_back({number, w.offset, modes_.main_spindle(), w.value});
      continue;
    }
    Slot& slot = w.letter == 'R' ? at_.words.set(Extra::cr) : at_.words.set(w.letter);
    if (slot.given)
      at_.error(
          w.offset, "word-twice",
          fmt::format("{} twice in one block; once was expected", w.letter == 'R' ? "CR" : std::string(1, w.letter)));
    slot = {true, false, Dimension::as_modal, w.value, w.offset};
  }
}

void BlockRunner::set_command(const WordRow& row, std::uint32_t offset) {
  switch (row.does) {
    case Does::noted:
      at_.report.warning(offset, "no-effect", fmt::format("{} ({}) is read without effect", row.name, row.what),
                         row.name);
      return;
    case Does::refused:
      at_.error(
          offset, "not-supported",
          fmt::format("{} ({}) is not supported; what can stand in its place: {}", row.name, row.what, row.instead),
          row.name);
      return;
    case Does::supa:
      at_.request.machine_frame = true;
      return;
    case Does::cip:
    case Does::ct:
      at_.motion = row.does == Does::cip ? Motion::through_point : Motion::tangential;
      at_.request.motion_given = true;
      at_.request.motion_offset = offset;
      return;
    case Does::frame:
      if (at_.request.frame)
        at_.error(offset, "modal-group",
                  fmt::format("{} and {} in one block; one of them was expected", at_.request.frame->name, row.name));
      at_.request.frame = &row;
      at_.request.frame_offset = offset;
      return;
    case Does::transform_on:
    case Does::transform_off:
      return row.does == Does::transform_on ? mover_.set_tip_control(TipControl::angles, "TRAORI", offset)
                                            : mover_.set_tip_control(TipControl::off, "TRAFOOF", offset);
    case Does::mode_word:
      return contouring_.set_mode_word(row.name);
    case Does::contour_mode:
    case Does::contour_mode_off:
      return contouring_.set_compressor(row);
    case Does::home:  // a place of the machine's own that the program does not give
      at_.report.warning(offset, "machine-place",
                         fmt::format("{} ({}) moves the axes to a place that the program does not give; where the tool "
                                     "is afterwards is not known",
                                     row.name, row.what),
                         row.name);
      return mover_.set_places(AxisPlace::reference);
    default:
      return;
  }
}

bool BlockRunner::execute(bool& ends_subprogram) {
  ends_subprogram = false;
  moved_ = false;
  if (at_.words.empty() && !at_.request.frame && !at_.request.machine_frame && !at_.request.motion_given) return true;
  const bool changes_tool = std::ranges::find(at_.words.m, 6, &CodeWord::number) != at_.words.m.end();
  if (!changes_tool) tools_.read_edge();
  read_g_codes();
  if (at_.words.has(Extra::adis))
    contouring_.set_rounding_distance(std::max(0.0, at_.words.of(Extra::adis).value * unit_mm()));
  if (!at_.request.dwell && !at_.request.limits) {
    modes_.read_feed();
    modes_.read_spindle_speed();
  }
  tools_.read_tool();
  read_m_codes_before();
  if (changes_tool) tools_.read_edge();
  check_letters();
  modes_.note_dimensions();
  mover_.read_rotary_words();
  const std::size_t moves_before = at_.out.moves.size();
  const std::optional<double> modal_feed = modes_.feed();
  if (at_.request.block_feed) modes_.set_feed(modes_.internal_feed(*at_.request.block_feed));
  if (at_.request.frame)
    frames_.run_command();
  else if (at_.request.shift != 0)
    frames_.set_programmable_shift();
  else if (at_.request.limits)
    ;  // the words are limits
  else if (at_.request.dwell)
    path_.dwell();
  else if (at_.request.pole != 0)
    path_.set_pole();
  else if (at_.request.fixed_point)
    path_.go_to_fixed_point();
  else if (at_.request.machine_frame)
    path_.go_in_machine_frame();
  else
    path_.move();
  if (at_.request.block_feed) modes_.set_feed(modal_feed);
  corners_.make(moves_before);
  corners_.read(moves_before);
  for (std::size_t i = moves_before; i < at_.out.moves.size(); ++i) moved_ |= at_.out.moves[i].kind != MoveKind::dwell;
  return read_m_codes_after(ends_subprogram);
}

/// Machine coordinates by a variable of the machine's maker (_Z_HOME), which the program does not declare.
void BlockRunner::leave_for_machine_place(char axis, const std::string& name, std::uint32_t offset) {
  at_.report.warning(offset, "machine-place",
                     fmt::format("{} goes to {}, a variable that the program does not declare; where it is afterwards "
                                 "is not known",
                                 axis, name),
                     name);
  mover_.set_place(axis - 'X', AxisPlace::reference);
}

void BlockRunner::set_number(const WordRow& row, double value) {
  if (row.does == Does::modal_rounding) corners_.set_modal_rounding(value * unit_mm());
  if (row.does == Does::contour_tolerance) contouring_.set_tolerance(value);
  if (row.does == Does::offset_normal) radius_.set_offset_normal(value * unit_mm());
  if (row.does == Does::block_feed) at_.request.block_feed = value;
  if (row.does != Does::corner_feed) return;
  if (row.name == "FRCM")
    corners_.set_modal_feed(value);
  else
    at_.request.corner_feed = value;
}

void BlockRunner::position_axis(char letter, const Slot& slot) {
  at_.words.set(letter) = slot;
  at_.request.positioned |= 1U << static_cast<unsigned>(letter - 'A');
  at_.editable = false;
}

void BlockRunner::set_frame_variable(const std::string& name, const std::vector<double>& indexes,
                                     const std::vector<std::string>& index_names, const Value& value,
                                     std::uint32_t offset) {
  if ((name != "$TC_DP6" && name != "$TC_DP3") || value.text)
    return frames_.set_variable(name, indexes, index_names, value, offset);
  const int tool = indexes.empty() ? -1 : static_cast<int>(std::min(std::max(indexes[0], 0.0), 1e8));
  tools_.set_offset(tool, name == "$TC_DP6", value.number * unit_mm());
}

void BlockRunner::read_g_codes() {
  for (std::size_t i = 1; i < at_.words.g.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const int g = at_.words.g[i].number, other = at_.words.g[k].number;
      if (g != other && modal_group(g) != 0 && modal_group(g) == modal_group(other))
        at_.error(at_.words.g[i].offset, "modal-group",
                  fmt::format("G{} and G{} in one block; one of them was expected", other, g));
    }
  // Those that others depend on first: units and dimensions.
  for (const CodeWord& code : at_.words.g) {
    const int g = code.number;
    if (g == 70 || g == 71 || g == 700 || g == 710 || g == 20 || g == 21) {
      modes_.set_unit(g == 70 || g == 700 || g == 20);
      if (g == 20 || g == 21)
        at_.report.warning(code.offset, "iso-word",
                           fmt::format("G{} is no word of a Sinumerik program outside ISO mode; it is read as G{}", g,
                                       g == 20 ? 700 : 710),
                           "G20");
      if (g == 70 && !at_.options.inch)
        at_.report.warning(
            code.offset, "feed-unit",
            "F under G70 counts in the basic unit of the control, which is not known; inch per minute is "
            "assumed (G700 says it)",
            "G70");
    } else if (g == 90 || g == 91) {
      at_.absolute = g == 90;
    } else if (g >= 17 && g <= 19) {
      const Plane wanted = g == 17 ? Plane::xy : g == 18 ? Plane::zx : Plane::yz;
      if (wanted != at_.plane) at_.refuse_under_radius(code.offset, fmt::format("G{}", g));
      modes_.set_plane(wanted);
    }
  }
  for (const CodeWord& code : at_.words.g) read_g_code(code);
}

void BlockRunner::read_g_code(const CodeWord& code) {
  const int g = code.number;
  const auto set_motion = [&](Motion motion) {
    at_.motion = motion;
    at_.request.motion_given = true;
    at_.request.motion_offset = code.offset;
  };
  // Units, planes and dimensions were read before; the others change no move. DISC: corners are arcs.
  constexpr std::array kPassed{17,  18,  19,  20,  21,  62,  70,  71,  90,  91,  97,  140, 141, 142, 143,
                               290, 340, 341, 450, 451, 460, 461, 462, 621, 700, 710, 971, 972, 973};
  const auto is = [g](std::initializer_list<int> codes) { return std::ranges::find(codes, g) != codes.end(); };
  if (is({96, 961, 962})) return modes_.begin_cutting_speed(code);
  if (is({97, 971, 972, 973})) modes_.end_cutting_speed();
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
      return at_.error(code.offset, "not-supported",
                       fmt::format("G{} ({}) is not supported; {} was expected", g, r.what, r.instead),
                       fmt::format("G{}", g));
  if (g >= 810 && g <= 829)
    return at_.report.warning(code.offset, "no-effect",
                              fmt::format("G{} of the machine's maker is read without effect", g),
                              fmt::format("G{}", g));
  if (g >= 0 && g <= 3) return set_motion(static_cast<Motion>(g));
  if (is({60, 64, 641, 642, 643, 644, 645, 646})) return contouring_.set_blending(g);
  if (is({601, 602, 603})) return contouring_.set_mode_word(fmt::format("G{}", g));
  if (is({94, 942})) return modes_.set_feed_mode(FeedMode::per_minute);
  if (is({95, 952})) return modes_.set_feed_mode(FeedMode::per_revolution);
  if (g == 93) return modes_.set_feed_mode(FeedMode::inverse_time);
  if (is({41, 42})) return radius_.begin(code);
  if (g == 40) return radius_.end();
  if (is({63, 331, 332}))
    return set_motion(g == 63 ? Motion::linear : g == 331 ? Motion::tapping_in : Motion::tapping_out);
  at_.request.dwell |= g == 4;
  at_.request.exact_stop |= g == 9;
  at_.request.limits |= is({25, 26});
  at_.request.machine_frame |= is({53, 153});
  at_.request.fixed_point |= is({74, 75});
  if (is({110, 111, 112})) at_.request.pole = g;
  if (is({4, 9, 25, 26, 53, 153, 74, 75, 110, 111, 112})) return;
  if (is({43, 44, 49, 80})) {
    at_.words.set('H').given = false;
    return at_.report.warning(code.offset, "iso-word",
                              fmt::format("G{} is no word of a Sinumerik program outside ISO mode; it is read without "
                                          "effect (tool lengths come with D)",
                                          g),
                              fmt::format("G{}", g));
  }
  if (is({58, 59})) {
    // With coordinates a programmable shift, else the work offset that an 828D has under this number.
    const bool moves =
        std::ranges::any_of(at_.words.g, [](const CodeWord& c) { return c.number >= 0 && c.number <= 3; });
    if (moves || !at_.words.has_any("XYZ")) return frames_.set_work_offset(g);
    at_.request.shift = g;
    return;
  }
  if ((g >= 54 && g <= 57) || g == 500 || (g >= 505 && g <= 599)) return frames_.set_work_offset(g);
  at_.error(code.offset, "unknown-g",
            g < 0 ? fmt::format("G{:g} is no G function; a whole number was expected", code.value)
                  : fmt::format("G{} is not a G function of a Sinumerik program that Camber knows", g),
            fmt::format("G{}", g));
}

void BlockRunner::read_m_codes_before() {
  for (const CodeWord& code : at_.words.m) {
    const int m = code.number;
    const auto is = [m](std::initializer_list<int> codes) { return std::ranges::find(codes, m) != codes.end(); };
    if (is({0, 1, 2, 5, 9, 17, 30})) continue;  // at the end of the block
    if (is({3, 4, 13, 14})) {
      modes_.start_spindle(code);
    } else if (m == 6) {
      tools_.change_tool(code.offset);
    } else if (is({7, 8})) {
      modes_.set_coolant(true, m);
    } else if (m == 19) {
      at_.add_event(EventKind::spindle_orient, 0);
    } else if (m == 60) {
      at_.add_event(EventKind::pallet, 60);
    } else if (m < 0) {
      at_.error(code.offset, "unknown-m",
                fmt::format("M{:g} is no M function; a whole number was expected", code.value));
    } else {
      at_.add_event(EventKind::m_code, m);
      if (!is({10, 11, 40, 41, 42, 43, 44, 45, 48, 49, 70}))
        at_.report.warning(code.offset, "machine-function",
                           fmt::format("M{} is a function of the machine's maker; what it moves is not known, and it "
                                       "is passed over",
                                       m),
                           "machine-function");
    }
  }
}

bool BlockRunner::read_m_codes_after(bool& ends_subprogram) {
  bool go_on = true;
  for (const CodeWord& code : at_.words.m) {
    const int m = code.number;
    if (m == 5) modes_.stop_spindle(code);
    if (m == 9) modes_.set_coolant(false, 9);
    if (m == 0 || m == 1 || m == 2 || m == 30) at_.add_event(EventKind::m_code, m);
    if (m == 2 || m == 30) go_on = false;
    if (m == 17) ends_subprogram = true;
  }
  return go_on;
}

/// Letters that belong to no axis or function of a milling machine.
void BlockRunner::check_letters() {
  for (const char letter : std::string_view("ABC")) {
    if (!at_.words.has(letter) || mover_.rotary_axis(letter)) continue;
    mover_.check_rotary_letter(letter);
  }
  for (const char letter : std::string_view("UVWQE")) {
    if (!at_.words.has(letter)) continue;
    at_.error(at_.words.of(letter).offset, "axis",
              fmt::format("{} is not an axis that Camber knows; X, Y, Z, A, B or C was expected", letter),
              std::string(1, letter));
  }
}

void BlockRunner::finish() {
  corners_.finish();
  radius_.finish();
  tools_.finish();
  at_.relied_ends.fix(at_.out);
}

std::shared_ptr<const BlockRunner::Saved> BlockRunner::saved_modes() const {
  return std::make_shared<const Saved>(Saved{at_.motion, at_.plane, at_.absolute, modes_.state().inch,
                                             modes_.state().feed_mode, frames_.programmable(),
                                             modes_.state().work_offset});
}

void BlockRunner::restore(const Saved& saved) {
  at_.motion = saved.motion;
  at_.absolute = saved.absolute;
  modes_.set_plane(saved.plane);
  if (modes_.state().feed_mode != saved.feed_mode) modes_.set_feed(std::nullopt);
  modes_.change().inch = saved.inch;
  modes_.change().feed_mode = saved.feed_mode;
  modes_.change().work_offset = saved.work_offset;
  frames_.set_programmable(saved.programmable);
}

std::optional<Value> BlockRunner::system_value(const std::string& name, const std::vector<Value>& indexes,
                                               const std::vector<std::string>& index_names) {
  const auto number = [](double value) { return Value{value, {}, {}}; };
  const std::string axis = index_names.empty() ? std::string() : index_names[0];
  const int which = axis == "X" ? 0 : axis == "Y" ? 1 : axis == "Z" ? 2 : -1;
  if (name == "$P_EP" || name == "$AA_IW") {
    if (which >= 0) {
      if (mover_.place(which) != AxisPlace::known) return std::nullopt;
      return number(mover_.programmed()[which] / unit_mm());
    }
    if (axis.size() != 1) return std::nullopt;
    const auto angle = mover_.rotary_rad(axis[0]);
    return angle ? std::optional(number(deg_from_rad(*angle))) : std::nullopt;
  }
  if (name == "$P_F") {
    if (!modes_.feed()) return std::nullopt;
    return number(modes_.state().feed_mode == FeedMode::per_minute       ? *modes_.feed() * 60 / unit_mm()
                  : modes_.state().feed_mode == FeedMode::per_revolution ? *modes_.feed() / unit_mm()
                                                                         : *modes_.feed() * 60);
  }
  if (name == "$P_S") return number(modes_.state().programmed_spindle_speed_rpm);
  if (name == "$P_SDIR")
    return number(modes_.state().spindle == SpindleDirection::clockwise ? 3
                  : modes_.state().spindle == SpindleDirection::stopped ? 5
                                                                        : 4);
  if (name == "$P_MSNUM") return number(modes_.main_spindle());
  if (name == "$P_TOOLNO") return number(modes_.state().tool);
  if (name == "$P_TOOLP") return number(std::max(tools_.next(), 0));
  if (name == "$P_TOOL") return number(tools_.edge());
  if (name == "$P_ISTEST" || name == "$P_SEARCH" || name == "$P_SIM" || name == "$P_DRYRUN" || name == "$P_SEARCHL" ||
      name == "$AC_PROG" || name == "$P_SIMU" || name == "$P_SEARCH1" || name == "$P_SEARCH_S" ||
      name == "$P_TRAFO_ACTIVE")
    return number(0);
  const auto tool_value = [&](int tool, bool radius) -> std::optional<Value> {
    const ToolOffset* found = tools_.offset(tool);
    if (!found) return std::nullopt;
    const auto value = radius ? found->effective_radius_mm() : found->length_mm;
    if (!value) return std::nullopt;
    return number(*value / unit_mm());
  };
  if (name == "$P_TOOLR") return tools_.edge() == 0 ? number(0) : tool_value(modes_.state().tool, true);
  if (name == "$P_TOOLL") return tools_.edge() == 0 ? number(0) : tool_value(modes_.state().tool, false);
  if ((name == "$TC_DP6" || name == "$TC_DP3") && !indexes.empty() && !indexes[0].text)
    return tool_value(static_cast<int>(std::clamp(indexes[0].number, 0.0, 1e8)), name == "$TC_DP6");
  if (name == "$P_GG" && !indexes.empty()) {
    const double group = indexes[0].number;
    if (group == 1 && at_.motion <= Motion::counter_clockwise) return number(static_cast<int>(at_.motion) + 1);
    if (group == 6) return number(at_.plane == Plane::xy ? 1 : at_.plane == Plane::zx ? 2 : 3);
    if (group == 7) return number(!at_.radius.active ? 1 : at_.radius.g == 41 ? 2 : 3);
    if (group == 13) return number(modes_.state().inch ? 1 : 2);
    if (group == 14) return number(at_.absolute ? 1 : 2);
    if (group == 15 && modes_.state().feed_mode != FeedMode::inverse_time)
      return number(modes_.state().feed_mode == FeedMode::per_minute ? 2 : 3);
    return std::nullopt;
  }
  if (name == "$P_PFRAME") {
    Value out;
    out.frame = std::make_shared<const Affine>(frames_.programmable());
    return out;
  }
  if (name == "$P_UIFR" && indexes.size() == 3 && !indexes[0].text) {
    const int n = static_cast<int>(std::clamp(indexes[0].number, 0.0, 99.0));
    const int axis3 = index_names[1] == "X" ? 0 : index_names[1] == "Y" ? 1 : index_names[1] == "Z" ? 2 : -1;
    const int offset = n == 0 ? 500 : n <= 4 ? 53 + n : 540000 + n;
    if (axis3 < 0 || index_names[2] != "TR" || !frames_.offsets().known(offset)) return std::nullopt;
    return number(frames_.offsets().at(offset).value_mm[axis3] / unit_mm());
  }
  return std::nullopt;
}

/// G74 or G75 stands in the block, before the word that asks.
bool BlockRunner::goes_to_fixed_point() const {
  return std::ranges::any_of(at_.words.g, [](const CodeWord& c) { return c.number == 74 || c.number == 75; });
}

void BlockRunner::run_cycle(const CycleCall& call, const BlockPlace& place) {
  at_.place = place;
  at_.editable = false;
  const BlockRequest kept = at_.request;
  at_.request = {};
  mover_.forget_turn();
  switch (call.row->does) {
    case Does::drilling:
      cycles_.drill(call);
      break;
    case Does::thread_milling:
      cycles_.mill_thread(call);
      break;
    case Does::pocket:
      cycles_.mill_pocket(call);
      break;
    case Does::slots:
      cycles_.mill_slots(call);
      break;
    case Does::face:
      cycles_.mill_face(call);
      break;
    case Does::cycle800:
      mover_.swivel(call);
      break;
    case Does::cycle832:
      contouring_.run_cycle832(call);
      break;
    case Does::refused:
      set_command(*call.row, call.offset);
      break;
    default:
      break;
  }
  at_.request.trouble = at_.request.trouble || kept.trouble;
}

}  // namespace camber::nc::siemens
