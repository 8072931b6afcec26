#pragma once
// Lobes of a job's tool at a radial depth.
#include <vector>

#include "dynamics/semi_discretisation.h"
#include "dynamics/vibrating_cut.h"
#include "machine/material.h"
#include "machine/tool.h"

namespace camber::dynamics {

enum class LobeMethod { zero_order, semi_discretisation };

struct LobeRequest {
  machine::Tool tool;
  std::vector<Mode> modes;  ///< modes_of the tool, and of the work
  machine::Material material;
  double chip_mm = 0.05;  ///< thickness at which the slope of the force law counts; any of a linear law
  double radial_mm = 0;   ///< up to the diameter
  Milling milling = Milling::down;
  LobeMethod method = LobeMethod::semi_discretisation;
  double process_damping_N_per_mm = 0;  ///< Cut::process_damping_N_per_mm
};

struct LobePoint {
  double speed_rpm = 0;
  CriticalDepth critical;
  StabilityBorder border = StabilityBorder::none;
};

/// The cut of a depth: one slice of a straight wall; of a rounded or pointed end kEndSlices, each with the arc of its
/// own radius and K_r sin kappa + K_a cos kappa of its own normal. The material stands at `radial_mm` within the
/// largest circle.
Cut cut_at_depth(const LobeRequest& request, double depth_mm);
constexpr int kEndSlices = 24;

/// The border at each speed. The depth of a rounded end is the lowest that is critical with its own slices, up to the
/// flutes' length; of a straight wall there is no limit.
std::vector<LobePoint> tool_lobes(const LobeRequest& request, const std::vector<double>& speeds_rpm);

}  // namespace camber::dynamics
