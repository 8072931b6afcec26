#include "simulate/region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/stage.h"
#include "checks/tool_outline.h"
#include "motion/operations.h"
#include "nc/move.h"
#include "removal/cutter.h"
#include "removal/engagement.h"
#include "removal/tool_path.h"

namespace camber::simulate {
namespace {

using removal::Stamp;

/// Returns the distance of the samples: between two places of its path a tool leaves a ridge of d^2 / 8 R.
double sample_spacing_mm(const machine::Tool& tool) {
  constexpr double kRidge_mm = 0.001, kMin_mm = 0.02, kMax_mm = 0.2;
  const double corner = removal::shape_of(tool).corner_radius_mm;
  const double radius = corner > 0 ? corner : tool.diameter_mm / 2;
  return std::clamp(std::sqrt(8 * radius * kRidge_mm), kMin_mm, kMax_mm);
}

machine::Box box_of(std::span<const removal::SurfacePoint> points) {
  machine::Box out{Vec3::Constant(1e9), Vec3::Constant(-1e9)};
  for (const auto& p : points) {
    out.min_mm = out.min_mm.cwiseMin(p.place_mm);
    out.max_mm = out.max_mm.cwiseMax(p.place_mm);
  }
  return out;
}

/// The commanded sweep of the moves that the job leaves out, as far as it comes near the job's surface.
class OtherMoves {
 public:
  OtherMoves(const machine::Job& job, const SimulatedProgram& program, const machine::Box& surface)
      : job_(job), program_(program), surface_(surface) {
    const auto& moves = program.moves_in_part().moves;
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (program.selected[i]) offsets_.insert(program.moves_in_part().state_of(moves[i]).work_offset);
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (left_out(i)) add(static_cast<std::uint32_t>(i));
  }

  bool empty() const { return runs_.empty(); }

  /// Carves them out of `stock`; the ids of their stamps, and the cutters by these ids.
  removal::CutterPlaces sweep_through(removal::Stock& stock) const {
    removal::CutterPlaces places;
    std::int32_t first_id = 0;
    std::size_t stamps = 0;
    for (const Run& run : runs_) stamps += run.stamps.size();
    Stage stage("cutting the other moves", stamps);
    for (const Run& run : runs_) {
      const machine::Tool& tool = job_.tools.at(run.tool);
      removal::sweep(stock, removal::shape_of(tool), run.stamps, {.first_id = first_id, .stage = &stage});
      places.add(first_id, removal::shape_of(tool), run.stamps);
      first_id += static_cast<std::int32_t>(run.stamps.size());
    }
    return places;
  }

 private:
  struct Run {
    int tool = 0;
    std::vector<Stamp> stamps;
  };

  bool left_out(std::size_t i) const {
    const nc::Move& m = program_.moves_in_part().moves[i];
    if (program_.selected[i] || program_.holes[i] != removal::HoleMove::none || m.reference) return false;
    if (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) return false;
    const nc::ModalState& state = program_.moves_in_part().state_of(m);
    return job_.tools.contains(state.tool) && offsets_.contains(state.work_offset);
  }

  bool near(const ToolPose& pose, const machine::Tool& tool_of_pose) const {
    const Vec3 &lo = surface_.min_mm, &hi = surface_.max_mm, &tip = pose.tip_mm;
    const double radius_mm = tool_of_pose.diameter_mm / 2;
    if (!pose.upright()) {
      const double reach_mm = tool_of_pose.overhang_mm + radius_mm;
      return (tip.cwiseMax(lo).cwiseMin(hi) - tip).norm() < reach_mm;
    }
    return tip.z() < hi.z() && tip.x() + radius_mm > lo.x() && tip.x() - radius_mm < hi.x() &&
           tip.y() + radius_mm > lo.y() && tip.y() - radius_mm < hi.y();
  }

  void add(std::uint32_t move) {
    const nc::Move& m = program_.moves_in_part().moves[move];
    const int number = program_.moves_in_part().state_of(m).tool;
    const machine::Tool& tool = job_.tools.at(number);
    const kinematics::PartPath* part = program_.part_path();
    // A turn moves the cutter's upper end most.
    const double length = part ? part->length_mm(move) + tool.overhang_mm * part->turn_rad(move)
                               : nc::length_mm(program_.moves_in_part(), m);
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(length / sample_spacing_mm(tool))));
    for (std::size_t k = 0; k <= steps; ++k) {
      Stamp stamp;
      stamp.pose = program_.pose_at(move, static_cast<double>(k) / static_cast<double>(steps));
      if (!near(stamp.pose, tool)) continue;
      if (runs_.empty() || runs_.back().tool != number) runs_.push_back({number, {}});
      runs_.back().stamps.push_back(stamp);
    }
  }

  const machine::Job& job_;
  const SimulatedProgram& program_;
  const machine::Box surface_;
  std::set<int> offsets_;
  std::vector<Run> runs_;
};

/// How far a point lies inside the sweep that set the voxels around it. A point whose surroundings have become air for
/// more than a voxel and a half has no stamps there: that much is certain, whatever the field rounds.
double depth_mm(const removal::Stock& swept, const removal::CutterPlaces& places, const Vec3& point) {
  const double certain_mm = 1.5 * swept.voxel_mm(), from_field_mm = swept.distance_mm(point);
  if (from_field_mm > certain_mm) return from_field_mm;
  constexpr int kSide = 2;
  removal::Index3 first{};
  for (int a = 0; a < 3; ++a)
    first[static_cast<std::size_t>(a)] = static_cast<int>(std::floor(point[a] / swept.voxel_mm()));
  std::array<float, kSide * kSide * kSide> distance{};
  std::array<std::int32_t, kSide * kSide * kSide> stamps{};
  swept.read(first, kSide, distance.data(), stamps.data());
  double deepest = 0;
  for (const std::int32_t id : std::set<std::int32_t>(stamps.begin(), stamps.end()))
    if (places.knows(id)) deepest = std::max(deepest, places.deepest_from(id, point).depth_mm);
  return deepest;
}

void mark_border(const machine::Job& job, const SimulatedProgram& program,
                 std::span<const removal::SurfacePoint> points, Target& target) {
  const OtherMoves others(job, program, box_of(points));
  if (others.empty()) return;
  removal::Stock swept(target.surface);
  swept.clear_stamps();
  const removal::CutterPlaces places = others.sweep_through(swept);
  std::vector<bool> border(points.size(), false);
  Stage stage("comparing with the other moves", points.size());
  double area = 0, whole = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    stage.advance();
    whole += points[i].area_mm2;
    if (depth_mm(swept, places, points[i].place_mm) <= kBorder_mm) continue;
    border[i] = true;
    area += points[i].area_mm2;
  }
  target.region.between = area > kBetween * whole;
  if (target.region.between || area == 0) return;
  target.region.left_out = std::move(border);
  target.region.border_mm2 = area;
}

void mark_not_judged(const machine::Operations& judged, const SimulatedProgram& program,
                     std::span<const removal::SurfacePoint> points, Target& target) {
  const std::vector<bool> named = removal::selected_moves(
      program.moves_in_part(), motion::as_lines(judged, program.text(), program.moves_in_part()));
  SurfaceRegion& region = target.region;
  if (region.left_out.empty()) region.left_out.assign(points.size(), false);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t stamp = points[i].target_stamp;
    const bool known = stamp >= 0 && static_cast<std::size_t>(stamp) < target.stamps.size();
    if (region.left_out[i] || (known && named[target.stamps[static_cast<std::size_t>(stamp)].move])) continue;
    region.left_out[i] = true;
    region.not_judged_mm2 += points[i].area_mm2;
  }
}

}  // namespace

void mark_region(const machine::Job& job, const SimulatedProgram& program,
                 std::span<const removal::SurfacePoint> points, Target& target) {
  mark_border(job, program, points, target);
  if (job.part.judged) mark_not_judged(*job.part.judged, program, points, target);
}

void drop_left_out(const SurfaceRegion& region, std::vector<removal::SurfacePoint>& surface) {
  if (region.left_out.empty()) return;
  std::size_t i = 0;
  std::erase_if(surface, [&](const removal::SurfacePoint&) { return static_cast<bool>(region.left_out[i++]); });
}

}  // namespace camber::simulate
