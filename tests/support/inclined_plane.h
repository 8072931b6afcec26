#pragma once
// Ball finishing of an inclined plane: Camber's rigid cut and the drawn one (displaced_envelope.h), figure by figure.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/units.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"
#include "tests/support/displaced_envelope.h"

namespace camber::testing {

/// Rows over the plane z = y tan(slope), its figures read in the steady middle.
struct InclinedPlane {
  double slope_deg = 45, feed_mm = 0.15, row_mm = 0.3, allowance_mm = 0.2;
  bool upwards = true;  ///< rows along X follow each other up the slope; else down
  double along_x = -1;  ///< direction of the feed; 0: to and fro
  double along_slope =
      0;  ///< 1: rows run up the slope, -1: down, and follow each other along X (upwards) or -X; 0: along X
  double corner_mm = 0;                    ///< corner radius of a bull-nose cutter; 0: a ball
  double taper_deg = 0;                    ///< angle of a ball's wall
  std::vector<double> pitch_deg{};         ///< from each tooth to the next, of teeth that are not even
  double run_out_mm = 0, run_out_deg = 0;  ///< with pitch_deg
  int flutes = 2;
  double helix_deg = 30;
  double voxel_mm = 0.1;
  Vec3 offset_mm = Vec3::Zero();  ///< shift of path and stock against the grid
  double radius_mm = 3, diameter_step_mm = 0.06;
  double rotation_step_deg = 1;
  int drawn_steps = 360;  ///< a pitch
  double drawn_edge = 0.03;
  double young_MPa = 600000;
  machine::Material material{2000, 700, 0, 15, 15, 0};
  machine::Coupling coupling = machine::Coupling::rigid;  ///< Camber's

  double corner() const { return corner_mm > 0 ? corner_mm : radius_mm; }
};

/// Means are per tooth passing; error: signed, of the surface's area.
struct CutFigures {
  double lateral_max_N = 0;
  Vec3 mean_N = Vec3::Zero();
  double p5_um = 0, median_um = 0, p95_um = 0, error_mean_um = 0;
  double chip_mm3 = 0;        ///< a tooth passing
  double chips_of_stock = 1;  ///< chips over what the stock lost
  std::size_t unsettled = 0;  ///< stretches without a static equilibrium
};

inline DrawnCut drawn(const InclinedPlane& p) {
  constexpr double kLength = 7, kAlong = 6.3, kRun = 1.8;
  const double a = rad_from_deg(p.slope_deg), c = std::cos(a), s = std::sin(a);
  DrawnCut cut;
  cut.radius = p.radius_mm, cut.corner = p.corner();
  cut.helix_rad = rad_from_deg(p.helix_deg);
  cut.flutes = p.flutes;
  const double rc = p.corner(), bottom = p.radius_mm - rc;
  // Above the contact the cutter meets the allowance, and the next row's of it.
  const double beyond = std::max(0.75, std::acos(1 - 1.5 * p.allowance_mm / rc) + p.row_mm / rc);  // rad of the profile
  const double turn = kPi / 2 - rad_from_deg(p.taper_deg);
  const double end = a + beyond, leaning = std::max(turn - a, 1e-3);
  // A wall that leans but little from the plane meets the allowance high up.
  const double shank =
      leaning < beyond ? std::max(end - turn, (1.2 * p.allowance_mm / std::tan(leaning) + p.row_mm) / rc) : 0;
  cut.taper_rad = rad_from_deg(p.taper_deg);
  cut.top = rc * (1 - std::cos(end - shank) + shank);
  cut.allowance = p.allowance_mm;
  cut.k = {2000, 700, 0, 15, 15, 0};
  cut.overhang = 40;
  cut.steps_per_pitch = p.drawn_steps;
  cut.edge_step = p.drawn_edge;
  cut.bending_stiffness_N_mm2 = p.young_MPa * kPi / 64 * std::pow(0.8 * 2 * p.radius_mm, 4);
  cut.lo = p.offset_mm + Vec3(0, 0, -1.5);
  cut.hi = p.offset_mm + Vec3(kLength, kAlong * c, kAlong * s + 1);
  double at = 0;
  for (const double pitch : p.pitch_deg) {
    cut.tooth_at_rad.push_back(at);
    at += rad_from_deg(pitch);
  }
  cut.run_out_mm = p.run_out_mm, cut.run_out_rad = rad_from_deg(p.run_out_deg);
  // The tip where the rounding touches the plane at x, and `up` along the slope.
  const auto tip = [&](double x, double up) -> Vec3 {
    return p.offset_mm + Vec3(x, up * c - rc * s - bottom, up * s + rc * c - rc);
  };
  constexpr double kBeside = 2;
  const double across = (p.along_slope != 0 ? kLength : kAlong) + 2 * kBeside;
  const int rows = static_cast<int>(across / p.row_mm);
  for (int r = 0; r < rows; ++r) {
    const double row = -kBeside + p.row_mm * (p.upwards ? r : rows - 1 - r);
    if (p.along_slope != 0) {
      const Vec3 low = tip(row, -kRun), high = tip(row, kAlong + kRun);
      add_row(cut.stamps, p.along_slope > 0 ? low : high, p.along_slope > 0 ? high : low, p.feed_mm);
      continue;
    }
    const double way = p.along_x != 0 ? p.along_x : r % 2 ? 1 : -1;
    const Vec3 left = tip(-kRun, row), right = tip(kLength + kRun, row);
    add_row(cut.stamps, way > 0 ? left : right, way > 0 ? right : left, p.feed_mm);
  }
  return cut;
}

namespace detail {

constexpr double kXFrom = 2.0, kXTo = 5.0;
constexpr double kSFrom = 2.7, kSTo = 3.9;  ///< along the slope

inline double along_slope(const InclinedPlane& p, const Vec3& tip) {
  const double a = rad_from_deg(p.slope_deg);
  const Vec3 q = tip - p.offset_mm;
  return (q.y() + p.corner() * std::sin(a) + p.radius_mm - p.corner()) / std::cos(a);
}

/// Stamps whose figures are read.
inline std::vector<std::size_t> middle(const InclinedPlane& p, const std::vector<removal::Stamp>& stamps,
                                       double margin) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k + 1 < stamps.size(); ++k) {
    const double x = stamps[k].pose.tip_mm.x() - p.offset_mm.x(), s = along_slope(p, stamps[k].pose.tip_mm);
    if (x > kXFrom - margin && x < kXTo + margin && s > kSFrom - margin && s < kSTo + margin) out.push_back(k);
  }
  return out;
}

inline void set_error(CutFigures& f, std::vector<std::pair<double, double>> error_area) {
  std::sort(error_area.begin(), error_area.end());
  double all = 0;
  for (const auto& [e, a] : error_area) {
    all += a;
    f.error_mean_um += 1000 * a * e;
  }
  f.error_mean_um /= all;
  const auto at = [&](double fraction) {
    double below = 0;
    for (const auto& [e, a] : error_area)
      if ((below += a) >= fraction * all) return 1000 * e;
    return 1000 * error_area.back().first;
  };
  f.p5_um = at(0.05), f.median_um = at(0.5), f.p95_um = at(0.95);
}

}  // namespace detail

/// The drawn cut's figures.
inline CutFigures drawn_figures(const InclinedPlane& p) {
  const DrawnCut cut = drawn(p);
  const double a = rad_from_deg(p.slope_deg);
  CutFigures f;
  // In the steady middle every stamp of a row has the same load; rows to and fro differ.
  const auto inner = detail::middle(p, cut.stamps, 0), outer = detail::middle(p, cut.stamps, 0.9);
  std::map<int, DrawnPass> by_way;
  const auto way = [&](std::size_t k) { return cut.stamps[k].feed_per_tooth_mm.x() > 0 ? 1 : -1; };
  const double x_mid = (detail::kXFrom + detail::kXTo) / 2 + p.offset_mm.x();
  for (const int w : {-1, 1}) {
    std::size_t best = cut.stamps.size();
    for (const std::size_t k : inner)
      if (way(k) == w && (best == cut.stamps.size() || std::abs(cut.stamps[k].pose.tip_mm.x() - x_mid) <
                                                           std::abs(cut.stamps[best].pose.tip_mm.x() - x_mid)))
        best = k;
    if (best < cut.stamps.size()) by_way[w] = drawn_pass(cut, best);
  }
  for (const auto& [w, pass] : by_way) {
    const double fraction = 1.0 / static_cast<double>(by_way.size());
    f.lateral_max_N += fraction * pass.lateral_max_N;
    f.mean_N += fraction * pass.mean_N;
    f.chip_mm3 += fraction * pass.chip_mm3;
  }
  const double y = detail::kSFrom * std::cos(a), z = detail::kSFrom * std::sin(a);
  const DrawnSurface lattice(p.offset_mm + Vec3(3.2, y, z), Vec3::UnitX(), {0, std::cos(a), std::sin(a)}, 60, 120, 0.01,
                             0.01);
  const auto error = drawn_error_mm(
      cut, [&](std::size_t k) -> const DrawnPass& { return by_way.at(way(k)); }, outer, lattice, 0.1);
  std::vector<std::pair<double, double>> error_area;
  for (const double e : error)
    if (std::isfinite(e)) error_area.push_back({e, 1.0});
  detail::set_error(f, std::move(error_area));
  return f;
}

/// Camber's figures.
inline CutFigures camber_figures(const InclinedPlane& p) {
  const DrawnCut cut = drawn(p);
  auto tool = make_tool(p.corner_mm > 0   ? machine::ToolType::bull
                        : p.taper_deg > 0 ? machine::ToolType::tapered_ball
                                          : machine::ToolType::ball,
                        2 * p.radius_mm, p.flutes, p.helix_deg);
  tool.corner_radius_mm = p.corner_mm, tool.taper_rad = rad_from_deg(p.taper_deg);
  for (const double pitch : p.pitch_deg) tool.pitch_rad.push_back(rad_from_deg(pitch));
  tool.runout_mm = p.run_out_mm, tool.runout_angle_rad = rad_from_deg(p.run_out_deg);
  tool.youngs_modulus_MPa = p.young_MPa;
  removal::Stock stock = make_box(cut.lo, cut.hi, p.voxel_mm);
  simulate::sweep(stock, tool, cut.stamps, 0, p.allowance_mm);
  stock.clear_stamps();
  removal::Stock target(stock);
  simulate::sweep(target, tool, cut.stamps, 0, 0);
  simulate::CutOptions options;
  options.coupling = p.coupling;
  options.envelope_step_mm = p.diameter_step_mm;
  options.rotation_step_rad = rad_from_deg(p.rotation_step_deg);
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(tool), cut.stamps);
  removal::SurfaceMap map(target, places, stock);
  options.surface = &map;
  const auto result = simulate::cut(stock, tool, p.material, cut.stamps, {}, 0, options);
  CutFigures f;
  f.chips_of_stock = result.chip_mm3 / result.stock_mm3;
  f.unsettled = result.unsettled;
  const auto inner = detail::middle(p, cut.stamps, 0);
  for (const std::size_t k : inner) {
    const double fraction = 1.0 / static_cast<double>(inner.size());
    const double peak = result.loads[k].lateral_max_N;
    f.lateral_max_N = cut.even() ? f.lateral_max_N + fraction * peak : std::max(f.lateral_max_N, peak);
    f.mean_N += fraction * result.loads[k].force_mean_N;
    f.chip_mm3 += fraction * result.loads[k].chip_mm3;
  }
  const double a = rad_from_deg(p.slope_deg);
  std::vector<std::pair<double, double>> error_area;
  for (const auto& s : map.take()) {
    const Vec3 q = s.place_mm - p.offset_mm;
    const double along = q.y() * std::cos(a) + q.z() * std::sin(a);
    if (q.x() > detail::kXFrom && q.x() < detail::kXTo && along > detail::kSFrom && along < detail::kSTo)
      error_area.push_back({s.error_mm, s.area_mm2});
  }
  detail::set_error(f, std::move(error_area));
  return f;
}

}  // namespace camber::testing
