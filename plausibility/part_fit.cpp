#include "plausibility/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>

#include "checks/tool_outline.h"
#include "machine/cutter_parameters.h"
#include "removal/cutter.h"

namespace camber::plausibility {
namespace {

constexpr std::size_t kPlaces = 1500;
constexpr int kAround = 24;

Vec3 on_circle(double radius, double height, int i, int count) {
  const double phi = 2 * kPi * i / count;
  return {radius * std::cos(phi), radius * std::sin(phi), height};
}

using Cutters = std::map<int, CutterSpheres>;

void measure(const removal::PartMesh& part, const Cutters& cutters, const Vec3& shift,
             std::vector<PartFit::Place>& places) {
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    places[i].clearance_mm = clearance_mm(part, cutters.at(places[i].tool), places[i].pose, shift);
  });
}

/// Places of the milling moves at equal distances.
std::vector<PartFit::Place> places_of(const machine::Job& job, const simulate::SimulatedProgram& program) {
  const auto& moves = program.moves_in_part().moves;
  const auto counts = [&](std::size_t i) {
    return program.selected[i] && !moves[i].reference &&
           job.tools.contains(program.moves_in_part().state_of(moves[i]).tool);
  };
  double all = 0;
  for (std::size_t i = 0; i < moves.size(); ++i)
    if (counts(i)) all += nc::length_mm(program.moves_in_part(), moves[i]);
  std::vector<PartFit::Place> out;
  const double apart = all / kPlaces;
  double next = apart / 2, so_far = 0;
  for (std::uint32_t i = 0; i < moves.size() && apart > 0; ++i) {
    if (!counts(i)) continue;
    const double length = nc::length_mm(program.moves_in_part(), moves[i]);
    for (; next < so_far + length; next += apart)
      out.push_back(
          {i, program.pose_at(i, (next - so_far) / length), program.moves_in_part().state_of(moves[i]).tool, 0});
    so_far += length;
  }
  return out;
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double gouging_of(const std::vector<PartFit::Place>& places, double depth_mm = kGouge_mm) {
  const auto count = std::ranges::count_if(places, [&](const auto& p) { return p.clearance_mm < -depth_mm; });
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, places.size()));
}

/// How badly cutters and part touch: passes that leave material count up to kFar_mm.
double misfit(const std::vector<PartFit::Place>& places) {
  constexpr double kFar_mm = 0.5;
  double sum = 0;
  for (const auto& p : places) sum += std::min(kFar_mm, std::abs(p.clearance_mm));
  return sum / static_cast<double>(std::max<std::size_t>(1, places.size()));
}

/// The shift of the part with which the cutters touch it: Gauss and Newton over the places that are near it, whose
/// clearances change along the part's normals. Nothing where none makes it fit.
std::optional<Vec3> find_shift(const removal::PartMesh& part, const Cutters& cutters,
                               const std::vector<PartFit::Place>& all) {
  constexpr std::size_t kUsed = 300;
  constexpr double kStep_mm = 0.01, kBetter = 0.35, kLeast_mm = 0.2;
  constexpr int kRounds = 12;
  std::vector<PartFit::Place> places;
  for (std::size_t i = 0; i < all.size(); i += std::max<std::size_t>(1, all.size() / kUsed)) places.push_back(all[i]);
  const double before = misfit(places);
  Vec3 shift = Vec3::Zero(), best = shift;
  double least = before, reach = 4;
  for (int round = 0; round < kRounds; ++round, reach = std::max(0.3, 0.7 * reach)) {
    measure(part, cutters, shift, places);
    std::array<std::vector<PartFit::Place>, 3> moved{places, places, places};
    for (int a = 0; a < 3; ++a)
      measure(part, cutters, shift + kStep_mm * Vec3::Unit(a), moved[static_cast<std::size_t>(a)]);
    Eigen::Matrix3d normal = 1e-3 * Eigen::Matrix3d::Identity();
    Vec3 right = Vec3::Zero();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double c = places[i].clearance_mm;
      if (std::abs(c) > reach) continue;
      Vec3 slope;
      for (int a = 0; a < 3; ++a) slope[a] = (moved[static_cast<std::size_t>(a)][i].clearance_mm - c) / kStep_mm;
      const double weight = 1 / (0.1 + std::abs(c));
      normal += weight * slope * slope.transpose();
      right -= weight * c * slope;
    }
    shift += normal.ldlt().solve(right);
    measure(part, cutters, shift, places);
    if (const double now = misfit(places); now < least) least = now, best = shift;
  }
  if (best.norm() < kLeast_mm || least > kBetter * before) return std::nullopt;
  measure(part, cutters, best, places);
  if (gouging_of(places) > kGouging) return std::nullopt;
  return best;
}

}  // namespace

CutterSpheres::CutterSpheres(const machine::Tool& tool) {
  const removal::CutterShape shape = removal::shape_of(tool);
  const double r = shape.radius_mm, end = std::min(checks::cutter_end_mm(tool), 6 * r);
  if (shape.general) {
    constexpr int kAlong = 12;
    const double length = shape.profile.length_to_height_mm(end);
    for (int s = 0; s <= kAlong; ++s) {
      const removal::ProfilePoint p = shape.profile.at(length * s / kAlong);
      for (int i = 0; i < (p.radius_mm > 1e-6 ? kAround : 1); ++i)
        spheres.push_back({on_circle(p.radius_mm, p.height_mm, i, kAround), 0});
    }
  } else {
    const double c = shape.corner_radius_mm, flat = r - c;
    if (shape.ball()) {
      spheres.push_back({{0, 0, r}, r});
    } else {
      spheres.push_back({Vec3::Zero(), 0});
      for (int i = 0; i < kAround; ++i) spheres.push_back({on_circle(flat, c, i, kAround), c});
      for (int i = 0; i < kAround / 2; ++i) spheres.push_back({on_circle(flat / 2, 0, i, kAround / 2), 0});
    }
    for (double z = shape.ball() ? 2 * r : r; z <= end; z += r) spheres.push_back({{0, 0, z}, r});
  }
  middle_mm = {0, 0, end / 2};
  for (const Sphere& s : spheres) reach_mm = std::max(reach_mm, (s.centre_mm - middle_mm).norm() + s.radius_mm);
}

double clearance_mm(const removal::PartMesh& part, const CutterSpheres& cutter, const ToolPose& pose,
                    const Vec3& shift) {
  const auto in_part = [&](const Vec3& p) { return Vec3(point_in_part(pose, p) - shift); };
  constexpr double kFar_mm = 20;
  // Far from the part one distance is enough.
  const double around = part.distance_mm(in_part(cutter.middle_mm)) - cutter.reach_mm;
  if (around > kFar_mm) return around;
  double least = 1e9;
  for (const auto& sphere : cutter.spheres)
    least = std::min(least, part.distance_mm(in_part(sphere.centre_mm)) - sphere.radius_mm);
  return least;
}

PartFit fit_part(const machine::Job& job, const simulate::SimulatedProgram& program, const removal::PartMesh& part) {
  PartFit out;
  out.places = places_of(job, program);
  if (out.places.empty()) return out;
  Cutters cutters;
  for (const auto& [number, tool] : job.tools) cutters.try_emplace(number, tool);
  measure(part, cutters, Vec3::Zero(), out.places);
  std::vector<double> clearances;
  for (const PartFit::Place& p : out.places) {
    clearances.push_back(p.clearance_mm);
    if (-p.clearance_mm > out.gouge_mm) out.gouge_mm = -p.clearance_mm, out.gouge_move = p.move;
  }
  out.gouging = gouging_of(out.places);
  out.cutting_in = gouging_of(out.places, kCutIn_mm);
  out.nearest_mm = quantile(clearances, 0.01);
  constexpr double kClear_mm = 0.3;
  if (out.gouging > kGouging || out.cutting_in > kCuttingIn || out.nearest_mm > kClear_mm)
    out.shift_mm = find_shift(part, cutters, out.places);
  return out;
}

}  // namespace camber::plausibility
