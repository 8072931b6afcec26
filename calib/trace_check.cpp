#include "calib/trace_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "base/units.h"
#include "calib/line_speeds.h"
#include "kinematics/joint_map.h"
#include "kinematics/program_joints.h"

namespace camber::calib {
namespace {

using Joints = std::array<double, kJoints>;

constexpr double kTellingWay = 1.0;    // mm or degrees between two ends of lines: shorter ones tell nothing
constexpr double kEndTolerance = 0.3;  // mm or degrees; corners are rounded
constexpr double kEndFraction = 0.05;  // of the way
constexpr double kEndS = 0.05;         // times the speed: where the line changes, and lag
constexpr double kSameProgram = 0.5;   // of the ways agree: the trace is of the program
constexpr double kExplained = 0.8;     // of the ways agree with another unit, or other axes
constexpr std::size_t kFewestWays = 3;
constexpr double kHoldS = 0.2;            // at rest inside a line
constexpr double kStill = 2e-3;           // mm or degrees: the axes rest (actual positions are never quite still)
constexpr double kSlowWay = 20 * kStill;  // what a feed must go in the time of a rest
constexpr double kInside = 0.05;          // mm or degrees from the ends of a line: the axes are inside it
constexpr double kFullSpeed = 0.98;       // of the feed, and of a limit
constexpr double kOverFeed = 1.02;        // of the feed
constexpr double kSameRatio = 0.01;       // of speed to feed
constexpr double kReached = 1.02;         // times a speed: the machine goes faster than it
constexpr double kSlip = 0.5;             // of a sample's way

struct Unit {
  double factor;  // of the numbers in the trace, to mm or degrees
  const char* name;
};
constexpr Unit kLinearUnits[] = {{25.4, "inch"}, {1 / 25.4, "mm/25.4"}, {1e-3, "um"}, {1e3, "m"}, {1e-6, "nm"}};
constexpr Unit kRotaryUnits[] = {{180 / kPi, "rad"}, {360, "turns"}, {1e-3, "thousandths of a degree"}};
constexpr const char* kLetters = "XYZABC";

/// One line from its first to its last sample, and where its move ends.
struct LineRun {
  std::uint32_t line = 0;
  std::size_t first = 0, last = 0;
  std::uint32_t move = 0;
};

/// The way from the end of one line to the end of the next one, by the trace and by the program.
struct Way {
  Joints traced{}, programmed{}, programmed_with_merged{};
  double slack = 0;
  std::size_t sample = 0;
};

class Checker {
 public:
  Checker(const FeedRun& run, const machine::Machine& machine, Diagnostics& diagnostics)
      : run_(run),
        trace_(run.trace),
        machine_(machine),
        diagnostics_(diagnostics),
        name_(std::filesystem::path(run.program_name).filename().string()) {}

  void check() {
    check_times();
    if (trace_.line.empty()) return;
    find_lines();
    check_ways();
    check_speeds();
    check_holds();
  }

 private:
  [[noreturn]] void fail(std::size_t sample, std::string message, std::string check) {
    const std::size_t row = sample < trace_.row.size() ? trace_.row[sample] : 0;
    diagnostics_.add({.severity = Severity::error,
                      .location = {trace_.path, row, row > 0 ? std::size_t{1} : 0},
                      .message = std::move(message),
                      .check = std::move(check),
                      .source_line = {}});
    diagnostics_.throw_if_errors();
    throw InputError({});
  }

  double distance(std::size_t from, std::size_t to) const {
    double square = 0;
    for (std::size_t i = 0; i < kJoints; ++i)
      square += std::pow(joint_position(trace_, to, i) - joint_position(trace_, from, i), 2);
    return std::sqrt(square);
  }

  /// Missing samples leave a way that the speed explains; a clock that jumps leaves that of one sample.
  void check_times() {
    for (std::size_t s = 1; s < trace_.stretches.size(); ++s) {
      const std::size_t k = trace_.stretches[s].first;
      if (k < 2 || k + 1 >= trace_.size()) continue;
      const double before = distance(k - 2, k - 1), after = distance(k, k + 1), step = distance(k - 1, k);
      const double gap_s = trace_.t_s[k] - trace_.t_s[k - 1];
      const double one = std::max(before, after), expected = std::min(before, after) * gap_s / trace_.period_s;
      if (std::min(before, after) < 10 * kTraceRounding || expected < 3 * one) continue;
      if (step > (1 + kSlip) * one) continue;
      fail(k,
           fmt::format("the time goes on by {:.6g} s at {:.6g} s, the axes by {:.3g} mm as in a sample of {:.4g} s "
                       "before; a time that runs evenly was expected",
                       gap_s, trace_.t_s[k], step, trace_.period_s),
           "trace-time");
    }
  }

  // --- lines and ways -------------------------------------------------------------------------------------------

  void find_lines() {
    const auto& moves = run_.program.moves;
    std::uint32_t last_line = 0;
    for (const nc::Move& move : moves) last_line = std::max(last_line, move.block + 1);
    std::vector<std::vector<std::uint32_t>> moves_of(last_line + 1);
    for (std::uint32_t m = 0; m < moves.size(); ++m)
      if (moves[m].kind != nc::MoveKind::dwell) moves_of[moves[m].block + 1].push_back(m);
    std::uint32_t at = 0;
    for (std::size_t k = 0; k < trace_.size(); ++k) {
      const std::uint32_t line = trace_.line[k];
      if (line == 0) continue;
      if (!lines_.empty() && lines_.back().line == line) {
        lines_.back().last = k;
        continue;
      }
      if (line > last_line) {
        unknown_ = unknown_ ? unknown_ : std::optional(k);
        continue;
      }
      const auto& own = moves_of[line];
      if (own.empty()) continue;
      auto next = std::ranges::lower_bound(own, at);
      if (next == own.end()) next = own.begin();  // the trace has the program more than once
      while (std::next(next) != own.end() && *std::next(next) == *next + 1) ++next;
      at = *next;
      lines_.push_back({line, k, k, at});
    }
    if (lines_.empty())
      fail(unknown_.value_or(trace_.size()),
           fmt::format("no line of the trace moves an axis in {}; a trace of this program was expected", name_),
           "trace-program");
  }

  bool is_cutting(std::uint32_t m) const {
    const nc::MoveKind kind = run_.program.moves[m].kind;
    return kind == nc::MoveKind::linear || kind == nc::MoveKind::arc;
  }

  std::vector<Joints> ends_of_moves() const {
    std::vector<Joints> ends;
    if (!kinematics::has_rotary_motion(run_.program, machine_)) {
      for (const nc::Move& m : run_.program.moves) ends.push_back({m.end_mm.x(), m.end_mm.y(), m.end_mm.z(), 0, 0, 0});
      return ends;
    }
    kinematics::ProgramJoints joints(machine_, run_.program, kinematics::MissingOffset::zero);
    while (!joints.done()) {
      joints.next();
      const kinematics::Joints j = joints.at(1);
      const Vec3 deg = j.rotary_rad * deg_from_rad(1);
      ends.push_back({j.linear_mm.x(), j.linear_mm.y(), j.linear_mm.z(), deg.x(), deg.y(), deg.z()});
    }
    return ends;
  }

  double speed_before(std::size_t k) const {
    return k > 0 && trace_.t_s[k] - trace_.t_s[k - 1] < 1.5 * trace_.period_s
               ? distance(k - 1, k) / (trace_.t_s[k] - trace_.t_s[k - 1])
               : 0;
  }

  void find_ways() {
    const std::vector<Joints> ends = ends_of_moves();
    for (std::size_t i = 1; i < lines_.size(); ++i) {
      const LineRun &from = lines_[i - 1], &to = lines_[i];
      if (to.move < from.move) continue;
      const auto merged_end = [&](std::size_t n) {
        std::uint32_t m = lines_[n].move;
        const std::uint32_t next =
            n + 1 < lines_.size() ? lines_[n + 1].move : static_cast<std::uint32_t>(run_.program.moves.size());
        while (is_cutting(lines_[n].move) && m + 1 < next && is_cutting(m + 1)) ++m;
        return m;
      };
      Way way{.sample = to.first};
      const std::uint32_t merged_from = merged_end(i - 1), merged_to = merged_end(i);
      for (std::size_t j = 0; j < kJoints; ++j) {
        way.traced[j] = joint_position(trace_, to.last, j) - joint_position(trace_, from.last, j);
        way.programmed[j] = ends[to.move][j] - ends[from.move][j];
        way.programmed_with_merged[j] = ends[merged_to][j] - ends[merged_from][j];
      }
      way.slack = kEndTolerance +
                  std::max(kEndS, 2 * trace_.period_s) * std::max(speed_before(from.last), speed_before(to.last));
      ways_.push_back(way);
    }
  }

  /// Maps each axis of the program to the axis of the trace, and the sign, that it is compared with.
  struct Axes {
    std::array<std::size_t, kJoints> of{0, 1, 2, 3, 4, 5};
    std::array<double, kJoints> sign{1, 1, 1, 1, 1, 1};
    double linear = 1, rotary = 1;
  };

  bool has(std::size_t joint) const {
    return joint < 3 ? trace_.has_command[joint] || trace_.has_actual[joint]
                     : trace_.has_rotary_command[joint - 3] || trace_.has_rotary_actual[joint - 3];
  }

  /// Whether a way agrees; nothing where it is too short to tell. `first`, `end`: the joints that are looked at.
  std::optional<bool> agrees(const Way& way, const Axes& axes, std::size_t first, std::size_t end) const {
    double length = 0;
    bool own = true, merged = true;
    for (std::size_t i = first; i < end; ++i)
      if (has(i)) length = std::max(length, std::abs(way.programmed[i]));
    if (length < kTellingWay) return std::nullopt;
    const double slack = way.slack + kEndFraction * length;
    for (std::size_t i = first; i < end; ++i) {
      if (!has(i) || !has(axes.of[i])) continue;
      const double traced = axes.sign[i] * (i < 3 ? axes.linear : axes.rotary) * way.traced[axes.of[i]];
      own = own && std::abs(traced - way.programmed[i]) < slack;
      merged = merged && std::abs(traced - way.programmed_with_merged[i]) < slack;
    }
    return own || merged;
  }

  /// Fraction of the telling ways that agree; nothing where there are too few.
  std::optional<double> fraction(const Axes& axes, std::size_t first, std::size_t end) const {
    std::size_t telling = 0, agree = 0;
    for (const Way& way : ways_)
      if (const auto a = agrees(way, axes, first, end)) {
        ++telling;
        agree += *a;
      }
    if (telling < kFewestWays) return std::nullopt;
    return static_cast<double>(agree) / static_cast<double>(telling);
  }

  std::size_t first_contradiction(std::size_t first, std::size_t end) const {
    for (const Way& way : ways_)
      if (const auto a = agrees(way, {}, first, end); a && !*a) return way.sample;
    return ways_.front().sample;
  }

  bool explained_by(const Axes& axes, std::size_t first, std::size_t end) const {
    return fraction(axes, first, end).value_or(0) > kExplained;
  }

  void check_group(std::size_t first, std::size_t end) {
    const auto own = fraction({}, first, end);
    if (!own || *own > kSameProgram) return;
    const std::size_t place = first_contradiction(first, end);
    const bool rotary = first > 0;
    const auto check_unit = [&](const Unit& unit) {
      Axes axes;
      (rotary ? axes.rotary : axes.linear) = unit.factor;
      if (explained_by(axes, first, end))
        fail(place,
             fmt::format("the {} are in {}: ways between the ends of lines are {:.6g} times those of {}; {} were "
                         "expected",
                         rotary ? "angles" : "positions", unit.name, 1 / unit.factor, name_, rotary ? "degrees" : "mm"),
             "trace-units");
    };
    if (rotary)
      for (const Unit& unit : kRotaryUnits) check_unit(unit);
    else
      for (const Unit& unit : kLinearUnits) check_unit(unit);
    check_axes(first, place);
    fail(
        place,
        fmt::format("the axes do not go the way of line {} of {} ({:.0f} % of the ways between ends of lines agree); a "
                    "trace of this program was expected",
                    trace_.line[place], name_, 100 * *own),
        "trace-program");
  }

  void check_axes(std::size_t first, std::size_t place) {
    std::array<std::size_t, 3> order{0, 1, 2};
    do {
      for (unsigned signs = 0; signs < 8; ++signs) {
        Axes axes;
        std::string text;
        for (std::size_t i = 0; i < 3; ++i) {
          axes.of[first + i] = first + order[i];
          axes.sign[first + i] = signs >> i & 1U ? -1 : 1;
          if (order[i] == i && axes.sign[first + i] > 0) continue;
          text += fmt::format("{}{} of the program is {}{} of the trace", text.empty() ? "" : ", ", kLetters[first + i],
                              axes.sign[first + i] < 0 ? "-" : "", kLetters[first + order[i]]);
        }
        if (!text.empty() && explained_by(axes, first, first + 3))
          fail(place, fmt::format("{}; the axes of the program were expected", text), "trace-axes");
      }
    } while (std::ranges::next_permutation(order).found);
  }

  void check_ways() {
    find_ways();
    check_group(0, 3);
    check_group(3, 6);
    if (unknown_)
      fail(
          *unknown_,
          fmt::format("line {} is commanded, but the last that moves in {} is {}; a trace of this program was expected",
                      trace_.line[*unknown_], name_, run_.program.moves.back().block + 1),
          "trace-program");
  }

  // --- speeds ---------------------------------------------------------------------------------------------------

  void check_speeds() {
    const std::vector<HeldSpeed> held = held_speeds(run_, machine_);
    std::vector<double> ratios;
    for (const HeldSpeed& h : held)
      if (h.asked.feed_per_s > 0) ratios.push_back(h.path_per_s / h.asked.feed_per_s);
    if (ratios.size() < kFewestWays) return;
    std::ranges::sort(ratios);
    const double median = ratios[ratios.size() / 2];
    for (const double factor : {1000.0, 60.0, 1 / 60.0, 1e-3, 1e-6})
      if (std::abs(median / factor - 1) < 0.5)
        fail(held.front().first,
             fmt::format(
                 "held speeds are {:.4g} times the programmed feeds: the time is not in s; seconds were expected",
                 median),
             "trace-units");
    const auto tops = top_speeds(held);
    double fastest = 0;
    for (const HeldSpeed& h : held)
      if (!h.asked.rotary_alone) fastest = std::max(fastest, h.path_per_s);
    for (const HeldSpeed& h : held) check_speed(h, held, tops, fastest);
  }

  void check_speed(const HeldSpeed& h, const std::vector<HeldSpeed>& held, const std::array<TopSpeed, kJoints>& tops,
                   double fastest) {
    if (h.asked.feed_per_s <= 0 || run_.program.moves.empty()) return;
    const double ratio = h.path_per_s / h.asked.feed_per_s;
    if (ratio > kOverFeed) fail_on_override(h, ratio);
    if (ratio > kFullSpeed || h.asked.rotary_alone) return;
    for (std::size_t i = 0; i < kJoints; ++i)
      if (h.speed[i] > kFullSpeed * tops[i].highest && tops[i].limit) return;
    // The machine goes faster, and so do lines of this feed; or other feeds are reduced alike.
    bool reduced_alike = false, reached = false;
    for (const HeldSpeed& other : held) {
      if (other.asked.feed_per_s <= 0 || other.asked.rotary_alone) continue;
      const double of_other = other.path_per_s / other.asked.feed_per_s;
      const bool other_feed = std::abs(other.asked.feed_per_s / h.asked.feed_per_s - 1) > kSameRatio;
      reduced_alike = reduced_alike || (other_feed && std::abs(of_other / ratio - 1) < kSameRatio);
      reached = reached || (!other_feed && of_other > kFullSpeed);
    }
    if (reduced_alike || (reached && fastest > kReached * h.path_per_s)) fail_on_override(h, ratio);
  }

  [[noreturn]] void fail_on_override(const HeldSpeed& h, double ratio) {
    fail(h.first,
         fmt::format("the axes hold {:.1f} mm/min in line {} of {}, which is programmed with F{:.0f}: an override of "
                     "{:.0f} %; a trace at 100 % was expected",
                     60 * h.path_per_s, h.line, name_, 60 * h.asked.feed_per_s, 100 * ratio),
         "trace-override");
  }

  // --- feed holds -----------------------------------------------------------------------------------------------

  /// Lines of one move, which has no reason to rest inside.
  bool is_one_move(const LineRun& line) const {
    const auto& moves = run_.program.moves;
    const auto same = [&](std::size_t m) { return m < moves.size() && moves[m].block + 1 == line.line; };
    return !moves[line.move].canned && !same(line.move + 1) && (line.move == 0 || !same(line.move - 1));
  }

  void check_holds() {
    for (const LineRun& line : lines_) {
      const double feed = run_.program.moves[line.move].feed_mm_per_s;
      const double hold_s = std::max(kHoldS, feed > 0 ? kSlowWay / feed : 0.0);
      if (!is_one_move(line)) continue;
      std::size_t rest_from = line.first;
      for (std::size_t k = line.first + 1; k <= line.last; ++k) {
        if (trace_.line[k] == line.line && distance(rest_from, k) < kStill) continue;
        check_hold(line, rest_from, k - 1, hold_s);
        rest_from = k;
      }
    }
  }

  void check_hold(const LineRun& line, std::size_t from, std::size_t to, double hold_s) {
    const double rest_s = trace_.t_s[to] - trace_.t_s[from];
    if (rest_s < hold_s || distance(line.first, from) < kInside || distance(to, line.last) < kInside) return;
    fail(from,
         fmt::format("the axes stand still for {:.2f} s inside line {} of {}: a feed hold; a trace without one was "
                     "expected",
                     rest_s, line.line, name_),
         "trace-override");
  }

  const FeedRun& run_;
  const ServoTrace& trace_;
  const machine::Machine& machine_;
  Diagnostics& diagnostics_;
  std::string name_;
  std::vector<LineRun> lines_;
  std::optional<std::size_t> unknown_;  // sample of a line that the program does not have
  std::vector<Way> ways_;
};

}  // namespace

void check_trace(const FeedRun& run, const machine::Machine& machine, Diagnostics& diagnostics) {
  Checker(run, machine, diagnostics).check();
}

}  // namespace camber::calib
