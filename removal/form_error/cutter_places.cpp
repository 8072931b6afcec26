#include "removal/form_error.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace camber::removal {

void CutterPlaces::add(std::int32_t first_id, const CutterShape& shape, std::span<const Stamp> stamps) {
  assert(runs_.empty() || first_id >= runs_.back().first_id + static_cast<std::int32_t>(runs_.back().size()));
  Run run{first_id, shape, {}, {}};
  if (all_upright(stamps)) {
    run.tips.reserve(stamps.size());
    for (const Stamp& s : stamps) run.tips.push_back(s.pose.tip_mm);
  } else {
    run.poses.reserve(stamps.size());
    for (const Stamp& s : stamps) run.poses.push_back(s.pose);
  }
  runs_.push_back(std::move(run));
}

const CutterPlaces::Run* CutterPlaces::find(std::int32_t id) const {
  const auto after = std::ranges::upper_bound(runs_, id, {}, &Run::first_id);
  if (after == runs_.begin()) return nullptr;
  const Run& run = *std::prev(after);
  return id - run.first_id < static_cast<std::int32_t>(run.size()) ? &run : nullptr;
}

double CutterPlaces::distance_mm(std::int32_t id, const Vec3& point) const {
  const Run* run = find(id);
  return run->shape.distance_mm(point_in_tool(run->pose_of(id), point));
}

Vec3 CutterPlaces::gradient(std::int32_t id, const Vec3& point) const {
  const Run* run = find(id);
  const ToolPose pose = run->pose_of(id);
  return direction_in_part(pose, run->shape.gradient(point_in_tool(pose, point)));
}

CutterPlaces::Depth CutterPlaces::deepest_from(std::int32_t id, const Vec3& point) const {
  const Run* run = find(id);
  const auto depth = [&](std::ptrdiff_t k) {
    return -run->shape.distance_mm(point_in_tool(run->pose(static_cast<std::size_t>(k)), point));
  };
  const auto last = static_cast<std::ptrdiff_t>(run->size()) - 1;
  std::ptrdiff_t at = id - run->first_id;
  double deepest = depth(at);
  for (const std::ptrdiff_t way : {-1, 1}) {
    const std::ptrdiff_t start = at;
    for (std::ptrdiff_t k = start + way; k >= 0 && k <= last; k += way) {
      const double d = depth(k);
      if (!(d > deepest)) break;
      deepest = d;
      at = k;
    }
    if (at != start) break;
  }
  return {run->first_id + static_cast<std::int32_t>(at), deepest};
}

}  // namespace camber::removal
