#include "nc/interpreter.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "nc/machine_state.h"
#include "nc/refusals.h"

namespace camber::nc {
namespace {

constexpr double kArcWarn_mm = 0.005, kArcRefuse_mm = 0.05;

class Interpreter {
 public:
  Interpreter(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics, Interpretation& out)
      : program_(program), options_(options), diagnostics_(diagnostics), writer_(out, state_) {
    if (options.inch) set_unit(*options.inch);
  }

  void run() {
    for (std::size_t b = 0; b < program_.blocks.size() && !state_.ended; ++b) {
      if (program_.blocks[b].word_count == 0) continue;
      if (program_.blocks[b].skip && options_.skip_slash_blocks) continue;
      const BlockWords words(program_, b, diagnostics_);
      if (words.empty()) continue;
      writer_.begin_block(b);
      block(words);
      writer_.end_block();
    }
    report_unknown_m();
  }

 private:
  /// One block, in the order in which controls act: modes, feed, speed, tool, spindle, dwell, motion, stop.
  void block(const BlockWords& words) {
    motion_word_ = nullptr;
    non_modal_ = 0;
    for (const auto& g : words.g()) g_code(g, words);
    if (words.has('S')) state_.modal.spindle_speed_rpm = words.value('S');
    if (words.has('T')) state_.selected_tool = static_cast<int>(std::lround(words.value('T')));
    for (const auto& m : words.m()) early_m(m, words);
    check_letters(words);
    set_feed(words);
    if (non_modal_ == 40)
      dwell(words);
    else if (non_modal_ == 280 || non_modal_ == 300)
      reference_point(words);
    else if (non_modal_ == 530)
      machine_move(words);
    else
      motion(words);
    for (const auto& m : words.m()) late_m(m);
  }

  // --- G codes ---------------------------------------------------------------------------------------------------

  void g_code(const BlockWords::Code& g, const BlockWords& words) {
    ModalState& m = state_.modal;
    const int t = g.tenths;
    if (t >= 0 && t <= 30 && t % 10 == 0) return set_motion(t / 10, g, words);
    if (t == 730 || t == 740 || (t >= 810 && t <= 890 && t % 10 == 0)) return set_cycle(t / 10, g, words);
    if (t >= 540 && t <= 590 && t % 10 == 0) {
      m.work_offset = t / 10;
      return;
    }
    switch (t) {
      case 40:
      case 280:
      case 300:
      case 530:
        non_modal_ = t;
        return;
      case 80:
        // G8 P1: look-ahead on. What it does to the feed is the machine file's business.
        return;
      case 90:
        writer_.exact_stop();
        return;
      case 170:
        state_.plane = Plane::xy;
        return;
      case 180:
        state_.plane = Plane::zx;
        return;
      case 190:
        state_.plane = Plane::yz;
        return;
      case 200:
        set_unit(true);
        return;
      case 210:
        set_unit(false);
        return;
      case 150:
      case 400:
      case 430:
      case 490:
      case 690:
        return;
      case 541:
        return;  // G54.1 Pn: one more work offset
      case 610:
        m.path_control = PathControl::exact_path;
        return;
      case 611:
        m.path_control = PathControl::exact_stop;
        return;
      case 640:
        blend(words);
        return;
      case 800:
        state_.cycle.code = 0;
        return;
      case 900:
        m.incremental = false;
        return;
      case 910:
        m.incremental = true;
        return;
      case 901:
        state_.absolute_centre = true;
        return;
      case 911:
        state_.absolute_centre = false;
        return;
      case 930:
        set_feed_mode(FeedMode::inverse_time);
        return;
      case 940:
        set_feed_mode(FeedMode::per_minute);
        return;
      case 950:
        set_feed_mode(FeedMode::per_revolution);
        return;
      case 980:
        state_.retract_to_r = false;
        return;
      case 990:
        state_.retract_to_r = true;
        return;
      default:
        words.error(g.word, why_g_is_refused(t), "g-code");
    }
  }

  void set_motion(int code, const BlockWords::Code& g, const BlockWords& words) {
    if (motion_word_ && state_.motion != code)
      words.error(g.word, fmt::format("G{} and G{} in one block; one motion code was expected", state_.motion, code),
                  "motion-twice");
    state_.motion = code;
    state_.cycle.code = 0;
    motion_word_ = g.word;
  }

  void set_cycle(int code, const BlockWords::Code& g, const BlockWords& words) {
    if (code == 74 || code == 76 || code == 87 || code == 88) {
      words.error(g.word, fmt::format("the cycle G{} is not read yet", code), "g-code");
      return;
    }
    if (state_.cycle.code == 0) state_.cycle.initial_z_mm = state_.position_mm.z();
    state_.cycle.code = code;
    motion_word_ = g.word;
  }

  void set_unit(bool inch) {
    state_.inch = inch;
    state_.modal.inch = inch;
  }
  void set_feed_mode(FeedMode mode) {
    if (state_.modal.feed_mode != mode) state_.feed.reset();
    state_.modal.feed_mode = mode;
  }
  void blend(const BlockWords& words) {
    ModalState& m = state_.modal;
    m.path_control = PathControl::blend;
    m.blend_tolerance_mm = words.has('P') ? words.value('P') * state_.unit_mm() : -1;
    m.merge_tolerance_mm = words.has('Q') ? words.value('Q') * state_.unit_mm() : -1;
  }

  /// Letters that nothing in this block takes.
  void check_letters(const BlockWords& words) {
    const bool cycle = state_.cycle.code != 0;
    for (const char letter : {'A', 'B', 'C'})
      if (words.has(letter))
        words.error(words.word(letter),
                    fmt::format("the rotary axis {} is not read yet; a program in X, Y and Z was expected", letter),
                    "rotary-axis");
    for (const char letter : {'U', 'V', 'W'})
      if (words.has(letter) && !(letter == 'U' && non_modal_ == 40))
        words.error(words.word(letter), fmt::format("the word {} is not known in milling", letter), "word-unknown");
    if (words.has('E')) words.error(words.word('E'), "the word E is not known in milling", "word-unknown");
    const bool taken_r = cycle || words.has_g(20) || words.has_g(30) || state_.motion >= 2;
    if (words.has('R') && !taken_r)
      words.error(words.word('R'), "R without an arc (G2, G3) or a drilling cycle", "word-unused");
  }

  void set_feed(const BlockWords& words) {
    if (!words.has('F')) return;
    const double f = words.value('F');
    if (f < 0) {
      words.error(words.word('F'), fmt::format("F{:g}; a feed greater than zero was expected", f), "feed-zero");
      return;
    }
    if (state_.modal.feed_mode == FeedMode::inverse_time) {
      state_.feed = f;
      return;
    }
    need_unit(words);
    state_.feed = f * state_.unit_mm();
  }

  void need_unit(const BlockWords& words) {
    if (state_.inch) return;
    set_unit(false);
    words.warn(nullptr, "neither G20 nor G21 stands before the first length; millimetres are assumed", "unit-missing");
  }

  // --- M codes ---------------------------------------------------------------------------------------------------

  void early_m(const BlockWords::Code& m, const BlockWords& words) {
    ModalState& s = state_.modal;
    switch (m.tenths / 10) {
      case 3:
        s.spindle = SpindleDirection::clockwise;
        return;
      case 4:
        s.spindle = SpindleDirection::counter_clockwise;
        return;
      case 6:
        s.tool = state_.selected_tool;
        return;
      case 7:
      case 8:
        s.coolant = true;
        return;
      case 0:
      case 1:
      case 2:
      case 5:
      case 9:
      case 19:
      case 29:
      case 30:
      case 48:
      case 49:
        return;
      case 97:
      case 98:
      case 99:
        words.error(m.word, fmt::format("subprograms ({}) are not read yet", code_name('M', m.tenths)), "subprogram");
        return;
      default:
        ++unknown_m_[m.tenths];
        first_unknown_m_.try_emplace(m.tenths, m.word);
    }
  }

  void late_m(const BlockWords::Code& m) {
    switch (m.tenths / 10) {
      case 5:
        state_.modal.spindle = SpindleDirection::stopped;
        return;
      case 9:
        state_.modal.coolant = false;
        return;
      case 2:
      case 30:
        state_.ended = true;
        return;
      default:
        return;
    }
  }

  void report_unknown_m() {
    for (const auto& [tenths, count] : unknown_m_)
      diagnostics_.add(
          program_.source.diagnostic(Severity::warning, first_unknown_m_[tenths]->offset,
                                     fmt::format("{} is not known and taken to move nothing{}", code_name('M', tenths),
                                                 count > 1 ? fmt::format(" ({} times in this program)", count) : ""),
                                     "m-code"));
  }

  // --- motion ----------------------------------------------------------------------------------------------------

  /// Where the block's axis words lead, from `from`.
  Vec3 target(const BlockWords& words, const Vec3& from) {
    Vec3 to = from;
    for (int a = 0; a < 3; ++a) {
      const char letter = "XYZ"[a];
      if (!words.has(letter)) continue;
      need_unit(words);
      const double v = words.value(letter) * state_.unit_mm();
      to[a] = state_.modal.incremental ? from[a] + v : v;
    }
    return to;
  }

  void mark_known(const BlockWords& words) {
    for (int a = 0; a < 3; ++a)
      if (words.has("XYZ"[a]) && !state_.modal.incremental) state_.known[a] = true;
  }

  void motion(const BlockWords& words) {
    if (state_.cycle.code != 0) return cycle(words);
    const bool centre = words.has('I') || words.has('J') || words.has('K') || words.has('R');
    if (!words.has_axis() && !(state_.motion >= 2 && centre)) return;
    if (state_.motion < 0) {
      words.error(nullptr, "axis words before any motion code; G0, G1, G2 or G3 was expected", "motion-missing");
      return;
    }
    const Vec3 to = target(words, state_.position_mm);
    if (state_.motion == 0) {
      const bool from_known = state_.all_known();
      mark_known(words);
      writer_.rapid(to, !from_known || !state_.all_known());
    } else if (state_.motion == 1) {
      if (const auto feed = cutting_feed(state_, words, (to - state_.position_mm).norm(), "G1"))
        writer_.line(to, *feed);
    } else {
      arc(words, to);
    }
    state_.position_mm = to;  // also where an error left the move out
  }

  void arc(const BlockWords& words, const Vec3& to) {
    const auto length = [&](char letter) -> std::optional<double> {
      if (!words.has(letter)) return std::nullopt;
      need_unit(words);
      return words.value(letter) * state_.unit_mm();
    };
    ArcWords w{state_.position_mm, to,          state_.plane, state_.motion == 2,    length('I'),
               length('J'),        length('K'), length('R'),  state_.absolute_centre};
    if (words.has('P')) {
      w.turns = static_cast<int>(std::lround(words.value('P')));
      if (w.turns < 1 || std::abs(w.turns - words.value('P')) > 1e-9) {
        words.error(words.word('P'),
                    fmt::format("P{:g} on an arc; a whole number of turns was expected", words.value('P')),
                    "arc-turns");
        return;
      }
    }
    const char* name = state_.motion == 2 ? "G2" : "G3";
    if (!w.i_mm && !w.j_mm && !w.k_mm && !w.r_mm) {
      words.error(nullptr, fmt::format("{} without I, J, K or R; a centre or a radius was expected", name),
                  "arc-centre");
      return;
    }
    const ArcResult a = make_arc(w);
    if (!a.error.empty()) {
      words.error(nullptr, a.error, "arc-radius");
      return;
    }
    if (a.radius_difference_mm > kArcWarn_mm) {
      const std::string message = fmt::format(
          "the arc's radius is {:.4f} mm at its start and {:.4f} mm at its end, {:.4f} mm apart; "
          "less than {:g} mm was expected",
          a.start_radius_mm, a.end_radius_mm, a.radius_difference_mm, kArcWarn_mm);
      if (a.radius_difference_mm > kArcRefuse_mm) return words.error(nullptr, message, "arc-radii");
      words.warn(nullptr, message, "arc-radii");
    }
    const double radius = 0.5 * (a.start_radius_mm + a.end_radius_mm);
    const double arc_length = std::hypot(radius * a.arc.sweep_rad, (to - state_.position_mm).dot(a.arc.normal));
    if (const auto feed = cutting_feed(state_, words, arc_length, name)) writer_.arc(to, a.arc, *feed);
  }

  void cycle(const BlockWords& words) {
    CannedCycle& c = state_.cycle;
    const double unit = state_.unit_mm();
    if (words.has('Q')) c.q_mm = words.value('Q') * unit;
    if (words.has('P')) c.p_s = dwell_seconds(words, 'P');
    if (words.has('R')) c.r_mm = words.value('R') * unit + (state_.modal.incremental ? c.initial_z_mm : 0);
    if (words.has('Z')) c.z_mm = words.value('Z') * unit + (state_.modal.incremental ? c.r_mm : 0);
    if (!words.has_axis() && !words.has('R')) return;
    need_unit(words);
    if (state_.plane != Plane::xy) {
      words.error(motion_word_, "a drilling cycle outside G17 is not read yet", "cycle-plane");
      return;
    }
    Vec3 at = target(words, state_.position_mm);
    at.z() = state_.position_mm.z();
    const char count = words.has('L') ? 'L' : 'K';
    const int repeats = words.has(count) ? static_cast<int>(std::clamp(words.value(count), 0.0, 1e6)) : 1;
    const Vec3 increment = state_.modal.incremental ? Vec3(at - state_.position_mm) : Vec3::Zero();
    run_cycle(state_, words, at, repeats, increment, writer_);
  }

  double dwell_seconds(const BlockWords& words, char letter) const {
    const Word& w = *words.word(letter);
    const std::string_view text = std::string_view(program_.source.text()).substr(w.offset, w.length);
    const bool integer = text.find('.') == std::string_view::npos;
    return options_.integer_dwell_is_ms && integer ? w.value / 1000 : w.value;
  }

  void dwell(const BlockWords& words) {
    const char letter = words.has('P') ? 'P' : words.has('X') ? 'X' : 'U';
    if (!words.has(letter)) {
      words.error(nullptr, "G4 without a time; P (or X) was expected", "dwell-time");
      return;
    }
    const double seconds = dwell_seconds(words, letter);
    if (seconds < 0) {
      words.error(words.word(letter), fmt::format("a dwell of {:g} s; zero or more was expected", seconds),
                  "dwell-time");
      return;
    }
    writer_.dwell(seconds);
  }

  /// G28, G30: through the point of the words to the reference point, of which only the axes are known. Its
  /// coordinates count as 0, which serves nothing but the length of the way.
  void reference_point(const BlockWords& words) {
    const Vec3 through = target(words, state_.position_mm);
    if (words.has_axis()) writer_.rapid(through, true);
    to_reference(words, Vec3::Zero());
  }

  /// G53: machine coordinates; where they lie in the work frame is not known.
  void machine_move(const BlockWords& words) {
    Vec3 to = Vec3::Zero();
    for (int a = 0; a < 3; ++a) to[a] = words.value("XYZ"[a]) * state_.unit_mm();
    if (words.has_axis()) to_reference(words, to);
  }

  void to_reference(const BlockWords& words, const Vec3& machine) {
    Vec3 to = state_.position_mm;
    for (int a = 0; a < 3; ++a) {
      if (words.has_axis() && !words.has("XYZ"[a])) continue;
      to[a] = machine[a];
      state_.known[a] = false;
    }
    writer_.rapid(to, true);
  }

  const Program& program_;
  const InterpreterOptions& options_;
  Diagnostics& diagnostics_;
  MachineState state_;
  MoveWriter writer_;
  const Word* motion_word_ = nullptr;
  int non_modal_ = 0;
  std::map<int, int> unknown_m_;
  std::map<int, const Word*> first_unknown_m_;
};

}  // namespace

Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  Interpretation out;
  Interpreter(program, options, diagnostics, out).run();
  return out;
}

}  // namespace camber::nc
