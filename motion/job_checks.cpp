#include "motion/job_checks.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>

#include "deflection/beam.h"
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

/// What the move does to the tool's owner: "cuts", or the cycle.
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

}  // namespace

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
    if (direction == nc::SpindleDirection::stopped || rpm <= 0)
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
