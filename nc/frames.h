#pragma once
// Coordinate frames: shifts, rotations, mirror images and scales between programmed and actual coordinates.
#include <optional>

#include <Eigen/Core>

#include "nc/arcs.h"
#include "nc/frame.h"
#include "nc/offsets.h"

namespace camber::nc {

/// A tilted frame (G68.2) in the coordinates that were active before it.
struct Tilt {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< columns: its X, Y, Z
  Vec3 origin_mm = Vec3::Zero();
};

/// The map that G52, G92, G68, G68.2, G51, G51.1 and the work offsets make together. A programmed point is mirrored,
/// then scaled, then rotated (each about its own centre), then taken from the tilted frame to the work offset, shifted
/// by G52 and G92, turned by the work offset's own rotation (G10 L2 R) and shifted by the work offset.
struct Frames {
  explicit Frames(const std::map<int, Vec3>& work_offsets_mm) : offsets(work_offsets_mm) {}

  WorkOffsets offsets;
  Vec3 g52_mm = Vec3::Zero(), g92_mm = Vec3::Zero();
  Vec3 g92_kept_mm = Vec3::Zero();  ///< shift that G92.3 restores
  std::array<std::optional<double>, 3> mirror_at_mm{};
  Vec3 scale = Vec3::Ones(), scale_centre_mm = Vec3::Zero();
  double rotation_rad = 0;
  Vec3 rotation_centre_mm = Vec3::Zero();
  bool rotated = false;
  Plane rotation_plane = Plane::xy;
  bool polar = false;
  std::optional<Tilt> tilt{};  ///< G68.2

  /// The map for the work offset; `first`: see WorkOffsets::origin_mm.
  Frame frame(int work_offset, bool first);
  /// The point in the coordinates of the work offset, before G52 and G92, of a programmed one: mirrored, scaled,
  /// rotated.
  Vec3 in_work_mm(const Vec3& programmed_mm) const;
  /// The turn of the work offset itself (G10 L2 R).
  Eigen::Matrix3d offset_rotation(int work_offset) const;
};

/// The rotation of G68.2: about Z by the first Euler angle, about the new X by the second, about the new Z by the
/// third.
Eigen::Matrix3d euler_zxz(const Vec3& angles_rad);

/// Rotation in a plane, counter-clockwise seen against its normal.
Eigen::Matrix3d rotation_in(Plane plane, double angle_rad);

/// The arc in the frame of the moves; the sense turns where the frame mirrors the arc's plane. Nothing where the scale
/// differs along the two axes of the plane: the arc would be an ellipse.
std::optional<Arc> from_program(const Frame& frame, const Arc& arc);
/// The reverse of from_program.
Arc to_program(const Frame& frame, const Arc& arc);

}  // namespace camber::nc
