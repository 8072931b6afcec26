#include "checks/height_survey.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace camber::checks {

namespace {

/// Looks for walls that rise between two cells and fall after a few.
template <class Found>
void walls_along(const std::vector<double>& height, double cell_mm, Found found) {
  constexpr std::size_t kLeast = 2;
  for (std::size_t i = 1; i + 1 < height.size(); ++i) {
    const double rise = height[i] - height[i - 1];
    double top = height[i];
    for (std::size_t j = i + 1; j < height.size(); ++j) {
      const double thickness = static_cast<double>(j - i) * cell_mm;
      if (thickness >= kThinOfHeight * rise) break;
      const double high = std::min(rise, top - height[j]);
      if (thickness < kThinOfHeight * high) {
        if (j - i >= kLeast) found(i, j, ThinWall{thickness, high, Vec2::Zero()});
        break;
      }
      top = std::min(top, height[j]);
    }
  }
}

}  // namespace

std::optional<ThinWall> thinnest_wall(const removal::HeightMap& map) {
  std::optional<ThinWall> out;
  const double bottom = map.min_mm().z();
  for (const bool along_x : {true, false}) {
    const std::size_t lines = along_x ? map.rows() : map.columns(), cells = along_x ? map.columns() : map.rows();
    std::vector<double> height(cells + 2, bottom);
    for (std::size_t l = 0; l < lines; ++l) {
      for (std::size_t c = 0; c < cells; ++c) height[c + 1] = std::max(bottom, along_x ? map.at(c, l) : map.at(l, c));
      walls_along(height, map.cell_mm(), [&](std::size_t i, std::size_t j, ThinWall wall) {
        if (out && wall.slenderness() <= out->slenderness()) return;
        const std::size_t middle = (i + j) / 2 - 1;
        wall.place_mm = along_x ? map.centre(middle, l) : map.centre(l, middle);
        out = wall;
      });
    }
  }
  return out;
}

void suggest_workpiece(const machine::Job& job, const motion::SimulatedProgram& program,
                       const removal::HeightMap& machined, Diagnostics& diagnostics) {
  if (job.workpiece || program.turns()) return;
  const std::optional<ThinWall> wall = thinnest_wall(machined);
  if (!wall) return;
  Diagnostic d = job.voxel_place;
  d.severity = Severity::warning;
  d.message = fmt::format(
      "at X{:.1f} Y{:.1f} the part has a wall of {:.1f} mm that is {:.0f} mm high; it gives way, and is calculated as "
      "rigid: [workpiece] with youngs_modulus_GPa was expected where a wall is thinner than a fifth of its height",
      wall->place_mm.x(), wall->place_mm.y(), wall->thickness_mm, wall->height_mm);
  d.check = "workpiece-thin";
  diagnostics.add(d);
}

}  // namespace camber::checks
