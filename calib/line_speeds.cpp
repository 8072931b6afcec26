#include "calib/line_speeds.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "feedmodel/move_turns.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/joint_map.h"

namespace camber::calib {
namespace {

constexpr double kWindowS = 0.02;        // speeds are taken over it
constexpr std::size_t kFewestSteps = 3;  // of the trace in a window
constexpr double kHeldFraction = 1e-3;   // two windows that follow each other differ by less
constexpr double kDriftFraction = 2e-3;  // and all of them from their mean
constexpr double kHeldS = 0.02;          // beside the two windows
constexpr double kStill = 1e-2;          // mm/s or degrees/s

std::vector<AskedSpeeds> asked_of_lines(const nc::Interpretation& program, const machine::Machine& machine) {
  const bool turns = kinematics::has_rotary_motion(program, machine);
  const std::vector<LineFeed> feeds = turns ? feeds_of_lines(program, machine) : std::vector<LineFeed>{};
  std::vector<AskedSpeeds> lines;
  for (const nc::Move& move : program.moves) {
    const std::size_t line = move.block + 1;
    if (lines.size() <= line) lines.resize(line + 1);
    AskedSpeeds& asked = lines[line];
    asked = {};
    const bool rapid = move.kind == nc::MoveKind::rapid;
    asked.counts = (rapid || move.kind == nc::MoveKind::linear) && !move.canned &&
                   program.state_of(move).tip_control == nc::TipControl::off;
    asked.axes_apart = rapid && machine.cycle.rapid_path == machine::RapidPath::dogleg;
    asked.feed_per_s = rapid ? 0 : turns ? feeds[line].feed_per_s : move.feed_mm_per_s;
    asked.rotary_alone = turns && feeds[line].rotary_alone;
    const double length_mm = nc::length_mm(program, move);
    for (int i = 0; i < 3; ++i) {
      const double way_mm = std::abs(move.end_mm[i] - move.start_mm[i]);
      const auto axis = static_cast<std::size_t>(i);
      if (way_mm > 0) asked.per_s[axis] = rapid ? machine::kNoLimit : way_mm / length_mm * asked.feed_per_s;
      if (turns) asked.per_s[3 + axis] = feeds[line].asked_deg_per_s[i];
    }
  }
  return lines;
}

class Finder {
 public:
  Finder(const FeedRun& run, const machine::Machine& machine, std::vector<HeldSpeed>& out)
      : trace_(run.trace), asked_(asked_of_lines(run.program, machine)), out_(out) {
    window_ = std::max(kFewestSteps, static_cast<std::size_t>(std::lround(kWindowS / trace_.period_s)));
  }

  void run() {
    for (const Stretch& s : trace_.stretches) {
      for (std::size_t k = s.first + 2 * window_; k < s.end; ++k) take(k);
      close();
    }
  }

 private:
  double speed(std::size_t from, std::size_t to, std::size_t axis) const {
    return std::abs(joint_position(trace_, to, axis) - joint_position(trace_, from, axis)) /
           (trace_.t_s[to] - trace_.t_s[from]);
  }

  bool is_held(std::size_t k) const {
    const std::uint32_t line = trace_.line[k];
    if (line == 0 || line >= asked_.size() || !asked_[line].counts || trace_.line[k - 2 * window_] != line)
      return false;
    const double tolerance = 4 * kTraceRounding / (trace_.t_s[k] - trace_.t_s[k - window_]);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double now = speed(k - window_, k, i);
      if (std::abs(now - speed(k - 2 * window_, k - window_, i)) > kHeldFraction * now + tolerance) return false;
      // What has drifted since the hold began is not held either.
      if (open_ && std::abs(now - speed(first_, k, i)) > kDriftFraction * now + tolerance) return false;
    }
    return true;
  }

  void take(std::size_t k) {
    if (open_ && !is_held(k)) close();
    if (!is_held(k)) return;
    if (!open_) first_ = k - 2 * window_;
    open_ = true;
    last_ = k;
  }

  void close() {
    if (!open_) return;
    open_ = false;
    const double duration_s = trace_.t_s[last_] - trace_.t_s[first_];
    if (duration_s < kHeldS + 2 * kWindowS) return;
    HeldSpeed held;
    held.duration_s = duration_s;
    held.line = trace_.line[last_];
    held.first = first_;
    held.asked = asked_[held.line];
    // Without the ends, where a ramp may still be within the tolerance.
    for (std::size_t i = 0; i < kJoints; ++i) held.speed[i] = speed(first_ + window_ / 2, last_ - window_ / 2, i);
    const std::size_t from = held.asked.rotary_alone ? 3 : 0;
    held.path_per_s = std::hypot(held.speed[from], held.speed[from + 1], held.speed[from + 2]);
    if (held.path_per_s > kStill) out_.push_back(held);
  }

  const ServoTrace& trace_;
  std::vector<AskedSpeeds> asked_;
  std::vector<HeldSpeed>& out_;
  std::size_t window_ = 1, first_ = 0, last_ = 0;
  bool open_ = false;
};

}  // namespace

std::vector<HeldSpeed> held_speeds(const FeedRun& run, const machine::Machine& machine) {
  std::vector<HeldSpeed> all;
  if (!run.trace.line.empty()) Finder(run, machine, all).run();
  return all;
}

namespace {

LoggedLines lines_of(const StretchRun& run, int keep_back_every, std::size_t& count) {
  LoggedLines logged{run.program_name, std::make_unique<nc::Interpretation>(), {}};
  StretchProgram program(run.program, true);
  TimedLines& lines = logged.lines;
  lines.program = logged.program.get();
  for (const TimedStretch& t : one_for_each_geometry(run.timed, run.program)) {
    lines.moves.push_back(program.add(t));
    lines.fractions.emplace_back(t.stretch.first_u, t.stretch.last_u);
    lines.turns.push_back(t.turn);
    lines.ends_in_motion.push_back(t.stretch.ends_in_motion());
    lines.parts.push_back(
        {t.stretch.line_first, t.stretch.line_last, run.program.moves[t.stretch.move_first].feed_mm_per_s});
    lines.time_s.push_back(t.time_s);
    lines.sigma_s.push_back(t.sigma_s);
    lines.kept_back.push_back(++count % static_cast<std::size_t>(keep_back_every) == 0);
    lines.group.push_back(static_cast<int>(count));
  }
  *logged.program = program.take();
  return logged;
}

}  // namespace

std::vector<LoggedLines> logged_lines(const std::vector<StretchRun>& runs, int keep_back_every, std::size_t& count) {
  std::vector<LoggedLines> all;
  for (const StretchRun& run : runs)
    if (!run.timed.empty()) all.push_back(lines_of(run, keep_back_every, count));
  return all;
}

namespace {

constexpr double kNoLengthMm = 1e-9;

LineFeed line_feed(const nc::Interpretation& program, const machine::Machine& machine, const nc::Move& move,
                   feedmodel::MoveTurns& turns) {
  const Vec3 turn_rad = turns.now().end_rad - turns.now().start_rad;
  const double linear_mm = nc::length_mm(program, move), turn_deg = deg_from_rad(turn_rad.norm());
  LineFeed line;
  line.turn = turns.rest(false);
  line.rotary_alone = linear_mm < kNoLengthMm && turn_deg > 0;
  line.turns = turn_deg > 0;
  line.cutting = move.kind != nc::MoveKind::rapid;
  if (line.cutting)
    line.feed_per_s = kinematics::feed_along_path(program, move, turn_rad, turns.now().g93_time_s, machine.control);
  line.length = line.rotary_alone ? turn_deg : linear_mm;
  for (int i = 0; i < 3; ++i)
    if (turn_rad[i] != 0)
      line.asked_deg_per_s[i] =
          line.cutting ? std::abs(deg_from_rad(turn_rad[i])) / line.length * line.feed_per_s : machine::kNoLimit;
  return line;
}

}  // namespace

std::vector<LineFeed> feeds_of_lines(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<LineFeed> lines;
  feedmodel::MoveTurns turns(program, machine);
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& move = program.moves[i];
    turns.at(i);
    if (move.kind == nc::MoveKind::dwell) continue;
    if (lines.size() <= move.block + 1) lines.resize(move.block + 2);
    lines[move.block + 1] = line_feed(program, machine, move, turns);
  }
  return lines;
}

namespace {

constexpr double kSameFraction = 2e-3;      // of a limit: the axis is at it
constexpr double kBelowFraction = 5e-3;     // of a limit: the axis is not at it
constexpr double kAskedMore = 1.01;         // times the speed
constexpr double kResolvedFraction = 1e-4;  // of a speed

bool at_limit(const HeldSpeed& held, std::size_t axis, const JointSpeeds& highest) {
  const double speed = held.speed[axis];
  if (speed < kStill || speed < (1 - kSameFraction) * highest[axis]) return false;
  if (held.asked.per_s[axis] < kAskedMore * speed) return false;
  if (held.asked.axes_apart) return true;
  for (std::size_t i = 0; i < kJoints; ++i)
    if (i != axis && held.speed[i] > kStill && held.speed[i] > (1 - kBelowFraction) * highest[i]) return false;
  return true;
}

}  // namespace

std::array<TopSpeed, kJoints> top_speeds(const std::vector<HeldSpeed>& all) {
  JointSpeeds highest{};
  for (const HeldSpeed& held : all)
    for (std::size_t i = 0; i < kJoints; ++i) highest[i] = std::max(highest[i], held.speed[i]);
  std::array<TopSpeed, kJoints> tops{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    TopSpeed& top = tops[i];
    top.highest = highest[i];
    double longest_s = 0;
    for (const HeldSpeed& held : all) {
      if (!at_limit(held, i, highest)) continue;
      ++top.moves;
      if (held.duration_s <= longest_s) continue;
      longest_s = held.duration_s;
      top.limit = {held.speed[i], std::hypot(2 * kTraceRounding / longest_s, kResolvedFraction * held.speed[i])};
    }
  }
  return tops;
}

}  // namespace camber::calib
