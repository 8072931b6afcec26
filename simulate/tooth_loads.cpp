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

void raise_magnitude(double& value, double to) {
  if (std::abs(to) > std::abs(value)) value = to;
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

StampLoad summarize(const deflection::ToothPass& pass, const ToolPose& pose) {
  StampLoad load;
  for (const Vec3& f : pass.force_N) {
    const Vec3 in_part = direction_in_part(pose, f);
    for (int a = 0; a < 3; ++a) raise_magnitude(load.force_max_N[a], in_part[a]);
    load.lateral_max_N = std::max(load.lateral_max_N, f.head<2>().norm());
    raise_magnitude(load.axial_max_N, f.z());
    load.force_mean_N += f;
  }
  load.force_mean_N = direction_in_part(pose, load.force_mean_N / static_cast<double>(pass.force_N.size()));
  for (const double t : pass.torque_Nmm) {
    load.torque_max_Nmm = std::max(load.torque_max_Nmm, t);
    load.torque_mean_Nmm += t / static_cast<double>(pass.torque_Nmm.size());
  }
  load.work_Nmm = pass.work_Nmm;
  load.chip_max_mm = pass.chip_max_mm;
  load.chip_area_mm2 = pass.chip_area_mm2;
  return load;
}

StampLoad between(const StampLoad& a, const StampLoad& b, double way) {
  const auto mix = [&](const auto& of_a, const auto& of_b) { return (1 - way) * of_a + way * of_b; };
  StampLoad load;
  load.force_max_N = mix(a.force_max_N, b.force_max_N);
  load.lateral_max_N = mix(a.lateral_max_N, b.lateral_max_N);
  load.axial_max_N = mix(a.axial_max_N, b.axial_max_N);
  load.force_mean_N = mix(a.force_mean_N, b.force_mean_N);
  load.chip_mm3 = mix(a.chip_mm3, b.chip_mm3);
  load.torque_max_Nmm = mix(a.torque_max_Nmm, b.torque_max_Nmm);
  load.torque_mean_Nmm = mix(a.torque_mean_Nmm, b.torque_mean_Nmm);
  load.work_Nmm = mix(a.work_Nmm, b.work_Nmm);
  load.chip_max_mm = mix(a.chip_max_mm, b.chip_max_mm);
  load.chip_area_mm2 = mix(a.chip_area_mm2, b.chip_area_mm2);
  load.arc = mix(a.arc, b.arc);
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
