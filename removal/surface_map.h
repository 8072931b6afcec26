#pragma once
// The form error without the grid's rounding: along the normal of every surface point, the deepest mark of the bent
// envelopes.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/cutter_places.h"
#include "removal/shift_table.h"
#include "removal/stamp.h"
#include "removal/stock.h"
#include "removal/surface.h"

namespace camber::removal {

/// Points of the target's surface (as compare_surfaces has them, moved along their grid line onto the cutters that made
/// the surface there), each with the height of the machined surface along its normal.
///
/// A field between voxels rounds the ridges between two cuts. The bent cutter leaves other ridges than the straight
/// one, sharper by the jump of the deflection as an edge enters the cut, so that rounding does not cancel between
/// two fields: 3.5 % of the error were lost at 0.1 mm voxels (docs/engagement.md). Here every point meets every
/// envelope itself: the height e at which x = q + e n - delta(s, phi) lies on the straight envelope, (s, phi) belonging
/// to x; the least height of all stamps stays. Nothing depends on the number of threads.
class SurfaceMap {
 public:
  /// `places`: the cutters of the target's sweep, by the ids that its voxels name. `blank`: the surface wherever no
  /// mark is deeper. `solid`: see surface_points. Nothing of them is needed afterwards.
  SurfaceMap(const Stock& target, const CutterPlaces& places, const Stock& blank, const Stock* solid = nullptr);
  ~SurfaceMap();

  /// Takes the marks of `stamps`, bent by the rows of `shifts`; ids are first_id + index.
  void mark(const EnvelopeGrid& envelope, std::span<const Stamp> stamps, const ShiftTable& shifts,
            std::int32_t first_id);

  /// The points with what the marks and, where it still stands, the blank say. Ends the map.
  std::vector<SurfacePoint> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
