#pragma once
// A stretch of path against the stock: which chip every envelope point takes at every stamp, and what is left.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "removal/chip.h"
#include "removal/cutter.h"
#include "removal/shift_table.h"
#include "removal/stamp.h"
#include "removal/stock.h"

namespace camber::removal {

/// Chips of stamp k: chips[first[k]] ... chips[first[k + 1] - 1].
struct Engagement {
  std::vector<std::size_t> first;
  std::vector<Chip> chips;
  std::span<const Chip> of(std::size_t k) const { return {chips.data() + first[k], first[k + 1] - first[k]}; }
};

struct StretchOptions {
  bool engage = true;         ///< sample chips; false: only carve
  double shrink_mm = 0;       ///< cutter smaller by this along its normal (the blank's allowance); undeflected only
  std::int32_t first_id = 0;  ///< id of stamps[0], written to the voxels that it sets last
  double bent_before_mm = 0;  ///< bounds the shifts of the stamps that are in the stock already
};

/// Space is cut in tiles that take the stamps in order, all tiles at once; no result depends on the number of
/// threads.
///
/// Depth. A trilinear field rounds the ridges where two cuts meet, and most of a finishing chip lies near a ridge
/// (6 % of its volume was lost at 0.1 mm voxels). So the depth of a point is the largest of the smooth fields that
/// meet in its voxel cell: the blank's, read trilinearly, and those of the stamps that the cell's corners name,
/// each evaluated at the point itself; for bent stamps the difference between the corners' values and the straight
/// cutter's is added, weighted as the trilinear weights.
///
/// A chip is h = min(d, max(0, B + (k1 f_m^2 + k2 f_t^2) / 2)): d the depth of the point in the stock as
/// the stamp before left it, f the point's motion since then, B, f_m, f_t its parts along the normal, the meridian
/// and the circle of latitude, k1 and k2 the curvatures there.
///
/// A level face of the stock (the blank's top, the floor of an earlier pass, an allowance on a floor) cuts a whole ring
/// of a cutter's wall in two at once: there the chip tells which share of the ring's width lies in the material, and
/// its thickness is that in the middle of the share.
class Stretch {
 public:
  /// stamps[0] ... stamps[from - 1] are in the stock already; this stretch cuts stamps[from] ... stamps[from +
  /// count - 1]. Ids in the stock are first_id + index; smaller ids count as blank. `blank`: the stock as it stood
  /// before stamps[0]; only read with options.engage (else it may be null). The stock is read, and written by
  /// commit() only. Everything passed must outlive the object.
  Stretch(Stock& stock, const Stock* blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
          std::size_t from, std::size_t count, const StretchOptions& options);
  ~Stretch();

  /// Carves all stamps anew, from the stock as it stands.
  Engagement carve();

  /// Makes the last carve() the stock. Returns the volume that it took, mm^3.
  double commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
