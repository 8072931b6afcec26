#include "inspect/model_error.h"

#include <algorithm>
#include <cmath>

#include "machine/material_presets.h"

namespace camber::inspect {
namespace {

constexpr double kOtherSource = 0.25, kSmallTool = 1.5, kSmallTool_mm = 4;
constexpr double kTypicalRoot = 0.4, kGivenRoot = 0.15, kGain = 0.15, kDiameter_mm = 0.005;

}  // namespace

machine::ModelError model_error_of(const machine::Job& job) {
  if (job.model_error) return *job.model_error;
  const machine::MaterialPreset* preset = machine::find_preset(job.material.preset);
  const double force = preset ? preset->scatter_percent / 100 : kOtherSource;
  const auto any = [&](auto test) { return std::ranges::any_of(job.tools, test); };
  const double chips = any([](const auto& t) { return t.second.diameter_mm < kSmallTool_mm; }) ? kSmallTool : 0;
  const double stiffness = any([](const auto& t) { return !t.second.typical.empty(); }) ? kTypicalRoot : kGivenRoot;
  return {.deflection = std::hypot(force, chips, stiffness), .contour = kGain, .size_mm = kDiameter_mm};
}

}  // namespace camber::inspect
