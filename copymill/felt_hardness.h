#pragma once
// Felt hardness: remembers how much harder than expected the material was where the tool has been.
#include <cstdint>
#include <unordered_map>

#include "base/geometry.h"

namespace camber::copymill {

/// The ratio of felt to expected load, remembered by the place of the chips in X and Y, whatever their height: a
/// loop beside one that has been cut, or the level below, need not find out again that a part of the material is hard.
/// The ratio is that of mean torques, a sum in which every chip counts for itself. Lateral forces of chips on both
/// sides of a border may cancel, and where some of them grow by 1.4 their sum may by 1.9.
class FeltHardness {
 public:
  explicit FeltHardness(double cell_mm) : cell_mm_(cell_mm) {}

  /// Takes a tooth passing. The value of a cell rises at once, and falls by a fifth of the difference.
  void feel(const Vec3& chips, double ratio);
  /// The greatest in the cell of a place and those beside it; 1 at least.
  double at(const Vec3& chips) const;

 private:
  std::uint64_t cell(const Vec3& place, int di, int dj) const;

  double cell_mm_;
  std::unordered_map<std::uint64_t, float> ratio_;
};

}  // namespace camber::copymill
