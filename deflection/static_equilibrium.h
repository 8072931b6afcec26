#pragma once
// Solves the static equilibrium of force and deflection of one tooth passing, delta = C F(chip(delta)).
//
// delta is the deflection of the tool at every rotation step and node height, C the compliance of beam and machine, F
// the force of all edge elements at that step. The chip of an element changes with the deflection of its own step
// (depth and motion bound, as removal::DeflectedChipSample gives them) and, through the tilt of the deflected envelope,
// with that of the steps before and after. Newton's method therefore solves a cyclic block-tridiagonal system around
// the turn:
//   (1 - own_m) x_m - side_m (x_(m+1) - x_(m-1)) = left_m,
// with four unknowns per step (lateral deflection at the first and the last node) or five (the axial one too). Where
// the force has corners and Newton's method oscillates, the deflection creeps to a stable equilibrium instead (creep).
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "deflection/tooth_pass.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/engagement.h"

namespace camber::deflection {

/// Solves the equilibrium of one tooth passing for chips that were read once. With the deflection, the depth of a point
/// and its motion bound change linearly as read; the bound also depends on the tilt of the deflected envelope, that is
/// on the deflections of the previous and next rotation steps. Force follows from its law, including the edge ramp and
/// loss and start of contact. Newton's method over all rotation steps at once; the lateral deflection that feeds back
/// is taken as a straight line over the height (what is left of delta - C F is that of all heights), the axial one is
/// the same at all heights.
class StaticEquilibrium {
 public:
  StaticEquilibrium(const removal::EnvelopeGrid& envelope, const ToothPassModel& model);

  struct Step {
    double rms_um = 0;   ///< rms of the change at the tip over the rotation steps in the cut
    double size_um = 0;  ///< rms of the deflection itself, likewise
    bool solved = true;
    int steps = 0;  ///< number of Newton steps
  };
  struct Motion {
    removal::ToothMotion of_tool;
    bool first = false;  ///< Stamp::first
  };
  /// Moves `row` by the fraction `share` of the way to the equilibrium row = run_out + C F, and updates the thickness
  /// of `chips`. `row`: displacements of the stamp, a row of removal::DeflectionTable; `chips`: as read with these
  /// displacements; `run_out`: offset of the axis at each rotation step, mm; empty: none.
  Step solve(std::span<removal::DeflectedChipSample> chips, std::size_t passing, const Motion& motion, double share,
             std::span<const Vec2> run_out, std::span<float> row);

 private:
  struct Ring {
    removal::NodeWeight weight;  ///< upper: the node above, where there is one
    double height_fraction;      ///< from the first node to the last
    double sine, per_radius;
  };
  struct Element {
    Vec2 normal, tangential, meridian, deeper;
    double normal_z, meridian_z, deeper_z;
    double depth_mm, cap_mm;  ///< depth and motion bound as read
    double thickness_mm;      ///< the smaller of the two; for a non-uniform tooth its own chip
    double by_step,
        by_height;   ///< derivatives of the tilt term: by the steps before and after, by the nodes
    double lean_mm;  ///< tilt term of the chip, as read
    double width_mm;
    double solved_mm;  ///< thickness with the present deflection
    std::uint32_t ring, chip;
  };
  void place_elements(std::span<const removal::DeflectedChipSample> chips, std::size_t passing, const Motion& motion);
  Element element(const EdgeElement& found, const removal::DeflectedChipSample& chip,
                  const removal::ToothMotion& motion) const;
  void place_deflections();
  void place_axial();
  Vec2 at_ring(const std::vector<double>& deflection, const Ring& ring, std::size_t m) const;
  double lean_mm(const Element& e, std::size_t m) const;
  void balance(std::size_t m);
  /// Derivatives of an element's thickness by axial deflections.
  struct AxialChange {
    double own, side;  ///< by the axial deflection of this step, and of the steps beside it
  };
  void balance_axial(std::size_t m, double force_z, double slope_z, const std::array<double, 4>& by_own,
                     const std::array<double, 4>& by_side, const AxialChange& by_axial);
  double balance_all();
  template <int kUnknowns>
  void solve_coarse();
  void advance();
  void advance_axial(std::size_t m, std::size_t ahead, std::size_t behind, bool stays);
  void step_from(const std::vector<double>& from, const std::vector<double>& axial_from, double way);
  void creep(Step& out);

  const removal::EnvelopeGrid& envelope_;
  const ToothPassModel& model_;
  std::size_t steps_, nodes_;
  std::vector<Ring> rings_;
  std::vector<EdgeElement> found_;
  std::vector<std::size_t> place_;  ///< index in elements_ of each element found
  std::vector<Element> elements_;   ///< rotation step by rotation step
  std::vector<std::size_t> first_;  ///< index of the first element of each rotation step
  double max_lean_mm_ = 0;
  bool first_stamp_ = false;
  std::span<const Vec2> run_out_;  ///< one per rotation step; empty: none
  bool axial_;                     ///< the tool yields along its axis
  // [steps]: axial counterparts of the lateral arrays below.
  std::vector<double> axial_read_, axial_deflection_, axial_moved_, axial_side_, axial_left_, axial_step_;
  std::vector<double> axial_coarse_;
  /// [steps][5]: derivatives of the axial C F by the lateral deflections at the first and last node and by the axial
  /// one.
  std::vector<double> axial_by_own_, axial_by_side_;
  /// [steps][nodes][2]: derivatives of the lateral C F by the axial deflections.
  std::vector<double> by_own_axial_, by_side_axial_;
  // [steps][nodes][2]:
  std::vector<double> read_, deflection_;
  std::vector<double> moved_, side_;  ///< deflection minus the one that was read; step ahead minus step behind
  std::vector<double> left_;          ///< residual C F - delta
  std::vector<double> step_;          ///< Newton step
  std::vector<double> by_own_,
      by_side_;                  ///< [steps][nodes][2][4]: derivatives of C F by the first and last node
  std::vector<double> coarse_;   ///< [steps][4]: Newton step at these two nodes
  std::vector<double> damping_;  ///< [steps]: how much slower than Newton's step a deflection follows
  std::vector<double> norm_;     ///< [steps]: largest magnitude of left_
  std::vector<char> stale_;      ///< [steps]: deflections have changed since left_ was calculated
};

}  // namespace camber::deflection
