#pragma once
// Links nodes of neighbouring rows, so that shifts change smoothly from row to row.
#include <cstddef>
#include <span>
#include <vector>

#include "compensate/shift_path.h"

namespace camber::compensate {

/// Two points of neighbouring rows that are cut in the same sense. Rows cut to and fro differ in truth (up and down
/// milling), so a row is linked to the next one of its own sense.
struct RowLink {
  std::size_t a = 0, b = 0;  ///< indices of the path's points, a < b
  double distance_mm = 0;
  double along_mm = 0;  ///< length of path that the pair stands for
};

enum class RowSense { same, any };

/// Links each point to the nearest one of a row on either side, no farther than `reach_mm`; in the order of a and b.
/// Points that are fixed are left out.
std::vector<RowLink> row_links(const ShiftPath& path, double reach_mm, RowSense sense = RowSense::same);

/// Returns how much the surface spanned by the path's points turns from row to row because of the shifts: |s_b - s_a|
/// over the rows' distance, as an angle.
struct RowTurn {
  double max_rad = 0;
  std::vector<std::size_t> over;  ///< indices of the links over the bound
};
RowTurn row_turn(const ShiftPath& path, std::span<const RowLink> links, double bound_rad);

}  // namespace camber::compensate
