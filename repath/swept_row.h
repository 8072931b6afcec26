#pragma once
// What a cutter leaves of a row whose tip rises and falls: no tangent in place of the row.
#include <optional>
#include <span>

#include "repath/scallop.h"

namespace camber::repath {

/// The lowest height that a row leaves at a place, and where along the row the cutter stands when it cuts it.
struct SweptHeight {
  double height_mm = 0;
  double at = 0;  ///< in steps of the row
};

/// The least of tip(t) + underside(distance from t) over the row, `place` in steps along it and `v_mm` across; the tip
/// between the samples is a parabola through three of them. A flat cutter touches with its rim, up to a radius before
/// or behind the place, where the row has another slope. Nothing out of the cutter's reach.
std::optional<SweptHeight> swept_height(const Underside& cutter, const RowHeights& row, double step_mm, double place,
                                        double v_mm);

/// The height of what two rows leave beside the k-th sample of both, for cutters with a flat: everything is measured on
/// the rows as they are swept. It is sought where both leave the same, and at the border of the lower one, up to a
/// radius beside the rows; there the lowest of some rows between says where the finished surface is. Nothing where all
/// that lies outside the boundary, or where the cutter only rolls over a border there.
std::optional<double> swept_scallop_mm(const RowSampler& sampler, const Underside& cutter, const RowHeights& a,
                                       const RowHeights& b, std::span<const RowHeights> between, std::size_t k);

}  // namespace camber::repath
