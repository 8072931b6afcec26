#pragma once
// An upright cut and the same one with stock, path and axis turned together, for tests and bench/tilted.
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "removal/engagement.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"

namespace camber::testing {

inline constexpr double kTiltedVoxel_mm = 0.1, kTiltedFeed_mm = 0.12, kTiltedAllowance_mm = 0.2, kTiltedLength_mm = 6;

inline machine::Tool tool_of(machine::ToolType type) {
  machine::Tool tool = make_tool(type, 6, 2, 30);
  if (type == machine::ToolType::bull) tool.corner_radius_mm = 1;
  if (type == machine::ToolType::tapered_ball) tool.taper_rad = 0.1;
  tool.helix_rad = 0.5;
  return tool;
}

/// Scene for an upright tool: rows along x that climb or follow a plane.
struct TiltedScene {
  machine::Tool tool;
  std::vector<removal::Stamp> stamps{};
  Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();  ///< corners of the stock's box
  double voxel_mm = kTiltedVoxel_mm;
};

/// Rows of a ball on a plane that climbs at an angle.
inline TiltedScene ball_on_plane(double angle_rad, double width, machine::ToolType type = machine::ToolType::ball) {
  TiltedScene out{tool_of(type)};
  const double s = std::sin(angle_rad), c = std::cos(angle_rad), radius = 3;
  for (double y = -1.2; y < width + 0.3; y += 0.3) {
    const Vec3 contact(0, y * c, y * s), centre = contact + radius * Vec3(0, -s, c), tip = centre - Vec3(0, 0, radius);
    add_row(out.stamps, tip + Vec3(kTiltedLength_mm + 3, 0, 0), tip - Vec3(3, 0, 0), kTiltedFeed_mm);
  }
  out.lo = {0, 0, -1.5}, out.hi = {kTiltedLength_mm, width, width * s + 0.3};
  return out;
}

/// Two rows of a flat or bull-nose cutter along a wall with a floor.
inline TiltedScene shoulder(machine::ToolType type) {
  TiltedScene out{tool_of(type)};
  for (const double y : {-2.63, -2.34})
    add_row(out.stamps, {kTiltedLength_mm + 4, y, -1.13}, {-4, y, -1.13}, kTiltedFeed_mm);
  out.lo = {0.03, 0.01, -2.51}, out.hi = {kTiltedLength_mm, 2.52, 0.04};
  return out;
}

/// Every kind of cutter, and one that yields along its axis.
inline std::vector<TiltedScene> scenes() {
  std::vector<TiltedScene> out{ball_on_plane(0.5, 1.5), shoulder(machine::ToolType::flat),
                               shoulder(machine::ToolType::bull),
                               ball_on_plane(0.3, 1.5, machine::ToolType::tapered_ball), ball_on_plane(0.4, 1.5)};
  out.back().tool.root_axial_stiffness_N_per_mm = 5e3;
  return out;
}

/// The scene turned about the origin, with the spindle's X.
inline TiltedScene turned(const TiltedScene& scene, const Mat3& turn) {
  TiltedScene out = scene;
  for (removal::Stamp& s : out.stamps) {
    s.pose = pose_of_frame(turn * s.pose.tip_mm, turn.col(2), turn.col(0));
    s.feed_per_tooth_mm = turn * s.feed_per_tooth_mm;
  }
  return out;
}

inline removal::Stock stock_of(const TiltedScene& scene, const Mat3& turn) {
  Vec3 lo = Vec3::Constant(1e9), hi = -lo;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1 ? scene.hi.x() : scene.lo.x(), c & 2 ? scene.hi.y() : scene.lo.y(),
                      c & 4 ? scene.hi.z() : scene.lo.z());
    lo = lo.cwiseMin(turn * corner), hi = hi.cwiseMax(turn * corner);
  }
  const auto distance = [&](const Vec3& p) {
    return removal::box_distance_mm(turn.transpose() * p, scene.lo, scene.hi);
  };
  constexpr double kBand_mm = 5 * kTiltedVoxel_mm;
  return {distance, lo, hi, scene.voxel_mm, kBand_mm / scene.voxel_mm};
}

struct TiltedResult {
  double lateral_max_N = 0, chip_mm3 = 0, removed_fraction = 0;
  removal::ErrorFigures error_um;
  Vec3 force_mean_N = Vec3::Zero();
  std::size_t points = 0, unsettled = 0;
};

/// Heights of the upright scene.
struct Heights {
  double from = -1e9, to = 1e9;
};

/// A wall's error grows towards its foot, where the last row of points lies anywhere within a voxel of the edge: there
/// the share of the foot decides on the percentile. Rows 0.2 mm from the edges show what was cut.
inline Heights away_from_edges(const TiltedScene& scene) {
  if (scene.tool.type != machine::ToolType::flat) return {};
  constexpr double kEdge_mm = 0.2;
  return {scene.stamps.front().pose.tip_mm.z() + kEdge_mm, scene.hi.z() - kEdge_mm};
}

/// In the steady middle of the rows. Errors within the upright scene's `y_from` ... `y_to`.
inline TiltedResult cut_turned(const TiltedScene& upright, const Mat3& turn, machine::Coupling coupling, double y_from,
                               double y_to, const Heights& heights = {}) {
  const machine::Material material{2000, 700, 0, 15, 15, 0};
  const TiltedScene scene = turned(upright, turn);
  auto stock = stock_of(upright, turn);
  simulate::sweep(stock, scene.tool, scene.stamps, 0, kTiltedAllowance_mm);
  stock.clear_stamps();
  removal::Stock target(stock);
  simulate::sweep(target, scene.tool, scene.stamps, 0, 0);
  simulate::CutOptions options;
  options.coupling = coupling;
  options.envelope_step_mm = 0.06;
  options.rotation_step_rad = kPi / 90;
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(scene.tool), scene.stamps);
  removal::SurfaceMap map(target, places, stock);
  options.surface = &map;
  const simulate::CutResult cut_result = simulate::cut(stock, scene.tool, material, scene.stamps, {}, 0, options);
  TiltedResult r;
  r.unsettled = cut_result.unsettled;
  r.chip_mm3 = cut_result.chip_mm3;
  r.removed_fraction = cut_result.chip_mm3 / cut_result.stock_mm3;
  double n = 0;
  for (std::size_t k = 0; k + 1 < scene.stamps.size(); ++k) {
    const Vec3& tip = upright.stamps[k].pose.tip_mm;
    if (tip.x() < 2 || tip.x() > 4) continue;
    r.lateral_max_N += cut_result.loads[k].lateral_max_N;
    r.force_mean_N += turn.transpose() * cut_result.loads[k].force_mean_N;  // in the tool's frame
    ++n;
  }
  r.lateral_max_N /= n;
  r.force_mean_N /= n;
  std::vector<double> error, area;
  for (const auto& p : map.take()) {
    const Vec3 place = turn.transpose() * p.place_mm;
    if (place.x() < 2.03 || place.x() > 3.97 || place.y() < y_from || place.y() > y_to) continue;
    if (place.z() < heights.from || place.z() > heights.to) continue;
    error.push_back(1000 * p.error_mm);
    area.push_back(p.area_mm2);
  }
  r.points = error.size();
  r.error_um = removal::error_figures(error, area);
  return r;
}

}  // namespace camber::testing
