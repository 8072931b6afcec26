#pragma once
// Measures the emitted path: growth of the angles between blocks and from row to row, and short blocks.
#include <cstddef>
#include <span>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/row_links.h"
#include "compensate/shift_path.h"
#include "nc/move.h"
#include "nc/move_map.h"

namespace camber::compensate {

struct PathQuality {
  double angle_growth_rad = 0;  ///< largest growth of an angle between two blocks
  std::size_t angle_line = 0;   ///< line of the emitted program; 0: no angle grows
  double shortest_mm = 0;       ///< shortest block made by a split; 0: none was split
  std::size_t too_short = 0;    ///< number of them shorter than the control can process, F T_b
  std::vector<nc::MoveMap::MovePlace>
      over;  ///< places of the given program where the angle grows by more than the bound
};

/// Between consecutive moves that may be shifted (`selected`, of the given program). Moves shorter than kShort_mm in
/// the given program turn freely and are left out. Within kCorner_mm of a corner of the given program, where the
/// control is slow and the axes cut short, the bound is kOfCorner of the corner's angle where that is larger.
PathQuality path_quality(const nc::Interpretation& given, const std::vector<bool>& selected,
                         const nc::Interpretation& emitted, const nc::MoveMap& map, double block_time_s,
                         double angle_bound_rad);
inline constexpr double kShort_mm = 0.02;
inline constexpr double kCorner_mm = 2, kOfCorner = 1.0 / 3;

/// Returns how the shift changes from row to row: the 95th percentile and the largest |difference| between each point
/// of the path and the nearest one that is not its neighbour along the path, within `reach_mm`.
struct RowSteps {
  double p95_mm = 0, max_mm = 0;
  std::size_t pairs = 0;
};
RowSteps row_steps(const ShiftPath& path, double reach_mm);

/// Differences of the mean error between points of neighbouring rows, of one sense or the other. Up and down milling
/// require different shifts; the criterion is that the steps between their surfaces become smaller.
struct SurfaceSteps {
  double before_p95_mm = 0, before_max_mm = 0;
  double after_p95_mm = 0, after_max_mm = 0;
  double growth_rad = 0;  ///< additional turn of the surface from row to row, at the worst pair
  std::size_t pairs = 0;
};

/// `pairs`: row_links(path, reach, RowSense::any). A point's error is the mean, by area, of what it made; pairs of
/// which one made nothing are left out.
SurfaceSteps surface_steps(const ShiftPath& path, std::span<const RowLink> pairs, const Observed& before,
                           const Observed& after);

}  // namespace camber::compensate
