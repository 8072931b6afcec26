#pragma once
// Frame: the affine map from programmed coordinates to the frame of the moves.
#include <Eigen/Core>

#include "base/geometry.h"

namespace camber::nc {

/// point in the frame of the moves = linear * programmed point + shift_mm. Made of a shift (work offsets, G52, G92),
/// rotation (G68), mirror image (G51.1), scaling (G51) and tilting (G68.2): see frames.h.
struct Frame {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Identity();
  Vec3 shift_mm = Vec3::Zero();
  bool plain = true;              ///< the identity: nothing to do
  bool shift_only = true;         ///< linear is the identity
  Vec3 origin_mm = Vec3::Zero();  ///< origin of the work offset, in the frame of the moves: what G254 turns
  bool polar = false;             ///< G16: X Y Z of the text are a radius and an angle, not these coordinates

  Vec3 from_program(const Vec3& p) const { return plain ? p : Vec3(linear * p + shift_mm); }
  Vec3 to_program(const Vec3& p) const { return plain ? p : Vec3(inverse * (p - shift_mm)); }
  bool operator==(const Frame& other) const {
    return linear == other.linear && shift_mm == other.shift_mm && polar == other.polar && origin_mm == other.origin_mm;
  }
};

}  // namespace camber::nc
