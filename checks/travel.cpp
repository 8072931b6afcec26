#include "checks/travel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "kinematics/travel_check.h"

namespace camber::checks {
namespace {

constexpr char kAxisName[] = "XYZ";

/// Lowest and highest place of an axis during a move.
std::array<double, 2> extent_of(const nc::Interpretation& moves, const nc::Move& m, int axis) {
  std::array<double, 2> out{std::min(m.start_mm[axis], m.end_mm[axis]), std::max(m.start_mm[axis], m.end_mm[axis])};
  if (m.kind != nc::MoveKind::arc) return out;
  constexpr int kSteps = 32;
  for (int i = 1; i < kSteps; ++i) {
    const double x = nc::point_at(moves, m, static_cast<double>(i) / kSteps)[axis];
    out = {std::min(out[0], x), std::max(out[1], x)};
  }
  return out;
}

}  // namespace

void check_travel(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                  Diagnostics& diagnostics) {
  const auto& offset = job.compensation.work_offset_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& travel = job.machine.axis[static_cast<std::size_t>(axis)].travel_mm;
    if (!std::isfinite(travel[0]) && !std::isfinite(travel[1])) continue;
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (const nc::Move& m : moves.moves) {
      if (m.reference) continue;
      const auto [low, high] = extent_of(moves, m, axis);
      least = std::min(least, low);
      greatest = std::max(greatest, high);
      const double zero = offset ? (*offset)[axis] : 0;
      const bool out =
          offset ? low + zero < travel[0] || high + zero > travel[1] : greatest - least > travel[1] - travel[0];
      if (!out) continue;
      diagnostics.add(program.source.diagnostic(
          Severity::error, program.blocks[m.block].offset,
          offset ? fmt::format("{} goes to {:.4f} in machine coordinates here; the axis travels from {:g} to {:g}",
                               kAxisName[axis], low + zero < travel[0] ? low + zero : high + zero, travel[0], travel[1])
                 : fmt::format("the program needs {:.4f} mm of {} up to here; the axis has {:g} mm of travel",
                               greatest - least, kAxisName[axis], travel[1] - travel[0]),
          "travel"));
      break;
    }
  }
}

void check_travel(const machine::Job& job, const motion::SimulatedProgram& program, Diagnostics& diagnostics) {
  if (program.turns())
    kinematics::check_travel(job.machine, program.text(), program.moves_in_program(), diagnostics);
  else
    check_travel(job, program.text(), program.moves_in_part(), diagnostics);
}

}  // namespace camber::checks
