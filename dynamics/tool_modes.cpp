#include "dynamics/tool_modes.h"

#include <algorithm>
#include <cmath>

namespace camber::dynamics {

std::vector<BeamMode> beam_modes_of(const machine::Tool& tool, int count) {
  const double density = tool.density_kg_per_m3.value_or(usual_density_kg_per_m3(tool.youngs_modulus_MPa));
  return beam_modes(beam_of_tool(tool, density),
                    {.stiffness_N_per_mm = tool.root_stiffness_N_per_mm,
                     .tilt_stiffness_Nmm_per_rad = tool.root_rotational_stiffness_Nmm_per_rad},
                    count);
}

std::vector<Mode> modes_of(const machine::Tool& tool) {
  if (!tool.modes.empty()) return tool.modes;
  const auto beam = beam_modes_of(tool);
  double softest = beam.front().tip_stiffness_N_per_mm;
  for (const BeamMode& m : beam) softest = std::min(softest, m.tip_stiffness_N_per_mm);
  std::vector<Mode> modes;
  for (const BeamMode& m : beam) {
    if (m.tip_stiffness_N_per_mm * kModeCounts > softest) continue;
    for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1)})
      modes.push_back({direction, m.frequency_hz, kUsualDamping, m.tip_stiffness_N_per_mm});
  }
  return modes;
}

Cut teeth_of(const machine::Tool& tool) {
  Cut cut;
  cut.pitch_rad = tool.pitch_rad.empty() ? equal_pitches(tool.flutes) : tool.pitch_rad;
  cut.radius_mm = tool.diameter_mm / 2;
  cut.lag_rad_per_mm = std::tan(tool.helix_rad) / cut.radius_mm;
  return cut;
}

}  // namespace camber::dynamics
