#include "simulate/tooth_loads.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::simulate {
namespace {

/// Height above the tip at which the profile turns upright: above it nothing cuts straight down.
double wall_height_mm(const machine::Tool& tool) {
  constexpr double kUpright = 1e-9;
  const removal::Profile& profile = removal::shape_of(tool).profile;
  for (const auto& piece : profile.pieces())
    if (!piece.arc && piece.normal.x() > 1 - kUpright) return piece.start.y();
  return std::numeric_limits<double>::infinity();
}

}  // namespace

double engaged_top_mm(const removal::Stock& stock, const machine::Tool& tool, double rise_mm) {
  const double cutting = tool.flute_length_mm.value_or(tool.overhang_mm);
  return std::clamp(rise_mm + stock.voxel_mm(), stock.voxel_mm(), cutting);
}

removal::EnvelopeGrid sampled_envelope(const removal::Stock& stock, const machine::Tool& tool, double top_mm,
                                       const CutOptions& options) {
  if (options.drilling)
    return removal::make_envelope(tool, std::min(top_mm, wall_height_mm(tool)), options.envelope_step_mm,
                                  options.rotation_step_rad);
  return removal::make_envelope(tool, std::max(0.0, top_mm - stock.voxel_mm()), options.envelope_step_mm,
                                options.rotation_step_rad, stock.voxel_mm());
}

StampLoad summarize(const deflection::ToothPass& pass) {
  StampLoad load;
  for (const Vec3& f : pass.force_N) {
    for (int a = 0; a < 3; ++a)
      if (std::abs(f[a]) > std::abs(load.force_max_N[a])) load.force_max_N[a] = f[a];
    load.lateral_max_N = std::max(load.lateral_max_N, f.head<2>().norm());
    load.force_mean_N += f;
  }
  load.force_mean_N /= static_cast<double>(pass.force_N.size());
  for (const double t : pass.torque_Nmm) {
    load.torque_max_Nmm = std::max(load.torque_max_Nmm, t);
    load.torque_mean_Nmm += t / static_cast<double>(pass.torque_Nmm.size());
  }
  load.work_Nmm = pass.work_Nmm;
  load.chip_max_mm = pass.chip_max_mm;
  load.chip_area_mm2 = pass.chip_area_mm2;
  return load;
}

double tip_deflection_mm(const removal::DeflectionTable& table, const float* row) {
  float largest = 0;
  for (int m = 0; m < table.steps; ++m) {
    const float x = row[2 * m], y = row[2 * m + 1], z = table.axial_mm(row, m);
    largest = std::max(largest, x * x + y * y + z * z);
  }
  return std::sqrt(static_cast<double>(largest));
}

}  // namespace camber::simulate
