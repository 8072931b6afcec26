#include "simulate/passage_cut.h"

#include <algorithm>
#include <cmath>

#include "deflection/edge_force.h"
#include "dynamics/tool_modes.h"

namespace camber::simulate {
namespace {

/// The angle whose sine is `ratio` times itself, 0 to pi.
double angle_of_sinc(double ratio) {
  double angle = std::sqrt(6 * std::max(0.0, 1 - ratio));
  for (int i = 0; i < 5 && angle > 1e-6; ++i) angle -= (std::sin(angle) - ratio * angle) / (std::cos(angle) - ratio);
  return std::clamp(angle, 0.0, kPi);
}

}  // namespace

bool cuts(const StampLoad& load) {
  constexpr float kNoCut = 1e-4f;
  return load.arc.area_mm_rad > kNoCut;
}

PassageCut passage_cut(const StampLoad& load, const machine::Material& material) {
  const deflection::ChipArc& a = load.arc;
  const double area = a.area_mm_rad, ratio = std::hypot(a.cosine_mm_rad, a.sine_mm_rad) / area;
  PassageCut out;
  out.cut.arc_rad = std::max(angle_of_sinc(ratio), 1e-3);
  // From counter-clockwise of x to clockwise of y.
  out.cut.centre_rad = kPi / 2 - std::atan2(a.sine_mm_rad, a.cosine_mm_rad) / 2;
  out.depth_mm = area / out.cut.arc_rad;
  const double chip = load.chip_area_mm2 > 0 ? load.chip_mm3 / load.chip_area_mm2 : 0;
  const deflection::EdgeForce k = deflection::edge_force_slope(material, std::max(chip, 1e-3));
  const double sine = std::min(1.0, a.wall_mm_rad / area);
  out.cut.kt_MPa = k.tangential_N;
  out.cut.kr_MPa = k.radial_N * sine + k.axial_N * std::sqrt(1 - sine * sine);
  return out;
}

dynamics::StabilityTable stability_table(const machine::Job& job, const machine::Tool& tool,
                                         std::vector<machine::Mode> modes, double speed_rpm, bool upright) {
  if (upright) modes.insert(modes.end(), job.workpiece_modes.begin(), job.workpiece_modes.end());
  return {std::move(modes), dynamics::teeth_of(tool), speed_rpm,
          tool.modes.empty() ? dynamics::kBeamModeErrors : dynamics::kMeasuredModeErrors};
}

}  // namespace camber::simulate
