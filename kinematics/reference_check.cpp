#include "kinematics/reference_check.h"

#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace camber::kinematics {
namespace {

template <class Point>
double coordinate_mm(const Point& point, int axis) {
  return std::array{point.x_mm, point.y_mm, point.z_mm}.at(static_cast<std::size_t>(axis));
}

}  // namespace

double reference_point_mm(const machine::Machine& machine, std::size_t point, int axis) {
  const double own = point > 0 ? coordinate_mm(machine.reference_points.at(point - 1), axis) : machine::kNoLimit;
  return std::isfinite(own) ? own : coordinate_mm(machine.tool_change, axis);
}

void check_reference_points(const machine::Machine& machine, const nc::Program& program,
                            const nc::Interpretation& moves, Diagnostics& diagnostics) {
  if (moves.rotary.empty()) return;
  const nc::Move* first = nullptr;
  std::string letters, keys;
  std::size_t count = 0;
  for (const nc::MachineTarget& target : moves.machine_targets) {
    const nc::Move& move = moves.moves[target.move];
    bool unknown = false;
    for (int axis = 0; axis < 3; ++axis) {
      const bool goes = (move.reference_axes & target.given & (1U << static_cast<unsigned>(axis))) != 0;
      if (!goes || !std::isnan(target.end_mm[axis]) ||
          std::isfinite(reference_point_mm(machine, move.reference_point, axis)))
        continue;
      unknown = true;
      if (first) continue;
      letters += fmt::format("{}{}", letters.empty() ? "" : " and ", "XYZ"[axis]);
      keys += fmt::format("{}{}_mm", keys.empty() ? "" : ", ", "xyz"[axis]);
    }
    if (!unknown) continue;
    if (!first) first = &move;
    ++count;
  }
  if (!first) return;
  const std::string table = first->reference_point > 0 ? fmt::format("[reference_point.{}]", first->reference_point + 1)
                                                       : std::string("[tool_change]");
  const std::string more = count > 1 ? fmt::format(", like {} more to such points,", count - 1) : std::string();
  diagnostics.add(program.source.diagnostic(
      Severity::warning, program.blocks[first->block].offset,
      fmt::format(
          "{} {} to a reference point that is not known; this move{} takes the time of the shortest way to where "
          "the axes are next known. {} of {} in {} was expected",
          letters, letters.size() > 1 ? "go" : "goes", more, keys, table, machine.path),
      "reference-unknown"));
}

}  // namespace camber::kinematics
