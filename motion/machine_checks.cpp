#include "motion/machine_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::motion {
namespace {

constexpr double kStill_mm = 1e-9;
constexpr double kRounding = 1e-3;  // of the feed: arcs are looked at in steps
constexpr std::array<char, 3> kLetters{'X', 'Y', 'Z'};

bool cuts(const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; }

/// Returns the largest magnitude of each component of the unit direction along the move.
Vec3 largest_direction(const nc::Interpretation& moves, const nc::Move& m) {
  constexpr int kArcSteps = 64;
  const int steps = m.kind == nc::MoveKind::arc ? kArcSteps : 1;
  Vec3 out = Vec3::Zero();
  for (int i = 0; i <= steps; ++i)
    out = out.cwiseMax(nc::direction_at(moves, m, static_cast<double>(i) / steps).cwiseAbs());
  return out;
}

/// The stretches between tool changes: what a machine clamps is said once in each.
class Operations {
 public:
  explicit Operations(const nc::Interpretation& moves) : events_(moves.events) {}

  /// True where a tool change lies before the move. Moves are asked for in ascending order.
  bool begins(std::size_t move) {
    bool changed = false;
    for (; next_ < events_.size() && events_[next_].before_move <= move; ++next_)
      changed |= events_[next_].kind == nc::EventKind::tool_change;
    return changed;
  }

 private:
  const std::vector<nc::Event>& events_;
  std::size_t next_ = 0;
};

class MachineCheck {
 public:
  MachineCheck(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
               Diagnostics& diagnostics)
      : machine_(machine), program_(program), moves_(moves), diagnostics_(diagnostics) {}

  void run() {
    Operations operations(moves_);
    for (std::size_t i = 0; i < moves_.moves.size(); ++i) {
      if (operations.begins(i)) report();
      const nc::Move& m = moves_.moves[i];
      if (m.kind == nc::MoveKind::dwell || m.reference) continue;
      if (cuts(m)) look_at_spindle(m);
      // Under tool-centre-point control and in tilted frames X Y Z are not the axes (kinematics/travel_check.h).
      const nc::ModalState& state = moves_.state_of(m);
      if (state.tip_control == nc::TipControl::off && state.work_frame == nc::WorkFrame::machine) look_at_axes(m);
    }
    report();
  }

 private:
  /// Moves of one operation whose value the control clamps to a limit.
  struct Clamped {
    const nc::Move* move = nullptr;  ///< the first
    double largest = 0;              ///< asked for
    std::size_t count = 0;
    void add(const nc::Move& m, double asked) {
      if (!move) move = &m;
      if (asked > largest * (1 + kRounding)) largest = asked;
      ++count;
    }
    std::string more() const { return count > 1 ? fmt::format(" in this move and {} more", count - 1) : std::string(); }
  };

  void say(const nc::Move& m, Severity severity, const char* check, std::string message) {
    diagnostics_.add(program_.source.diagnostic(severity, program_.blocks[m.block].offset, std::move(message), check));
  }

  void look_at_spindle(const nc::Move& m) {
    const nc::ModalState& state = moves_.state_of(m);
    const double rpm = std::max(state.programmed_spindle_speed_rpm, state.spindle_speed_rpm);
    if (rpm > machine_.spindle.max_rpm) spindle_.add(m, rpm);
  }

  void look_at_axes(const nc::Move& m) {
    if ((m.end_mm - m.start_mm).cwiseAbs().maxCoeff() <= kStill_mm && m.kind != nc::MoveKind::arc) return;
    const Vec3 direction = largest_direction(moves_, m);
    for (std::size_t a = 0; a < 3; ++a) {
      const machine::Axis& axis = machine_.axis[a];
      const double fraction = direction[static_cast<Eigen::Index>(a)];
      if (fraction <= kStill_mm) continue;
      if (!axis.given && !said_missing_[a]) {
        said_missing_[a] = true;
        say(m, Severity::error, "axis-missing",
            fmt::format("{} moves here, but {} has no [axis.{}]; an axis with its limits was expected", kLetters[a],
                        machine_.path, static_cast<char>(kLetters[a] - 'A' + 'a')));
      }
      const double asked = fraction * m.feed_mm_per_s;
      if (cuts(m) && asked > axis.max_velocity_mm_per_s * (1 + kRounding)) axes_[a].add(m, asked);
    }
  }

  /// Reports the limits exceeded in the operation that ends: at the first place of each, with the largest value.
  void report() {
    if (spindle_.move)
      say(*spindle_.move, Severity::warning, "spindle-limit",
          fmt::format("up to S{:g} here{}, but the spindle of {} turns at up to {:g} rpm (max_rpm); it is clamped to "
                      "that",
                      spindle_.largest, spindle_.more(), machine_.path, machine_.spindle.max_rpm));
    for (std::size_t a = 0; a < 3; ++a) {
      if (!axes_[a].move) continue;
      say(*axes_[a].move, Severity::warning, "feed-limit",
          fmt::format("the feed requires up to {:.0f} mm/min of {}{}, but {} allows {:g} (max_velocity_mm_per_min of "
                      "[axis.{}]); it is clamped to that",
                      mm_per_min_from_mm_per_s(axes_[a].largest), kLetters[a], axes_[a].more(), machine_.path,
                      mm_per_min_from_mm_per_s(machine_.axis[a].max_velocity_mm_per_s),
                      static_cast<char>(kLetters[a] - 'A' + 'a')));
    }
    spindle_ = {};
    axes_ = {};
  }

  const machine::Machine& machine_;
  const nc::Program& program_;
  const nc::Interpretation& moves_;
  Diagnostics& diagnostics_;
  std::array<bool, 3> said_missing_{};
  Clamped spindle_;
  std::array<Clamped, 3> axes_{};
};

bool has_spindle(const nc::Interpretation& moves) {
  return std::ranges::any_of(moves.states, [](const nc::ModalState& s) {
    return s.spindle != nc::SpindleDirection::stopped || s.spindle_speed_rpm > 0;
  });
}

}  // namespace

bool starts_spindle(const nc::Interpretation& moves) {
  return std::ranges::any_of(moves.events, [](const nc::Event& e) {
    return e.kind == nc::EventKind::spindle_clockwise || e.kind == nc::EventKind::spindle_counter_clockwise;
  });
}

bool machine_may_start_spindle(const nc::Interpretation& moves) {
  // Those that controls have in common: stops, tools, coolant, clamps, gears, overrides, pallets, subprograms.
  constexpr std::array kCommon{0,  1,  2,  6,  7,  8,  9,  10, 11, 17, 19, 30, 40, 41, 42, 43, 44,
                               45, 48, 49, 50, 51, 60, 70, 88, 89, 91, 92, 94, 96, 97, 98, 99};
  return !starts_spindle(moves) && std::ranges::any_of(moves.events, [&](const nc::Event& e) {
    return e.kind == nc::EventKind::m_code && std::ranges::find(kCommon, static_cast<int>(e.value)) == kCommon.end();
  });
}

void check_machine(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                   Diagnostics& diagnostics) {
  MachineCheck(machine, program, moves, diagnostics).run();
}

void check_feeds(const nc::Program& program, const nc::Interpretation& moves, Diagnostics& diagnostics) {
  constexpr double kAbsurd_mm_per_min = 100000;
  const nc::Move* first = nullptr;
  double fastest = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < moves.moves.size(); ++i) {
    const nc::Move& m = moves.moves[i];
    const double feed = mm_per_min_from_mm_per_s(m.feed_mm_per_s);
    if (!cuts(m) || m.reference || feed <= kAbsurd_mm_per_min || nc::only_turns(moves, i)) continue;
    if (!first) first = &m;
    fastest = std::max(fastest, feed);
    ++count;
  }
  if (!first) return;
  diagnostics.add(program.source.diagnostic(
      Severity::warning, program.blocks[first->block].offset,
      fmt::format(
          "the feed is {:.0f} mm/min{}; no more than {:g} was expected of a milling machine (unit? G93 or G95?)",
          fastest, count > 1 ? fmt::format(" at most in this move and {} more", count - 1) : std::string(),
          kAbsurd_mm_per_min),
      "feed-absurd"));
}

bool withdraws(const nc::Interpretation& moves, const nc::Move& move) {
  return move.kind == nc::MoveKind::linear && nc::direction_at(moves, move, 0).isApprox(Vec3::UnitZ(), kStill_mm);
}

void check_spindle(const nc::Program& program, const nc::Interpretation& moves, Diagnostics& diagnostics) {
  const auto say = [&](const nc::Move& m, Severity severity, std::string message, const char* check) {
    diagnostics.add(program.source.diagnostic(severity, program.blocks[m.block].offset, std::move(message), check));
  };
  std::set<std::tuple<int, double, nc::SpindleDirection>> said;
  for (const nc::Move& m : moves.moves) {
    if (!cuts(m) || m.reference || withdraws(moves, m)) continue;
    const nc::ModalState& s = moves.state_of(m);
    const bool taps = m.cycle == 74 || m.cycle == 84;
    if (taps || !said.insert({s.tool, s.spindle_speed_rpm, s.spindle}).second) continue;
    if (!has_spindle(moves))
      return say(m, Severity::warning,
                 "the program never starts a spindle; S above zero and M3 were expected, unless it runs in air",
                 "spindle-stopped");
    if (s.spindle_speed_rpm > 0 && machine_may_start_spindle(moves))
      return say(m, Severity::warning, kSpindleAssumed, "spindle-assumed");
    if (s.spindle == nc::SpindleDirection::stopped || s.spindle_speed_rpm <= 0)
      say(m, Severity::error,
          fmt::format("T{} cuts here with the spindle {}; S above zero and M3 were expected", s.tool,
                      s.spindle_speed_rpm <= 0 ? "at S0" : "stopped"),
          "spindle-stopped");
    else if (s.spindle == nc::SpindleDirection::counter_clockwise)
      // Without a tool number nobody knows what stands in the spindle.
      say(m, s.tool == 0 ? Severity::warning : Severity::error,
          fmt::format("T{} cuts here under M4, but cutters are right-hand; M3 was expected", s.tool),
          "spindle-direction");
  }
}

}  // namespace camber::motion
