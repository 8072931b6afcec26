#pragma once
// The whole tool from the tip to the holder's upper end, as points on its outline.
#include <cstddef>
#include <vector>

#include "machine/tool.h"
#include "removal/profile.h"
#include "removal/tool_path.h"

namespace camber::checks {

/// A circle about the axis.
struct OutlineRing {
  enum class Part { cutter, shank, holder };
  Part part = Part::cutter;
  double radius_mm = 0, height_mm = 0;
};

/// Rings about `step_mm` apart along the cutter up to its flutes' end, the neck, the shank and the holder, with the
/// faces between them; those above `top_mm` are left out.
std::vector<OutlineRing> tool_outline(const machine::Tool& tool, double step_mm, double top_mm);

/// Height above the tip at which the cutter ends and neck, shank or holder begin.
double cutter_end_mm(const machine::Tool& tool);

/// The end of a stretch of a run's stamps that begins at `from`, in which the tip rises and falls by less than half the
/// flutes: what stands beside the tool above its cutter was not for the cutter of the same stretch to remove.
std::size_t level_stretch_end(const machine::Tool& tool, const removal::StampPath& path, const removal::ToolRun& run,
                              std::size_t from);

}  // namespace camber::checks
