#pragma once
// Static equilibrium of force and deflection, delta = C F(chip(delta)), for one tooth passing.
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
    double size_um = 0;  ///< the same for the deflection
    bool solved = true;
    int steps = 0;  ///< steps of Newton's method
  };
  struct Motion {
    removal::ToothMotion of_tool;
    bool first = false;  ///< Stamp::first
  };
  /// chips: as read with the displacements in `row` (of a DeflectionTable): deflections, and `run_out` where there is
  /// any: the axis' offset at each rotation step, mm, or empty. Goes `share` of the way from `row` to the equilibrium
  /// row = run_out + C F; the chips' thickness follows.
  /// With a part that yields the row has its deflection as well, and what of it is the part's.
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
    double depth_mm, cap_mm;  ///< as read
    double thickness_mm;      ///< the lesser of them, or a tooth's that is not even
    double by_step,
        by_height;   ///< derivatives of the tilt by the deflections of the neighbouring steps and of the nodes
    double lean_mm;  ///< as read
    double width_mm;
    double solved_mm;  ///< thickness with the deflection as it is
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
  /// Contribution of one element to the balance of the axial deflection, and to the derivatives of that balance.
  struct AxialChange {
    double own, side;  ///< derivatives of the thickness by the axial deflections of this step and of its neighbours
  };
  void balance_axial(std::size_t m, double force_z, double slope_z, const std::array<double, 4>& by_own,
                     const std::array<double, 4>& by_side, const AxialChange& by_axial);
  double balance_all();
  void gather_part(const Element& e, std::size_t m, const Vec2& force, double force_z, const Vec2& slope,
                   double slope_z, const std::array<double, 4>& by_own, const std::array<double, 4>& by_side,
                   const AxialChange& by_axial);
  void balance_part(std::size_t m);
  void keep_part(double share, std::span<float> row) const;
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
  std::vector<std::size_t> place_;  ///< indices of the elements found, in elements_
  std::vector<Element> elements_;   ///< rotation step by rotation step
  std::vector<std::size_t> first_;  ///< first element of each rotation step
  double max_lean_mm_ = 0;
  bool first_stamp_ = false;
  std::span<const Vec2> run_out_;  ///< run-out at the rotation steps, mm; empty: none
  bool axial_;                     ///< the tool, or the part, yields along the axis
  // The part, where it yields: compliance of this passing; of rings and nodes their share of its heights; by rotation
  // step what its heights take, [steps][size], how that changes with the coarse deflections and the axial one of its
  // own step and of those beside it, [steps][size][5], and how they move, [steps][size].
  const PartCompliance* part_;
  Eigen::MatrixXd part_mm_per_N_;
  std::vector<HeightWeight> part_ring_;
  std::vector<double> part_N_, part_by_own_, part_by_side_, part_mm_;
  // [steps]: the axial deflection, as the lateral ones below.
  std::vector<double> axial_read_, axial_deflection_, axial_moved_, axial_side_, axial_left_, axial_step_;
  std::vector<double> axial_coarse_;
  /// [steps][5]: of C F along the axis, by the lateral deflections at the first and last node and by the axial one.
  std::vector<double> axial_by_own_, axial_by_side_;
  /// [steps][nodes][2]: of the lateral C F by the axial deflections.
  std::vector<double> by_own_axial_, by_side_axial_;
  // [steps][nodes][2]:
  std::vector<double> read_, deflection_;
  std::vector<double> moved_, side_;  ///< deflection less the one that was read; of the step ahead less of that behind
  std::vector<double> left_;          ///< C F - delta
  std::vector<double> step_;          ///< Newton's
  std::vector<double> by_own_,
      by_side_;                  ///< [steps][nodes][2][4]: of C F, by the deflections at the first and last node
  std::vector<double> coarse_;   ///< [steps][4]: Newton's step there
  std::vector<double> damping_;  ///< [steps]: how much slower than Newton's step a deflection follows
  std::vector<double> norm_;     ///< [steps]: largest of left_
  std::vector<char> stale_;      ///< [steps]: deflections have changed since left_ was worked out
};

}  // namespace camber::deflection
