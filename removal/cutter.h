#pragma once
// The envelope of a rotating cutter, and the edges on it.
#include <vector>

#include "base/geometry.h"
#include "machine/tool.h"
#include "removal/profile.h"

namespace camber::removal {

/// Envelope of a rotating cutter. Tool frame: origin at the tip, axis +Z. Unbounded upwards.
///
/// Ball, flat and bull-nose cutters are a cylinder of `radius_mm` whose bottom edge is rounded with `corner_radius_mm`
/// (ball: the radius itself; flat: 0); their distance has a closed form, which carving uses. All other cutters are
/// `general` and described by their profile; `radius_mm` is the largest radius and `corner_radius_mm` that of the arc.
struct CutterShape {
  double radius_mm = 0;
  double corner_radius_mm = 0;
  bool general = false;
  Profile profile{};

  bool ball() const { return !general && corner_radius_mm >= radius_mm; }

  /// Rounded cylinders: length of the flat bottom and of the rounding along the profile; the wall begins after both.
  double bottom_length_mm() const { return radius_mm - corner_radius_mm; }
  double arc_length_mm() const { return corner_radius_mm * kPi / 2; }

  /// Signed distance to the envelope, negative inside the cutter. Exact outside; inside exact for a general cutter,
  /// for the others as long as the nearest point of the envelope is the bottom or the wall.
  double distance_mm(const Vec3& point_from_tip) const;
  /// Gradient of distance_mm: outward normal of the envelope at the nearest point, unit length.
  Vec3 gradient(const Vec3& point_from_tip) const;
};

CutterShape shape_of(const machine::Tool& tool);

/// Points of the envelope at which engagement is sampled: rings along the profile, `steps` points per revolution.
///
/// The points of a ring are turned by the ring's lag, so that edges pass them exactly at rotation steps: at rotation
/// step m the edge of tooth j is at point (m + j * steps_per_pitch) mod steps of every ring. Angles run
/// counter-clockwise from +X; under M3 edges pass them in reverse order.
struct EnvelopeGrid {
  CutterShape shape;
  int flutes = 2;
  int steps = 0;            ///< points a ring
  int steps_per_pitch = 0;  ///< steps / flutes
  double lag_per_mm = 0;    ///< tan(helix) / radius

  struct Ring {
    ProfilePoint profile;
    double width_mm = 0;  ///< db, arc length of the profile represented by the ring
    double lag_rad = 0;
    float sine = 0, cosine = 0;  ///< sine and cosine of the profile's normal angle
  };
  std::vector<Ring> rings;

  // rings.size() * steps values each, ring by ring, from the tip.
  std::vector<float> x, y, z;     ///< position from the tip
  std::vector<float> nx, ny, nz;  ///< outward normal
  std::vector<float> cos_phi, sin_phi;

  /// A group of neighbouring points, for culling.
  struct Patch {
    Vec3 centre_from_tip = Vec3::Zero(), normal = Vec3::Zero();
    double radius_mm = 0;      ///< radius of a sphere around the centre that contains all points
    double normal_spread = 0;  ///< largest |n - normal| of its points
    int ring_from = 0, ring_to = 0, step_from = 0, step_to = 0;  ///< half open
  };
  std::vector<Patch> patches;  ///< each point belongs to one

  std::size_t size() const { return x.size(); }
};

/// Divides the envelope into patches of about `size_mm`.
void make_patches(EnvelopeGrid& grid, double size_mm);

/// Rings `step_mm` apart (the last one narrower; in small corners all are) from the tip to `top_mm` above it; at least
/// `2 pi / rotation_step_rad` points a ring, rounded up to a multiple of the flutes. Further rings extend `above_mm`
/// higher. No ring extends across top_mm, because a ring counts completely or not at all.
EnvelopeGrid make_envelope(const machine::Tool& tool, double top_mm, double step_mm, double rotation_step_rad,
                           double above_mm = 0);

}  // namespace camber::removal
