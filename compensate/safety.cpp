#include "compensate/safety.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "compensate/error_split.h"
#include "simulate/cut.h"

namespace camber::compensate {
namespace {

constexpr char kAxisName[] = "XYZ";

void add_point(Depth& out, const removal::SurfacePoint& p, double error_mm, double tolerance_um, double& over) {
  const double deep_um = -1000 * error_mm;
  if (deep_um > out.deepest_um) {
    out.deepest_um = deep_um;
    out.place_mm = p.place_mm;
  }
  if (deep_um > tolerance_um) over += p.area_mm2;
}

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

Depth depth_of(const std::vector<removal::SurfacePoint>& surface, const Observed& observed, double tolerance_um,
               bool compensated) {
  Depth out;
  double over = 0, area = 0;
  std::vector<std::pair<double, double>> depths;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    area += surface[i].area_mm2;
    if (observed.compensated[i] != compensated) continue;
    const double error_mm = observed.points[i].error_mm;
    add_point(out, surface[i], error_mm, tolerance_um, over);
    depths.emplace_back(-1000 * error_mm, surface[i].area_mm2);
  }
  out.gouge_depth_p999_um = depth_p999(std::move(depths), area);
  out.over_fraction = area > 0 ? over / area : 0;
  return out;
}

Depth depth_of(const std::vector<removal::SurfacePoint>& surface, machine::Reference reference, double others_mm2,
               double tolerance_um) {
  Depth out;
  double over = 0, area = others_mm2;
  std::vector<std::pair<double, double>> depths;
  for (const removal::SurfacePoint& p : surface) {
    area += p.area_mm2;
    add_point(out, p, judged_mm(p, reference), tolerance_um, over);
    depths.emplace_back(-1000 * judged_mm(p, reference), p.area_mm2);
  }
  out.gouge_depth_p999_um = depth_p999(std::move(depths), area);
  out.over_fraction = area > 0 ? over / area : 0;
  return out;
}

Depth depth_without_bending(const machine::Job& job, const simulate::Target& target,
                            const simulate::SimulatedProgram& emitted, double tolerance_um) {
  removal::Stock stock(target.blank);
  simulate::sweep_path(stock, job, emitted.path, 0);
  Depth out;
  double over = 0, area = 0;
  std::vector<std::pair<double, double>> depths;
  auto surface = removal::compare_surfaces(stock, target.surface);
  target.holes.drop_from(surface);
  for (const auto& p : surface) {
    area += p.area_mm2;
    add_point(out, p, p.error_mm, tolerance_um, over);
    depths.emplace_back(-1000 * p.error_mm, p.area_mm2);
  }
  out.gouge_depth_p999_um = depth_p999(std::move(depths), area);
  out.over_fraction = area > 0 ? over / area : 0;
  return out;
}

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

}  // namespace camber::compensate
