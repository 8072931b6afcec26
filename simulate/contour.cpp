#include "simulate/contour.h"

#include <algorithm>

#include "base/stage.h"
#include "feedmodel/timed_path.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"

namespace camber::simulate {
namespace {

constexpr std::size_t kStretch = 1500;  // stamps marked together

/// Marks need the cutter's shape alone: a table without bending has no use for rings.
removal::EnvelopeGrid outline_of(const machine::Tool& tool) {
  removal::EnvelopeGrid out;
  out.shape = removal::shape_of(tool);
  out.flutes = tool.flutes;
  out.steps = tool.flutes;
  out.steps_per_pitch = 1;
  return out;
}

void mark_straight(removal::SurfaceMap& map, const removal::EnvelopeGrid& outline,
                   std::span<const removal::Stamp> stamps, std::int32_t first_id, Stage* stage) {
  for (std::size_t from = 0; from < stamps.size(); from += kStretch) {
    const std::size_t count = std::min(kStretch, stamps.size() - from);
    map.mark(outline, stamps.subspan(from, count), removal::DeflectionTable(count, 1, {0.0}),
             first_id + static_cast<std::int32_t>(from));
    if (stage) stage->advance(count);
  }
}

}  // namespace

void mark_contour(const machine::Job& job, const removal::StampPath& path, Target& target) {
  removal::SurfaceMap& map = *target.map;
  Stage stage("marking the path of the machine", path.stamps.size());
  for (const auto& run : path.runs)
    mark_straight(map, outline_of(job.tools.at(run.tool)), std::span(path.stamps).subspan(run.from, run.count),
                  static_cast<std::int32_t>(run.from), &stage);
  target.contour_mm = map.take_errors_mm();
}

namespace {

/// The path's contour error, where a machine runs it.
std::vector<float> contour_of(const machine::Job& job, const SimulatedProgram& program, const nc::Interpretation& moves,
                              const machine::Machine& machine, Target& target) {
  removal::StampBuilder builder(moves, job.tools, program.selected, program.holes);
  feedmodel::predict_feed(moves, machine, [&](std::span<const feedmodel::TimedSample> run) { builder.add(run); });
  std::vector<float> own = std::move(target.contour_mm);
  mark_contour(job, builder.take(), target);
  std::swap(own, target.contour_mm);
  return own;
}

void stop_exactly(machine::Control& control) {
  control.corner = {.law = machine::CornerLaw::exact_stop};
  control.merge_tolerance_mm = 0;
}

machine::Machine stopping(machine::Machine machine) {
  stop_exactly(machine.control);
  for (auto& [name, control] : machine.modes) stop_exactly(control);
  return machine;
}

nc::Interpretation stopping(nc::Interpretation moves) {
  for (nc::ModalState& state : moves.states) {
    state.path_control = nc::PathControl::exact_stop;
    state.merge_tolerance_mm = 0;
  }
  return moves;
}

machine::Machine without_lag(machine::Machine machine) {
  for (machine::Axis& axis : machine.axis) {
    axis.filter_s = axis.exponential_1_s = axis.exponential_2_s = axis.velocity_lag_s = 0;
    axis.position_gain_per_s = machine::kNoLimit;
  }
  return machine;
}

double p95_um(const std::vector<float>& contour_mm, std::span<const removal::SurfacePoint> points) {
  std::vector<double> um, area;
  for (std::size_t i = 0; i < points.size(); ++i) {
    um.push_back(1000 * static_cast<double>(contour_mm[i]));
    area.push_back(points[i].area_mm2);
  }
  return removal::error_figures(um, area).p95;
}

}  // namespace

void part_contour(const machine::Job& job, const SimulatedProgram& program, Target& target) {
  if (program.turns() || p95_um(target.contour_mm, target.map->points()) < kWorthParting_um) return;
  target.contour_parts.emplace();
  target.contour_parts->lag_mm =
      contour_of(job, program, stopping(program.moves_in_part()), stopping(job.machine), target);
  target.contour_parts->path_tolerance_mm =
      contour_of(job, program, program.moves_in_part(), without_lag(job.machine), target);
}

void mark_contour_of(const machine::Job& job, const motion::PathStretch& path, const motion::StretchPiece& piece,
                     removal::SurfaceMap& map) {
  mark_straight(map, outline_of(job.tools.at(path.run_of(piece).tool)), path.stamps_of(piece),
                static_cast<std::int32_t>(path.begin_of(piece)), nullptr);
}

}  // namespace camber::simulate
