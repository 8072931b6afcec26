#include "checks/region_start.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "checks/tool_outline.h"
#include "nc/move.h"
#include "removal/tool_path.h"

namespace camber::checks {
namespace {

bool stands_in(const removal::Stock& stock, const machine::Tool& tool, const ToolPose& pose) {
  constexpr double kStep_mm = 0.5;
  const double height = pose.upright() ? stock.max_mm().z() - pose.tip_mm.z() : tool.overhang_mm;
  for (const OutlineRing& ring : tool_outline(tool, kStep_mm, height)) {
    if (ring.part != OutlineRing::Part::cutter) continue;
    const int n = std::max(1, static_cast<int>(std::ceil(2 * kPi * ring.radius_mm / kStep_mm)));
    for (int i = 0; i < n; ++i) {
      const double phi = 2 * kPi * i / n;
      const Vec3 p =
          point_in_part(pose, {ring.radius_mm * std::cos(phi), ring.radius_mm * std::sin(phi), ring.height_mm});
      if (stock.distance_mm(p) < -stock.voxel_mm()) return true;
    }
  }
  return false;
}

}  // namespace

void check_region_start(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                        Diagnostics& diagnostics) {
  check_region_start(
      job, program, [&](const machine::Tool& tool, const ToolPose& pose) { return stands_in(blank, tool, pose); },
      diagnostics);
}

void check_region_start(const machine::Job& job, const motion::SimulatedProgram& program,
                        const std::function<bool(const machine::Tool&, const ToolPose&)>& in_material,
                        Diagnostics& diagnostics) {
  const auto& moves = program.moves_in_part().moves;
  const auto first = static_cast<std::size_t>(std::ranges::find(program.selected, true) - program.selected.begin());
  if (first == 0 || first >= moves.size()) return;
  const nc::Move &m = moves[first], &before = moves[first - 1];
  const bool cut = before.kind == nc::MoveKind::linear || before.kind == nc::MoveKind::arc;
  const bool known = (cut || before.kind == nc::MoveKind::rapid) && !before.reference &&
                     program.moves_in_part().state_of(before).tool == program.moves_in_part().state_of(m).tool;
  const auto tool = job.tools.find(program.moves_in_part().state_of(m).tool);
  // What holes took out before is not known of the blank.
  const auto holes_end = program.holes.begin() + static_cast<std::ptrdiff_t>(std::min(first, program.holes.size()));
  if (!cut && std::any_of(program.holes.begin(), holes_end, removal::makes_hole)) return;
  if (!known || tool == job.tools.end() ||
      !in_material(tool->second, program.pose_at(static_cast<std::uint32_t>(first), 0)))
    return;
  diagnostics.add(program.text().source.diagnostic(
      Severity::warning, program.text().blocks[m.block].offset,
      fmt::format("the job's operations begin here, {}: T{} stands in material, which is removed without chips; {} was "
                  "expected",
                  cut ? "in the middle of a cut" : "behind a rapid that ends in the stock", tool->first,
                  cut ? "a range that begins at a rapid" : "a stock that leaves the start free"),
      "starts-in-material"));
}

}  // namespace camber::checks
