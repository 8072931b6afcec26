#pragma once
// Distances of many places to a cutter's profile, in vectors.
#include <array>

#include "removal/profile.h"

namespace camber::removal {

/// A profile in single precision, at most bottom, corner, wall and cylinder.
class ProfileRows {
 public:
  static constexpr int kMost = 24;  ///< places at once

  explicit ProfileRows(const Profile& profile);

  /// Signed distances of places r[k] from the axis and z[k] above the tip: outside the nearest piece's, inside the same
  /// with the other sign (profile.h). Requires count <= kMost.
  void distances(const float* r, const float* z, int count, float* out) const;
  /// As distances(), for places above each other at r from the axis, the first at z, `step` apart.
  void column(float r, float z, float step, int count, float* out) const;

 private:
  struct Line {
    float r, z, along_r, along_z, length;
  };
  struct Arc {
    float r, z, radius;
    float from_r, from_z, to_r, to_z;  ///< normals at its ends
  };
  int lines_ = 0;
  bool has_arc_ = false;
  std::array<Line, 4> line_{};
  Arc arc_{};
};

}  // namespace camber::removal
