#pragma once
// Forces of a straight cut at constant depth and width, without a stock: closed forms and quadrature, as in dynamometer
// tests. Used by the force fit, by plans and by checks.
#include <vector>

#include "base/geometry.h"
#include "machine/material.h"
#include "machine/tool.h"
#include "removal/cutter.h"

namespace camber::deflection {

/// Side of the work, seen along the feed of the tool: under M3 left for up milling, right for down milling.
enum class Milling { up, down };

struct SteadyCut {
  double feed_per_tooth_mm = 0;
  double axial_depth_mm = 0;
  double radial_depth_mm = 0;  ///< up to the diameter; at the diameter: a slot
  Milling milling = Milling::up;
  /// Circular chip: to second order in feed / radius (removal/engagement.h), including the small cut behind the
  /// quadrant of the feed. Otherwise h = f sin(phi) sin(kappa), as in the closed forms.
  bool circular_chip = false;
};

/// Offset of the cutter axis from the spindle axis, in the tool's frame: x towards tooth 1's edge at the tip,
/// counter-clockwise seen from above.
using RunOut = Vec2;

/// Forces on the tool in the frame of the cut, N: x along the tool's feed, y to its left, z up (away from the work).
///
/// h = f_t sin(phi) sin(kappa), the chip of the closed forms, or the circular chip; each edge is cut in rings of at
/// most `ring_mm` of arc length. Run-out makes h the smallest over the teeth before, h(m f_t) + e_j - e_(j-m), m = 1
/// ... N (Kline & DeVor 1983). An element takes the share of a rotation step that it cuts in.
class SteadyCutModel {
 public:
  SteadyCutModel(const machine::Tool& tool, const SteadyCut& cut, double ring_mm = 0.25);

  /// Returns the mean force over whole turns, without run-out. Integrated by Gauss' rule: exact to rounding with the
  /// linear law and the closed forms' chip.
  Vec3 mean_N(const machine::Material& material) const;

  /// Returns the mean forces over `steps` equal steps of one turn. Step i is turned clockwise from where tooth 1's edge
  /// at the tip points along the feed by phase_rad + (i + 1/2) 2 pi / steps.
  std::vector<Vec3> waveform_N(const machine::Material& material, const RunOut& run_out_mm, double phase_rad,
                               int steps) const;

  /// Return the volume that a tooth removes, mm^3, and the mean torque of the spindle, N mm, without run-out.
  double chip_mm3() const;
  double torque_mean_Nmm(const machine::Material& material) const;

 private:
  struct Ring {
    double radius_mm = 0, width_mm = 0, lag_rad = 0;
    double sine = 0, cosine = 0;         ///< sine and cosine of the profile's normal angle
    double entry_rad = 0, exit_rad = 0;  ///< counter-clockwise from the feed, entry < exit; equal: never cuts
    bool fades_in = false,
         fades_out = false;  ///< the chip begins or ends at zero thickness, not at the side of the work
    double meridian_curvature = 0, parallel_curvature = 0;  ///< 1/mm; 0 with the closed forms' chip
  };
  /// Chip thickness at phi for a motion by `feed` along the feed's direction, mm.
  static double chip_mm(const Ring& ring, double feed, double phi);
  /// Calls f(ring, phi, h, weight) at the nodes of Gauss' rule; the weights add up to the engaged angle.
  template <class Function>
  void integrate(Function f) const;

  std::vector<Ring> rings_;
  int flutes_ = 2;
  double feed_per_tooth_mm_ = 0;
};

}  // namespace camber::deflection
