#include "motion/job_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>

#include "base/units.h"
#include "deflection/beam.h"
#include "machine/machine_presets.h"
#include "motion/machine_checks.h"

namespace camber::motion {
namespace {

using removal::HoleMove;

/// First cutting move of every (tool, spindle speed, direction, kind); later ones repeat what was said.
using Key = std::tuple<int, double, nc::SpindleDirection, HoleMove>;
std::map<Key, const nc::Move*> first_moves(const nc::Interpretation& moves, const std::vector<bool>& selected,
                                           const std::vector<HoleMove>& holes) {
  std::map<Key, const nc::Move*> out;
  for (std::size_t i = 0; i < moves.moves.size(); ++i) {
    if (!selected[i] && !removal::makes_hole(holes[i])) continue;
    const auto& s = moves.state_of(moves.moves[i]);
    if (s.spindle == nc::SpindleDirection::stopped && withdraws(moves, moves.moves[i])) continue;
    out.try_emplace({s.tool, s.spindle_speed_rpm, s.spindle, holes[i]}, &moves.moves[i]);
  }
  return out;
}

/// Names the move in a message: "cuts here", or its cycle.
std::string deed(const nc::Move& move, HoleMove hole) {
  if (hole == HoleMove::none) return "cuts here";
  const char* verb = hole == HoleMove::tapped ? "taps" : "drills";
  return move.cycle == 0 ? fmt::format("{} here", verb) : fmt::format("{} here (G{})", verb, move.cycle);
}

/// One warning a code.
void warn_of_not_carved(const nc::Program& program, const nc::Interpretation& moves, const std::vector<HoleMove>& holes,
                        Diagnostics& diagnostics) {
  std::set<int> said;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const nc::Move& move = moves.moves[i];
    if (holes[i] != HoleMove::not_carved || !said.insert(move.cycle).second) continue;
    diagnostics.add(program.source.diagnostic(
        Severity::warning, program.blocks[move.block].offset,
        fmt::format("the holes of G{} are not carved; a cycle that feeds straight down along Z was expected",
                    move.cycle),
        "cycle-not-carved"));
  }
}

void warn_of_vibration(const machine::Tool& tool, double rpm, const nc::Program& program, std::size_t offset,
                       Diagnostics& diagnostics) {
  constexpr double kSteelDensity = 7850, kCarbideDensity = 14500, kSteelLimit_MPa = 300000;
  const double density = tool.youngs_modulus_MPa > kSteelLimit_MPa ? kCarbideDensity : kSteelDensity;
  const double first_hz = deflection::beam_of(tool).first_frequency_hz(tool, density);
  const double tooth_hz = rpm / 60 * tool.flutes;
  if (tooth_hz <= first_hz / 3) return;
  diagnostics.add(
      program.source.diagnostic(Severity::warning, offset,
                                fmt::format("T{} passes {:.0f} teeth a second, more than a third of its first natural "
                                            "frequency of about {:.0f} Hz: a static deflection is no longer valid",
                                            tool.number, tooth_hz, first_hz),
                                "tooth-frequency"));
}

double usual_rpm(const machine::Tool& tool, double feed_mm_per_min) {
  constexpr double kMin_rpm = 1000, kMax_rpm = 12000, kStep_rpm = 100;
  const double chip_mm = std::clamp(0.006 * tool.diameter_mm, 0.02, 0.1);
  const double rpm = feed_mm_per_min / (std::max(tool.flutes, 1) * chip_mm);
  return kStep_rpm * std::round(std::clamp(rpm, kMin_rpm, kMax_rpm) / kStep_rpm);
}

}  // namespace

void assume_spindle(const machine::Job& job, const nc::Program& program, nc::Interpretation& moves,
                    Diagnostics& diagnostics) {
  const bool starts = starts_spindle(moves);
  if (starts && !machine::is_preset(job.machine.path)) return;
  const auto cuts = [](const nc::Move& m) { return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc; };
  if (std::ranges::any_of(moves.states, [](const nc::ModalState& s) { return s.spindle_speed_rpm > 0; })) {
    if (!starts && !machine_may_start_spindle(moves)) return;
    // On a machine of a class also a tool behind M5 that never gets M3.
    std::set<int> running;
    for (const nc::Move& m : moves.moves)
      if (const auto& state = moves.state_of(m); cuts(m) && state.spindle != nc::SpindleDirection::stopped)
        running.insert(state.tool);
    const auto to_start = [&](const nc::ModalState& state) {
      return state.spindle_speed_rpm > 0 && !running.contains(state.tool);
    };
    const auto first =
        std::ranges::find_if(moves.moves, [&](const nc::Move& m) { return cuts(m) && to_start(moves.state_of(m)); });
    if (first == moves.moves.end()) return;
    diagnostics.add(program.source.diagnostic(
        Severity::warning, program.blocks[first->block].offset,
        starts ? fmt::format("no M3 starts the spindle for T{}; it is assumed to turn clockwise at the S before",
                             moves.state_of(*first).tool)
               : kSpindleAssumed,
        "spindle-assumed"));
    for (nc::ModalState& state : moves.states)
      if (to_start(state)) state.spindle = nc::SpindleDirection::clockwise;
    return;
  }
  std::map<int, double> feeds_mm_per_min;
  const nc::Move* first = nullptr;
  for (const nc::Move& m : moves.moves) {
    const int tool = moves.state_of(m).tool;
    if (!cuts(m) || !job.tools.contains(tool)) continue;
    if (!first) first = &m;
    double& feed = feeds_mm_per_min[tool];
    feed = std::max(feed, mm_per_min_from_mm_per_s(m.feed_mm_per_s));
  }
  if (!first) return;
  for (nc::ModalState& s : moves.states) {
    const auto feed = feeds_mm_per_min.find(s.tool);
    if (feed == feeds_mm_per_min.end()) continue;
    s.spindle_speed_rpm = usual_rpm(job.tools.at(s.tool), feed->second);
    s.spindle = nc::SpindleDirection::clockwise;
  }
  std::string speeds;
  for (const auto& [tool, feed] : feeds_mm_per_min)
    speeds +=
        fmt::format("{}{:.0f} rpm for T{}", speeds.empty() ? "" : ", ", usual_rpm(job.tools.at(tool), feed), tool);
  diagnostics.add(program.source.diagnostic(
      Severity::warning, program.blocks[first->block].offset,
      fmt::format("the program names no spindle speed; by the feed, {} are assumed; S in the program was expected",
                  speeds),
      "spindle-assumed"));
}

void check_cutting(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                   const std::vector<bool>& selected, const std::vector<HoleMove>& holes, Diagnostics& diagnostics) {
  const auto firsts = first_moves(moves, selected, holes);
  if (firsts.empty())
    diagnostics.add({Severity::error,
                     {program.source.name(), 0, 0},
                     "no line, arc or hole belongs to the job's operations; a tool and a range that cut were expected",
                     "nothing-to-cut",
                     {}});
  for (const auto& [key, move] : firsts) {
    const auto& [number, rpm, direction, hole] = key;
    const std::size_t offset = program.blocks[move->block].offset;
    const auto error = [&](std::string message, const char* check) {
      diagnostics.add(program.source.diagnostic(Severity::error, offset, std::move(message), check));
    };
    const auto tool = job.tools.find(number);
    if (tool == job.tools.end()) {
      error(hole == HoleMove::none
                ? fmt::format("T{} cuts here, but the job has no [tool.{}]", number, number)
                : fmt::format("T{} {}, but the job has no [tool.{}]; its type, diameter_mm, flutes and overhang_mm, or "
                              "operations without it, were expected",
                              number, deed(*move, hole), number),
            "tool-missing");
      continue;
    }
    if (tool->second.type == machine::ToolType::drill && hole == HoleMove::none)
      error(fmt::format("T{} is a drill in the job, but mills here; ball, flat or bull was expected", number),
            "tool-type");
    const bool stopped = direction == nc::SpindleDirection::stopped && hole != HoleMove::tapped;
    if (stopped || rpm <= 0)
      error(fmt::format("T{} {} with the spindle {}; S above zero and M3 were expected", number, deed(*move, hole),
                        rpm <= 0 ? "at S0" : "stopped"),
            "spindle-stopped");
    else if (direction == nc::SpindleDirection::counter_clockwise && hole != HoleMove::tapped)
      error(fmt::format("T{} {} under M4, but cutters are right-hand; M3 was expected", number, deed(*move, hole)),
            "spindle-direction");
    else if (hole == HoleMove::none)
      warn_of_vibration(tool->second, rpm, program, offset, diagnostics);
  }
  warn_of_not_carved(program, moves, holes, diagnostics);
}

}  // namespace camber::motion
