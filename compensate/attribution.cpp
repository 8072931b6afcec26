#include "compensate/attribution.h"

#include <cmath>
#include <map>

#include "removal/cutter.h"

namespace camber::compensate {
namespace {

constexpr double kTipNormal = 0.985;  // cosine of ten degrees about the axis
constexpr double kOpposed = -0.5;     // cosine between normals that face each other

bool round_tip(const machine::Tool& tool) {
  return tool.type == machine::ToolType::ball || tool.type == machine::ToolType::tapered_ball;
}

/// Marks what was made between the same two points of the path as surface that faces it.
void mark_opposed(Observed& observed) {
  std::map<std::size_t, std::vector<std::size_t>> of_place;
  for (std::size_t i = 0; i < observed.points.size(); ++i)
    if (observed.compensated[i]) of_place[observed.points[i].place.lower].push_back(i);
  for (const auto& [place, members] : of_place) {
    const Vec3 first = observed.points[members.front()].normal;
    const bool faced =
        std::ranges::any_of(members, [&](std::size_t i) { return observed.points[i].normal.dot(first) < kOpposed; });
    if (!faced) continue;
    for (const std::size_t i : members)
      if (std::abs(observed.points[i].normal.dot(first)) > -kOpposed) observed.points[i].opposed = true;
  }
}

}  // namespace

std::vector<Observation> Observed::of_path() const {
  std::vector<Observation> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (compensated[i]) out.push_back(points[i]);
  return out;
}

std::vector<bool> reach_of(const ShiftPath& path, const nc::Interpretation& given, const Observed& first,
                           std::span<const removal::SurfacePoint> surface,
                           std::span<const simulate::PathFraction> own_target) {
  if (own_target.empty()) return first.compensated;
  std::vector<bool> out(surface.size(), false);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::int32_t stamp = surface[i].target_stamp;
    if (stamp < 0 || static_cast<std::size_t>(stamp) >= own_target.size()) continue;
    const std::uint32_t move = own_target[static_cast<std::size_t>(stamp)].move;
    if (path.contains(move) && given.moves[move].editable) out[i] = true;
  }
  return out;
}

Observed observe(const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given,
                 const simulate::SimulatedProgram& emitted, const MoveMap& map,
                 std::span<const removal::SurfacePoint> surface, std::span<const simulate::PathFraction> own_target) {
  Observed out;
  out.points.resize(surface.size());
  out.compensated.assign(surface.size(), false);
  const auto known = [](std::int32_t id, const simulate::SimulatedProgram& p) {
    return id >= 0 && static_cast<std::size_t>(id) < p.path.stamps.size();
  };
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto& p = surface[i];
    Observation& o = out.points[i];
    o.normal = p.normal;
    o.error_mm = judged_mm(p, job.compensation.reference);
    o.area_mm2 = p.area_mm2;
    MoveMap::MovePlace at;
    if (known(p.machined_stamp, emitted)) {
      const auto& stamp = emitted.path.stamps[static_cast<std::size_t>(p.machined_stamp)];
      at = map.given(stamp.move, stamp.fraction);
    } else if (p.target_stamp >= 0 && static_cast<std::size_t>(p.target_stamp) < own_target.size()) {
      const auto& stamp = own_target[static_cast<std::size_t>(p.target_stamp)];
      at = {stamp.move, static_cast<double>(stamp.fraction)};
    } else {
      continue;
    }
    if (!path.contains(at.move) || !given.moves.moves[at.move].editable) continue;
    out.compensated[i] = true;
    o.place = path.find(at.move, at.fraction);
    const auto tool = job.tools.find(given.moves.state_of(given.moves.moves[at.move]).tool);
    const ControlPoint &from = path.points()[o.place.lower], &to = path.points()[o.place.lower + 1];
    const Vec3 tip = from.place_mm + o.place.upper_fraction * (to.place_mm - from.place_mm);
    const double corner_mm = tool != job.tools.end() ? removal::shape_of(tool->second).corner_radius_mm : 0;
    o.from_centre_mm = p.place_mm - tip - corner_mm * Vec3::UnitZ();
    o.at_tip = tool != job.tools.end() && round_tip(tool->second) && p.normal.z() > kTipNormal;
  }
  mark_opposed(out);
  return out;
}

}  // namespace camber::compensate
