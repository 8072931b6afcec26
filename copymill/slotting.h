#pragma once
// Slotting: cuts trochoids where a pass would have the cutter's full width in the cut.
#include <optional>
#include <vector>

#include "copymill/approach.h"
#include "copymill/operation.h"
#include "copymill/standing.h"
#include "copymill/trochoid.h"

namespace camber::copymill {

/// Where a pass would cut the tool's full width, circles are cut around it first, which advance so that the tool's
/// engagement angle stays within that of the operation's radial depth (copymill/trochoid.h); the pass then finds no
/// more than the rest. With CopyOperation::slotting `by_load` that is done only where a full cut would be over the
/// force that the operation asks for even at the lowest feed and depth; without such a target never.
class Slotting {
 public:
  /// Fraction of the tool's diameter: no smaller circles are run. A slot, less the allowance on either side, must be
  /// wider than the tool by twice as much, and a hundredth of it.
  static constexpr double kSmallest = 0.05;
  static constexpr double kLargest = 0.25;  ///< fraction of the diameter: no larger circles are run

  Slotting(const Workplace& place, Approach& approach) : place_(place), approach_(approach) {}

  /// Returns whether trochoids may be needed at the present radial depth.
  bool wanted() const;
  double smallest_mm() const { return 2 * kSmallest * place_.cut.shape.radius_mm; }
  double largest_mm() const { return 2 * kLargest * place_.cut.shape.radius_mm; }
  /// Returns whether a pass would have the full width in the cut somewhere.
  bool full_width(const Pass& pass) const;
  /// Cuts trochoids around the stretches of a level pass that would have. `own`: the pass itself is to be cut next, and
  /// the log tells why a stretch of it stays a full cut.
  Runner::Ended clear(const Pass& pass, bool own);

 private:
  struct Stretch {
    std::vector<Vec2> guide;  ///< close together
    double z_mm = 0;
  };
  /// Circles that follow each other in material; the first may lie in air.
  using Row = std::vector<Circle>;

  std::vector<Stretch> full_stretches(const Pass& pass) const;
  bool full_at(const Standing& standing, const Vec3& tip, const Vec2& direction) const;
  double limit_rad() const;
  double greatest_share(const Stretch& stretch) const;
  bool inside(const Vec2& p, double z_mm) const;
  double room_mm(const Vec2& centre, double z_mm) const;
  bool joined(const Circle& a, const Circle& b, double z_mm) const;
  bool meets(const Standing& standing, const Circle& circle, double z_mm) const;
  std::vector<Row> rows(const Stretch& stretch) const;
  Runner::Ended cut(const Row& row, double z_mm);

  const Workplace& place_;
  Approach& approach_;
};

}  // namespace camber::copymill
