#include "report/job_proposal.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::report {
namespace {

using machine::ToolType;

constexpr double kTouches_mm = 0.05;
constexpr double kBallDepth = 0.5, kSlotDepth = 1.5, kFluteLength = 4;  // diameters
constexpr double kSlot = 0.5;                                           // of the width

bool is_ball(ToolType type) { return type == ToolType::ball || type == ToolType::tapered_ball; }

bool is_impossible(const machine::ToolProposal& tool, ToolType type, const MetMaterial& met) {
  const double diameter_mm = *tool.diameter_mm;
  if (is_ball(type)) return met.depth_mm > kBallDepth * diameter_mm;
  const double flutes_mm = tool.flute_length_mm.value_or(kFluteLength * diameter_mm);
  return met.depth_mm > flutes_mm || (met.width_fraction >= kSlot && met.depth_mm > kSlotDepth * diameter_mm);
}

}  // namespace

void CutDepths::add(const machine::ToolProposal& tool, const MetMaterial& met, double step_mm) {
  const ToolType type = tool.type.value_or(ToolType::flat);
  if (type == ToolType::drill || type == ToolType::chamfer) return;
  if (tool.diameter_mm.value_or(0) <= 0 || met.depth_mm < kTouches_mm) return;
  cutting_mm_ += step_mm;
  if (!is_impossible(tool, type, met)) return;
  impossible_mm_ += step_mm;
  smallest_mm_ = smallest_mm_ > 0 ? std::min(smallest_mm_, *tool.diameter_mm) : *tool.diameter_mm;
  if (met.above_tip_mm <= deepest_mm_) return;
  deepest_mm_ = met.above_tip_mm;
  of_diameter_mm_ = *tool.diameter_mm;
  ball_ = is_ball(type);
}

std::string CutDepths::deepest() const {
  return fmt::format("{} of {:.4g} mm would cut up to {:.1f} mm deep", ball_ ? "a ball end mill" : "an end mill",
                     of_diameter_mm_, deepest_mm_);
}

double CutDepths::usual_allowance_mm() const { return std::clamp(std::round(smallest_mm_) / 20, 0.2, 0.5); }

}  // namespace camber::report
