#include "calib/held_speed.h"

#include <algorithm>
#include <cmath>

#include "calib/rotary_lines.h"
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

}  // namespace camber::calib
