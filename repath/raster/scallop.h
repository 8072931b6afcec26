#pragma once
// Height of the scallops that neighbouring rows leave, measured on the offset surface itself.
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "repath/raster/drop_cutter.h"

namespace camber::repath {

/// Where rows lie: along a direction, side by side across it.
struct RowFrame {
  Vec2 along = Vec2(1, 0), across = Vec2(0, 1);  ///< unit, at right angles
  Vec2 place(double u, double v) const { return u * along + v * across; }
};

/// The part that is worked: a rectangle in X and Y.
struct Rectangle {
  Vec2 min = Vec2::Zero(), max = Vec2::Zero();
};

/// A contact counts where it lies in the rectangle; on its border only where the cutter does not roll over it, and
/// under a flat bottom, which touches anywhere, only with the axis inside.
bool works_inside(const Underside& cutter, const Rectangle& boundary, const Vec2& axis, const DropContact& contact);

/// Whether a contact lies in the rectangle or on its border.
bool touches(const Rectangle& boundary, const DropContact& contact);

/// Heights of the tip along a row, at equal steps.
struct RowHeights {
  double v_mm = 0;
  std::vector<std::optional<double>> tip_mm;
  std::vector<char> inside;  ///< works_inside()
  bool any_inside() const;
};

/// Samples rows, always at the same places along them.
class RowSampler {
 public:
  RowSampler(const DropCutter& part, const RowFrame& frame, const Rectangle& boundary, double step_mm);
  RowHeights row(double v_mm) const;
  /// Whether the place beside the k-th sample of a row lies in the boundary.
  bool covers(std::size_t k, double v_mm) const;
  double step_mm() const { return step_; }
  double v_min_mm() const { return v_min_; }  ///< of the boundary
  double v_max_mm() const { return v_max_; }
  double u_min_mm() const { return u_min_; }
  double u_max_mm() const { return u_max_; }

 private:
  const DropCutter& part_;
  RowFrame frame_;
  Rectangle boundary_;
  double step_;
  double u_min_ = 0, u_max_ = 0, v_min_ = 0, v_max_ = 0;
};

/// The largest height, along the normal, of what two rows leave standing between them and rows in between would take.
///
/// At each place along the rows the cutter's groove in the plane across them is the row's height minus rise_on_line()
/// at the row's slope; the scallop's tip is where the grooves of both rows cross (at one point only, as the cutter is
/// convex), and what the rows between leave there is the finished surface: one row, halfway, for a ball; seven for a
/// cutter with a flat, whose steps on a slope the nearest of them still misses by an eighth, which is added; for these
/// swept_scallop_mm() measures, wherever it can.
/// On a plane of any slope that gives R - sqrt(R^2 - (w/2)^2), w the distance of the rows along it, for a ball, and the
/// step's w sin(slope) for a flat cutter; on a curved surface the curvature is in it to second order.
double scallop_mm(const RowSampler& sampler, const Underside& cutter, const RowHeights& a, const RowHeights& b);

struct RowSpacing {
  std::vector<double> rows_mm;  ///< v of each, ascending
  double largest_scallop_mm = 0;
  double steep_fraction = 0;  ///< of the spaces between rows: where the scallop asked for would need closer rows than
                              ///< closest_mm
  double closest_mm = 0;
};

/// Rows over the boundary, as far apart as the scallop allows at the worst place along each, but no closer than a tenth
/// of what it allows on a level plane; no farther than twice that and three quarters of the diameter. One row on either
/// side lies on the border or beyond, as far as the cutter touches inside. `increment_mm`: v is rounded to it.
/// `progress`: called with the completed fraction of the boundary; may be empty.
RowSpacing space_rows(const RowSampler& sampler, const Underside& cutter, double scallop_mm, double increment_mm,
                      const std::function<void(double)>& progress = {});

// What a cutter leaves of a row whose tip rises and falls: no tangent in place of the row.

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
