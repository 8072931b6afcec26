#pragma once
// The envelope that a turning cutter sweeps, and the edges on it.
#include <vector>

#include "base/geometry.h"
#include "machine/job.h"
#include "removal/profile.h"

namespace camber::removal {

/// Envelope of a turning cutter. The tip is the origin, the axis +Z; it has no top.
///
/// Ball, flat and bull-nose cutters are a cylinder of `radius_mm` whose bottom edge is rounded with `corner_radius_mm`
/// (ball: the radius itself; flat: 0); their distance has a short closed form, which carving uses. Every other cutter
/// is `general`: its profile says all, `radius_mm` is its largest and `corner_radius_mm` that of its arc.
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
  /// Its gradient: the envelope's outward normal at the nearest point.
  Vec3 gradient(const Vec3& point_from_tip) const;
};

CutterShape shape_of(const machine::Tool& tool);

/// Points of the envelope at which engagement is sampled: rings along the profile, `steps` points a turn.
///
/// The points of a ring are turned by the ring's lag, so that a straight march through rotation steps meets
/// them exactly: at rotation step m the edge of tooth j stands at point (m + j * steps_per_pitch) mod steps of
/// every ring. Angles run counter-clockwise from +X; under M3 edges run through them backwards, which is a
/// matter of order in time and not of place.
struct EnvelopeGrid {
  CutterShape shape;
  int flutes = 2;
  int steps = 0;            ///< points a ring
  int steps_per_pitch = 0;  ///< steps / flutes
  double lag_per_mm = 0;    ///< tan(helix) / radius

  struct Ring {
    ProfilePoint profile;
    double width_mm = 0;  ///< db, profile arc length that the ring stands for
    double lag_rad = 0;
    float sine = 0, cosine = 0;  ///< of the profile's normal angle
  };
  std::vector<Ring> rings;

  // rings.size() * steps values each, ring by ring, from the tip.
  std::vector<float> x, y, z;     ///< place from the tip
  std::vector<float> nx, ny, nz;  ///< outward normal
  std::vector<float> cos_phi, sin_phi;

  /// Neighbouring points that are met or missed together.
  struct Patch {
    Vec3 centre_from_tip = Vec3::Zero(), normal = Vec3::Zero();
    double radius_mm = 0;                                        ///< around the centre, holds all points
    double normal_spread = 0;                                    ///< largest |n - normal| of its points
    int ring_from = 0, ring_to = 0, step_from = 0, step_to = 0;  ///< half open
  };
  std::vector<Patch> patches;  ///< each point is in one

  std::size_t size() const { return x.size(); }
};

/// Cuts the envelope in patches of about `size_mm`.
void make_patches(EnvelopeGrid& grid, double size_mm);

/// Rings `step_mm` apart (the last one narrower; in small corners all are) from the tip to `top_mm` above it; at least
/// `2 pi / rotation_step_rad` points a ring, rounded up to a multiple of the flutes. More rings reach `above_mm`
/// higher; none lies across top_mm: a ring counts whole or not at all, and where top_mm is the blank's face none is cut
/// in two.
EnvelopeGrid make_envelope(const machine::Tool& tool, double top_mm, double step_mm, double rotation_step_rad,
                           double above_mm = 0);

}  // namespace camber::removal
