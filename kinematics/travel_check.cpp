#include "kinematics/travel_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/program_joints.h"

namespace camber::kinematics {
namespace {

constexpr double kStepRad = kPi / 360;
constexpr int kArcSteps = 64, kMaxSteps = 3600;
constexpr double kTravelTolerance = 1e-6;  ///< mm, rad: what the rounding of a program's numbers leaves
constexpr double kSpeedRounding = 1e-3;
/// Angles of posts have three decimals; 0.01 degrees over a face of 100 mm are 0.017 mm.
constexpr double kSquareRad = 0.01 * kPi / 180;
constexpr std::array<char, 6> kLetters{'X', 'Y', 'Z', 'A', 'B', 'C'};

class TravelCheck {
 public:
  TravelCheck(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
              Diagnostics& diagnostics)
      : machine_(machine), program_(program), moves_(moves), diagnostics_(diagnostics), joints_(machine, moves) {
    for (std::size_t i = 0; i < 3; ++i) {
      travel_[i] = machine.axis[i].travel_mm;
      travel_[3 + i] = machine.rotary[i].travel_rad;
    }
  }

  void run() {
    while (!joints_.done()) {
      const MoveJoints& now = joints_.next();
      const nc::Move& move = moves_.moves[joints_.index()];
      if (move.kind == nc::MoveKind::dwell) continue;
      look_at_clamps(now, move);
      look_at_reach(now, move);
      look_at_tilt(move);
      look_at_known(now, move);
      look_at_travel(now, move);
      look_at_speed(now, move);
    }
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (over_[axis].move) report_travel(axis);
      if (fast_[axis].move) report_speed(axis);
    }
  }

 private:
  struct Worst {
    const nc::Move* move = nullptr;  ///< the first
    double value = 0;                ///< at its worst
    double amount = 0;               ///< by how much
    std::size_t count = 0;
    void add(const nc::Move& m, double v, double a) {
      if (!move) move = &m;
      if (count == 0 || a > amount) {
        value = v;
        amount = a;
      }
      ++count;
    }
  };

  void say(Severity severity, const nc::Move& m, const char* check, std::string message) {
    diagnostics_.add(program_.source.diagnostic(severity, program_.blocks[m.block].offset, std::move(message), check));
  }

  /// Words that turn a clamped axis are errors already (nc/rotary_codes.cpp); directions and ways home are not.
  void look_at_clamps(const MoveJoints& now, const nc::Move& m) {
    const auto& events = moves_.events;
    for (; next_event_ < events.size() && events[next_event_].before_move <= joints_.index(); ++next_event_) {
      if (events[next_event_].kind != nc::EventKind::m_code) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const machine::RotaryAxis& axis = machine_.rotary[i];
        if (axis.clamp_m == 0) continue;
        if (events[next_event_].value == axis.clamp_m) clamped_[i] = true;
        if (events[next_event_].value == axis.unclamp_m) clamped_[i] = false;
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      const double turn_rad = now.end_rad[index] - now.start_rad[index];
      if (!clamped_[i] || said_clamped_[i] || std::abs(turn_rad) <= kTravelTolerance) continue;
      said_clamped_[i] = true;
      say(Severity::error, m, "clamped",
          fmt::format("{} turns by {} degrees while M{} has it clamped; M{} was expected before", kLetters[3 + i],
                      format_trimmed(deg_from_rad(turn_rad), 3), machine_.rotary[i].clamp_m,
                      machine_.rotary[i].unclamp_m));
    }
  }

  void look_at_tilt(const nc::Move& m) {
    if (said_tilt_ || joints_.tilt_error_rad() < kSquareRad) return;
    said_tilt_ = true;
    say(Severity::error, m, "tilted-frame",
        fmt::format("the tool is {} degrees off Z of the tilted frame (G68.2) in this move; G53.1 was expected before",
                    format_trimmed(deg_from_rad(joints_.tilt_error_rad()), 3)));
  }

  void look_at_reach(const MoveJoints& now, const nc::Move& m) {
    if (said_direction_ || now.reach == Reach::reached || now.reach == Reach::travel) return;
    said_direction_ = true;
    say(Severity::error, m, "tool-direction",
        now.reach == Reach::direction
            ? moves_.state_of(m).work_frame == nc::WorkFrame::tilted
                  ? "the rotary axes cannot put the tool along Z of the tilted frame; a plane within their reach was "
                    "expected"
                  : "the rotary axes cannot give the tool this direction (I J K); one within their reach was expected"
            : "two linear axes are parallel at the end of this move; other angles of the rotary axes were expected");
  }

  void look_at_known(const MoveJoints& now, const nc::Move& m) {
    if (now.linear_known || m.reference || said_unchecked_ || moves_.rotary.empty()) return;
    const bool limited = std::any_of(travel_.begin(), travel_.begin() + 3,
                                     [](const auto& t) { return !std::isinf(t[0]) || !std::isinf(t[1]); });
    if (!limited) return;
    if (moves_.machine_origin_mm && moves_.state_of(m).tool_length_mm) return;  // after a reference point
    said_unchecked_ = true;
    const std::string what =
        moves_.machine_origin_mm ? "the tool length (--tool-length)" : "the work offset (--work-offset, or G10 L2)";
    say(Severity::warning, m, "travel-unchecked",
        fmt::format("the travel of X, Y and Z is not checked, as {} is not known", what));
  }

  int steps_of(const MoveJoints& now, const nc::Move& m) const {
    const double turn = (now.end_rad - now.start_rad).lpNorm<Eigen::Infinity>();
    const int steps = static_cast<int>(std::min<double>(kMaxSteps, std::ceil(turn / kStepRad)));
    return std::max({1, steps, m.kind == nc::MoveKind::arc ? kArcSteps : 0});
  }

  void look_at_travel(const MoveJoints& now, const nc::Move& m) {
    std::array<double, 6> worst{}, value{};
    const int steps = steps_of(now, m);
    for (int i = now.start_known ? 0 : steps; i <= steps; ++i) {
      const Joints q = joints_.at(static_cast<double>(i) / steps);
      for (std::size_t axis = now.linear_known ? 0 : 3; axis < 6; ++axis) {
        const auto index = static_cast<Eigen::Index>(axis % 3);
        const double at = axis < 3 ? q.linear_mm[index] : q.rotary_rad[index];
        const double beyond = std::max(travel_[axis][0] - at, at - travel_[axis][1]);
        if (beyond <= worst[axis]) continue;
        worst[axis] = beyond;
        value[axis] = at;
      }
    }
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (worst[axis] > kTravelTolerance) over_[axis].add(m, value[axis], worst[axis]);
  }

  void look_at_speed(const MoveJoints& now, const nc::Move& m) {
    if (!now.turns() || (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc)) return;
    const auto time_s = programmed_time_s(moves_, m, now.end_rad - now.start_rad, now.g93_time_s, machine_.control);
    if (!time_s) return;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      const double speed = std::abs(now.end_rad[index] - now.start_rad[index]) / *time_s;
      const double limit = machine_.rotary[i].max_velocity_rad_per_s;
      if (speed > limit * (1 + kSpeedRounding)) fast_[3 + i].add(m, speed, speed);
    }
  }

  static std::string more(const Worst& worst) {
    return worst.count > 1 ? fmt::format(" in this move and {} more", worst.count - 1) : std::string();
  }

  std::string shown(std::size_t axis, double value) const {
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return format_trimmed(axis < 3 ? value : deg_from_rad(value), 3);
  }

  void report_travel(std::size_t axis) {
    const Worst& worst = over_[axis];
    const char* unit = axis < 3 ? "mm" : "degrees";
    say(Severity::error, *worst.move, "travel",
        fmt::format("{} goes to {} {} in machine coordinates{}; {} to {} was expected ({} of [axis.{}])",
                    kLetters[axis], shown(axis, worst.value), unit, more(worst), shown(axis, travel_[axis][0]),
                    shown(axis, travel_[axis][1]), axis < 3 ? "travel_mm" : "travel_deg",
                    static_cast<char>(kLetters[axis] - 'A' + 'a')));
  }

  void report_speed(std::size_t axis) {
    const Worst& worst = fast_[axis];
    const double per_minute = 60 * deg_from_rad(1);
    say(Severity::warning, *worst.move, "rotary-speed",
        fmt::format("the feed asks up to {:.0f} degrees/min of {}{}, but {} allows {:g} (max_velocity_deg_per_min of "
                    "[axis.{}]); the control slows down here",
                    worst.value * per_minute, kLetters[axis], more(worst), machine_.path,
                    machine_.rotary[axis - 3].max_velocity_rad_per_s * per_minute,
                    static_cast<char>(kLetters[axis] - 'A' + 'a')));
  }

  const machine::Machine& machine_;
  const nc::Program& program_;
  const nc::Interpretation& moves_;
  Diagnostics& diagnostics_;
  ProgramJoints joints_;
  std::array<std::array<double, 2>, 6> travel_{};
  std::array<Worst, 6> over_, fast_;
  std::size_t next_event_ = 0;
  std::array<bool, 3> clamped_{}, said_clamped_{};
  bool said_direction_ = false, said_tilt_ = false, said_unchecked_ = false;
};

}  // namespace

void check_travel(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                  Diagnostics& diagnostics) {
  TravelCheck(machine, program, moves, diagnostics).run();
}

}  // namespace camber::kinematics
