#include "compensate/attribution.h"

#include <cmath>
#include <map>
#include <optional>

#include "compensate/hidden_rows.h"
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
    if (compensated[i] && !points[i].above) out.push_back(points[i]);
  out.insert(out.end(), hidden.begin(), hidden.end());
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

double foreign_fraction(const Observed& observed) {
  double foreign = 0, area = 0;
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.judged(i)) continue;
    area += observed.points[i].area_mm2;
    if (observed.points[i].foreign) foreign += observed.points[i].area_mm2;
  }
  return area > 0 ? foreign / area : 0;
}

namespace {

constexpr double kHidden_mm = 0.0005;  // above the surface: the owner did not cut there

/// The tool at a place of a path.
struct ToolAt {
  Vec3 tip_mm, axis;
  const machine::Tool* tool = nullptr;  ///< null: not one of the job's
};

ToolAt tool_at(const ShiftPath::PointInterval& place, const ShiftPath& path, const machine::Job& job,
               const simulate::SimulatedProgram& given) {
  const ControlPoint &from = path.points()[place.lower], &to = path.points()[place.lower + 1];
  const auto tool = job.tools.find(given.moves_in_part().state_of(given.moves_in_part().moves[to.move]).tool);
  const double from_fraction = from.move == to.move ? from.fraction : 0;
  return {from.place_mm + place.upper_fraction * (to.place_mm - from.place_mm),
          given.pose_at(to.move, from_fraction + place.upper_fraction * (to.fraction - from_fraction)).axis,
          tool == job.tools.end() ? nullptr : &tool->second};
}

/// Surface points as places of one path.
class Places {
 public:
  Places(const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given,
         const simulate::SimulatedProgram& emitted, const nc::MoveMap& map,
         std::span<const simulate::PathFraction> own_target, const std::vector<bool>& first_cuts)
      : path_(path),
        job_(job),
        given_(given),
        emitted_(emitted),
        map_(map),
        own_target_(own_target),
        first_cuts_(first_cuts) {}

  /// Returns nothing where the point's stamp belongs to no move that may be shifted.
  std::optional<ShiftPath::PointInterval> machined(const removal::SurfacePoint& p) const {
    if (!was_cut(p)) return std::nullopt;
    const auto& stamp = emitted_.path.stamps[static_cast<std::size_t>(p.machined_stamp)];
    return find(map_.given(stamp.move, stamp.fraction));
  }
  std::optional<ShiftPath::PointInterval> owner(const removal::SurfacePoint& p) const {
    if (p.target_stamp < 0 || static_cast<std::size_t>(p.target_stamp) >= own_target_.size()) return std::nullopt;
    const auto& stamp = own_target_[static_cast<std::size_t>(p.target_stamp)];
    const auto place = find({stamp.move, static_cast<double>(stamp.fraction)});
    return place && flutes_reach(*place, p) ? place : std::nullopt;
  }
  /// Where a first cut was the last to cut: the place of its run that cuts again there, or should.
  std::optional<ShiftPath::PointInterval> recut(const removal::SurfacePoint& p) const {
    if (was_cut(p) || p.machined_stamp < 0) return std::nullopt;
    const auto& stamp = emitted_.path.stamps[static_cast<std::size_t>(p.machined_stamp)];
    std::uint32_t move = map_.given(stamp.move, stamp.fraction).move;
    while (move < first_cuts_.size() && !path_.contains(move)) ++move;
    if (move >= first_cuts_.size()) return std::nullopt;
    const std::size_t start = path_.find(move, 0).lower;
    const auto chain = std::ranges::find_if(
        path_.chains(), [&](const ShiftChain& c) { return start >= c.from && start < c.from + c.count; });
    const auto& points = path_.points();
    std::size_t nearest = chain->from;
    for (std::size_t i = chain->from; i + 1 < chain->from + chain->count; ++i)
      if ((points[i].place_mm - stamp.pose.tip_mm).norm() < (points[nearest].place_mm - stamp.pose.tip_mm).norm())
        nearest = i;
    return ShiftPath::PointInterval{nearest, 0};
  }
  bool was_cut(const removal::SurfacePoint& p) const {
    if (p.machined_stamp < 0 || static_cast<std::size_t>(p.machined_stamp) >= emitted_.path.stamps.size()) return false;
    if (first_cuts_.empty()) return true;
    const auto& stamp = emitted_.path.stamps[static_cast<std::size_t>(p.machined_stamp)];
    return !first_cuts_[map_.given(stamp.move, stamp.fraction).move];
  }

 private:
  /// The nominal sweep is that of a cutter which is fluted all the way: a row far below passes on the same surface.
  bool flutes_reach(const ShiftPath::PointInterval& place, const removal::SurfacePoint& p) const {
    const ToolAt at = tool_at(place, path_, job_, given_);
    return !at.tool || !at.tool->flute_length_mm || (p.place_mm - at.tip_mm).dot(at.axis) <= *at.tool->flute_length_mm;
  }
  std::optional<ShiftPath::PointInterval> find(const nc::MoveMap::MovePlace& at) const {
    if (!path_.contains(at.move) || !given_.moves_in_part().moves[at.move].editable) return std::nullopt;
    return path_.find(at.move, at.fraction);
  }

  const ShiftPath& path_;
  const machine::Job& job_;
  const simulate::SimulatedProgram &given_, &emitted_;
  const nc::MoveMap& map_;
  std::span<const simulate::PathFraction> own_target_;
  const std::vector<bool>& first_cuts_;
};

}  // namespace

std::optional<ShiftPath::PointInterval> owner_place(const ShiftPath& path, const machine::Job& job,
                                                    const simulate::Setup& given, const removal::SurfacePoint& point) {
  const nc::MoveMap same;
  return Places(path, job, given.program, given.program, same, given.own_stamps(), {}).owner(point);
}

void set_place(Observation& o, const removal::SurfacePoint& point, const ShiftPath::PointInterval& place,
               const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given) {
  o.place = place;
  const ToolAt at = tool_at(place, path, job, given);
  const double corner_mm = at.tool ? removal::shape_of(*at.tool).corner_radius_mm : 0;
  o.from_centre_mm = point.place_mm - at.tip_mm - corner_mm * at.axis;
  o.at_tip = at.tool && round_tip(*at.tool) && o.normal.dot(at.axis) > kTipNormal;
}

Observed observe(const ShiftPath& path, const machine::Job& job, const simulate::SimulatedProgram& given,
                 const simulate::SimulatedProgram& emitted, const nc::MoveMap& map,
                 std::span<const removal::SurfacePoint> surface, const OwnerHints& hints) {
  const auto& [own_target, bending, first_cuts] = hints;
  const Places places(path, job, given, emitted, map, own_target, first_cuts);
  const Rows rows(path);
  Observed out;
  out.points.resize(surface.size());
  out.compensated.assign(surface.size(), false);
  const std::vector<Vec3> offsets = bending.empty() ? std::vector<Vec3>() : path_offsets(path, given, emitted, map);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto& p = surface[i];
    Observation& o = out.points[i];
    o.normal = p.normal;
    if (!p.valid) continue;  // no weight in any fit
    o.error_mm = judged_mm(p, job.compensation.reference);
    o.area_mm2 = p.area_mm2;
    const auto owner = places.owner(p);
    const auto cut = places.machined(p), machined = cut || owner ? cut : places.recut(p);
    o.foreign = owner && machined && rows.differ(*owner, *machined);
    const bool owned = owner && (!places.was_cut(p) || (o.foreign && o.error_mm > 0));
    if (!owned && !machined) continue;
    out.compensated[i] = true;
    o.own = !owned || !o.foreign;
    set_place(o, p, owned ? *owner : *machined, path, job, given);
    if (!o.foreign || bending.empty()) continue;
    Observation above = o;
    above.own = false;
    above.error_mm = expected_error_mm(job, p, *owner, offsets, bending);
    if (above.error_mm <= o.error_mm + kHidden_mm) continue;
    o.above = !o.own;
    set_place(above, p, *owner, path, job, given);
    out.hidden.push_back(above);
  }
  mark_opposed(out);
  return out;
}

}  // namespace camber::compensate
