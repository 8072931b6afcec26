#include "simulate/contour.h"

#include <algorithm>

#include "base/stage.h"
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

void mark_contour_of(const machine::Job& job, const PathStretch& path, const PathPiece& piece,
                     removal::SurfaceMap& map) {
  mark_straight(map, outline_of(job.tools.at(path.run_of(piece).tool)), path.stamps_of(piece),
                static_cast<std::int32_t>(path.begin_of(piece)), nullptr);
}

}  // namespace camber::simulate
