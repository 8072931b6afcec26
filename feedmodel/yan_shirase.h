#pragma once
// Equations of Yan & Shirase 1997: feed efficiency e, the number k, and their lookahead, for comparison with the paper.
#include <span>
#include <vector>

#include "base/geometry.h"

namespace camber::feedmodel {

/// k = F^2 / (a d): commanded feed against what acceleration a can reach over the mean block length d.
/// 0 for an infinite acceleration. Source: eq. 18.
double block_feed_number(double feed_mm_per_s, double acceleration_mm_per_s2, double block_length_mm);

/// e = f_av / F of a block from rest to rest: 1/(1 + k) for k < 1, else 1/(2 sqrt k). A lower bound of a program's e,
/// reached when every block stops. Source: eqs. 19-20.
double stop_at_every_block_efficiency(double k);

/// A block in which the lookahead brakes.
struct BrakingBlock {
  double entry_mm_per_s = 0, exit_mm_per_s = 0;
};

struct BackCorrection {
  std::vector<double> exit_change_mm_per_s;  ///< one per block
  std::vector<double> time_change_s;         ///< change of each block's braking time
  double time_s() const;
};

/// Returns the cost where the last of the blocks must end slower by -change: the correction runs backward, linearised,
/// df_(i-1) = df_i f_i / f_(i-1), the entry of the first block staying. Each block's braking time changes by
/// (df_entry - df_exit) / a, so that the sum is -change / a whatever the blocks.
/// Source: eqs. 12-14. The planner (lookahead.h) plans again exactly instead; this is their figure, to first order.
BackCorrection back_correction(std::span<const BrakingBlock> blocks, double change_mm_per_s,
                               double acceleration_mm_per_s2);

/// Radius of the circle through three points; infinite on a line. The r_eq of a corner in eq. 16, whose clamp is
/// arc_speed(r_eq, a, 1).
double three_point_radius(const Vec3& a_mm, const Vec3& b_mm, const Vec3& c_mm);

}  // namespace camber::feedmodel
