#pragma once
// A helical flat end mill along a wall: Camber's rigid cut and the drawn one (displaced_envelope.h), over the height.
#include <cmath>
#include <vector>

#include "base/units.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "simulate/predict_path.h"
#include "tests/support/cutting.h"
#include "tests/support/displaced_envelope.h"

namespace camber::testing {

namespace detail {
constexpr double kEdge = 0.25;  ///< above and below: the map leaves out the blank's edges
constexpr double kRead = 1;     ///< to both sides of the block's middle, mm
}  // namespace detail

/// One pass along the wall y = 0 of a block at y > 0, by a tool at y < 0.
struct FinishedWall {
  double diameter_mm = 10, helix_deg = 30, height_mm = 6, radial_mm = 0.5, feed_mm = 0.05;
  int flutes = 4;
  bool up = true;                          ///< up (conventional) or down (climb) milling
  std::vector<double> pitch_deg{};         ///< from each tooth to the next, of teeth that are not even
  double run_out_mm = 0, run_out_deg = 0;  ///< with pitch_deg
  double voxel_mm = 0.1;
  Vec3 offset_mm = Vec3::Zero();  ///< shift of path and stock against the grid
  double edge_step_mm = 0;        ///< Camber's; 0: as predict sets it
  double slice_mm = 0.5;          ///< part of the height over which the error is averaged
  int drawn_steps = 1440;         ///< a turn
  double rotation_step_deg = 1;   ///< Camber's
  double young_MPa = 600000, overhang_mm = 40;
  machine::Material material{2000, 700, 300, 15, 12, 3};
  machine::Coupling coupling = machine::Coupling::rigid;  ///< Camber's

  /// Of the block: what cuts ahead of the places that are read, a radius away at most, is still all in it.
  double middle_mm() const { return diameter_mm / 2 + detail::kRead + 1; }
};

struct WallFigures {
  double lateral_max_N = 0;
  Vec3 mean_N = Vec3::Zero();
  std::vector<double> error_um;  ///< by slices of the height, upwards
  double chips_of_stock = 1;     ///< chips over what the stock lost; Camber's
  std::size_t unsettled = 0;     ///< stretches without a static equilibrium; Camber's
};

inline DrawnCut drawn(const FinishedWall& w) {
  constexpr double kBelow = 0.53;  // the tip runs below the block
  const double length = 2 * w.middle_mm();
  DrawnCut c;
  c.radius = w.diameter_mm / 2, c.corner = 0;
  c.flutes = w.flutes;
  c.helix_rad = rad_from_deg(w.helix_deg);
  double at = 0;
  for (const double pitch : w.pitch_deg) {
    c.tooth_at_rad.push_back(at);
    at += rad_from_deg(pitch);
  }
  c.run_out_mm = w.run_out_mm, c.run_out_rad = rad_from_deg(w.run_out_deg);
  c.top = w.height_mm + kBelow;
  c.k = {2000, 700, 300, 15, 12, 3};
  c.overhang = w.overhang_mm;
  c.bending_stiffness_N_mm2 = w.young_MPa * kPi / 64 * std::pow(0.8 * w.diameter_mm, 4);
  c.lo = w.offset_mm + Vec3(0, -w.radial_mm, 0);
  c.hi = w.offset_mm + Vec3(length, 2, w.height_mm);
  c.steps_per_pitch = w.drawn_steps / w.flutes;
  const double from = -c.radius - 0.2, to = length + c.radius + 0.2;
  const Vec3 tip = w.offset_mm + Vec3(0, -c.radius, -kBelow);
  const Vec3 a = tip + Vec3(w.up ? from : to, 0, 0), b = tip + Vec3(w.up ? to : from, 0, 0);
  add_row(c.stamps, a, b, w.feed_mm);
  return c;
}

namespace detail {

struct Slices {
  std::vector<double> sum, area;
  double width;
  explicit Slices(const FinishedWall& w) : width(w.slice_mm) {
    sum.assign(static_cast<std::size_t>(std::lround((w.height_mm - 2 * kEdge) / w.slice_mm)), 0.0);
    area = sum;
  }
  void add(double z, double error_mm, double weight) {
    z -= kEdge;
    const auto i = static_cast<std::size_t>(std::max(0.0, z / width));
    if (z < 0 || i >= sum.size()) return;
    sum[i] += weight * 1000 * error_mm;
    area[i] += weight;
  }
  std::vector<double> means() const {
    std::vector<double> out;
    for (std::size_t i = 0; i < sum.size(); ++i) out.push_back(sum[i] / area[i]);
    return out;
  }
};

/// The stamp that stands in the middle of the block.
inline std::size_t middle_stamp(const FinishedWall& w, const DrawnCut& c) {
  std::size_t best = 0;
  const auto off = [&](std::size_t k) {
    return std::abs(c.stamps[k].pose.tip_mm.x() - w.offset_mm.x() - w.middle_mm());
  };
  for (std::size_t k = 1; k < c.stamps.size(); ++k)
    if (off(k) < off(best)) best = k;
  return best;
}

}  // namespace detail

inline WallFigures drawn_figures(const FinishedWall& w) {
  const DrawnCut cut = drawn(w);
  const std::size_t middle = detail::middle_stamp(w, cut);
  const DrawnPass pass = drawn_pass(cut, middle);
  WallFigures f{pass.lateral_max_N, pass.mean_N, {}, 1, 0};
  constexpr int kInFeed = 20;
  const int along = kInFeed * static_cast<int>(std::max<std::size_t>(1, cut.tooth_at_rad.size()));
  const double step = 0.05;
  const DrawnSurface lattice(w.offset_mm + Vec3(w.middle_mm(), 0, step / 2), Vec3::UnitX(), Vec3::UnitZ(), along,
                             static_cast<int>(std::lround(w.height_mm / step)), w.feed_mm / kInFeed, step);
  std::vector<std::size_t> stamps;
  for (std::size_t k = 0; k < cut.stamps.size(); ++k)
    if (std::abs(cut.stamps[k].pose.tip_mm.x() - w.offset_mm.x() - w.middle_mm()) < 1.3) stamps.push_back(k);
  // In the steady middle every stamp bends alike.
  const auto error = drawn_error_mm(
      cut, [&](std::size_t) -> const DrawnPass& { return pass; }, stamps, lattice, 0.1);
  detail::Slices slices(w);
  for (int i = 0; i < lattice.nu; ++i)
    for (int j = 0; j < lattice.nv; ++j) {
      const double e =
          error[static_cast<std::size_t>(i) * static_cast<std::size_t>(lattice.nv) + static_cast<std::size_t>(j)];
      if (std::isfinite(e)) slices.add((j + 0.5) * step, e, 1);
    }
  f.error_um = slices.means();
  return f;
}

inline WallFigures camber_figures(const FinishedWall& w) {
  const DrawnCut cut = drawn(w);
  auto tool = make_tool(machine::ToolType::flat, w.diameter_mm, w.flutes, w.helix_deg);
  for (const double pitch : w.pitch_deg) tool.pitch_rad.push_back(rad_from_deg(pitch));
  tool.runout_mm = w.run_out_mm, tool.runout_angle_rad = rad_from_deg(w.run_out_deg);
  tool.youngs_modulus_MPa = w.young_MPa;
  removal::Stock stock = make_box(cut.lo, cut.hi, w.voxel_mm);
  removal::Stock target(stock);
  simulate::sweep(target, tool, cut.stamps, 0, 0);
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(tool), cut.stamps);
  removal::SurfaceMap map(target, places, stock);
  simulate::CutOptions options;
  options.coupling = w.coupling;
  options.envelope_step_mm = w.edge_step_mm > 0 ? w.edge_step_mm : simulate::envelope_step_mm({}, tool);
  options.rotation_step_rad = rad_from_deg(w.rotation_step_deg);
  options.surface = &map;
  const auto result = simulate::cut(stock, tool, w.material, cut.stamps, {}, 0, options);
  WallFigures f;
  f.chips_of_stock = result.chip_mm3 / result.stock_mm3;
  f.unsettled = result.unsettled;
  const std::size_t middle = detail::middle_stamp(w, cut);
  const std::size_t around = cut.even() ? 21 : static_cast<std::size_t>(6 * w.flutes);  // whole turns
  for (std::size_t k = middle - around / 2; k < middle - around / 2 + around; ++k) {
    const double fraction = 1 / static_cast<double>(around), peak = result.loads[k].lateral_max_N;
    f.lateral_max_N = cut.even() ? f.lateral_max_N + fraction * peak : std::max(f.lateral_max_N, peak);
    f.mean_N += fraction * result.loads[k].force_mean_N;
  }
  detail::Slices slices(w);
  for (const auto& p : map.take()) {
    const Vec3 q = p.place_mm - w.offset_mm;
    if (std::abs(q.y()) < 0.05 && std::abs(q.x() - w.middle_mm()) < detail::kRead)
      slices.add(q.z(), p.error_mm, p.area_mm2);
  }
  f.error_um = slices.means();
  return f;
}

}  // namespace camber::testing
