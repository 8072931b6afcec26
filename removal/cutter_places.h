#pragma once
// Which cutter stood where when a stock's voxels were set: the smooth pieces that a carved surface is made of.
#include <cstdint>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/stamp.h"

namespace camber::removal {

/// Undeflected cutters by stamp id. Ids are added in ascending order.
class CutterPlaces {
 public:
  /// Stamps first_id, first_id + 1, ... of one cutter.
  void add(std::int32_t first_id, const CutterShape& shape, std::span<const Stamp> stamps);
  bool empty() const { return runs_.empty(); }
  bool knows(std::int32_t id) const { return find(id) != nullptr; }
  /// Of a known stamp's envelope, mm, negative inside the cutter.
  double distance_mm(std::int32_t id, const Vec3& point) const;
  Vec3 gradient(std::int32_t id, const Vec3& point) const;
  struct Depth {
    std::int32_t id;
    double depth_mm;  ///< of the point inside that cutter
  };
  /// The stamp that the point lies deepest in, of those met going from a known stamp along its run while it grows
  /// deeper.
  Depth deepest_from(std::int32_t id, const Vec3& point) const;

 private:
  struct Run {
    std::int32_t first_id;
    CutterShape shape;
    std::vector<Vec3> tips;
  };
  const Run* find(std::int32_t id) const;
  std::vector<Run> runs_;
};

}  // namespace camber::removal
