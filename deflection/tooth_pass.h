#pragma once
// Force on the tool and its deflection at every rotation step of one tooth passing.
#include <span>
#include <vector>

#include "deflection/beam.h"
#include "deflection/chip_ends.h"
#include "deflection/part_compliance.h"
#include "deflection/teeth.h"
#include "deflection/tool_frame.h"
#include "machine/material.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/engagement.h"

namespace camber::deflection {

/// Number of deflections per rotation step: an edge that enters the material at once changes the force within less than
/// a step.
constexpr int kFine = 4;

/// One tooth passing. Sized once, filled for many stamps.
struct ToothPass {
  std::vector<Vec3> force_N;         ///< per rotation step, on the tool, tool's frame
  std::vector<double> torque_Nmm;    ///< spindle torque per rotation step
  double work_Nmm = 0;               ///< work work of the spindle over the tooth passing
  double chip_max_mm = 0;            ///< thickest chip
  double chip_area_mm2 = 0;          ///< area of the envelope in the cut; chip volume / area is the mean thickness
  std::vector<float> deflection_mm;  ///< as a row of removal::DeflectionTable
};

/// One revolution of the spindle, tooth by tooth. Turned clockwise by angle a from where tooth 1's edge at the tip
/// points along +X, the edge of tooth t stands at t pitches minus a, counter-clockwise from +X.
struct TurnForces {
  struct Tooth : ToolLoad {
    double chip_max_mm = 0;  ///< maximum along the edge at this instant
  };
  std::vector<std::vector<Tooth>> teeth;  ///< [flutes][rotation steps of a turn]
};

/// One tooth at one point of the envelope.
struct EdgeElement {
  std::uint32_t chip = 0;  ///< number of the chip
  int step = 0;            ///< rotation step at which the tooth stands there
  double thickness_mm = 0;
};

/// Turns chips into forces and deflections for one tool in one material.
class ToothPassModel {
 public:
  ToothPassModel(const removal::EnvelopeGrid& envelope, const machine::Material& material, const Beam& beam,
                 std::vector<double> node_height_mm, double edge_ramp_mm, Teeth teeth,
                 const Vec3& axis_compliance_mm_per_N = Vec3::Zero(), const PartCompliance* part = nullptr);

  /// The tool, or the part under it, yields along the axis.
  bool axial() const { return axial_compliance_mm_per_N_ > 0 || part_ != nullptr; }
  /// Compliance of the workpiece in this run; null: it is rigid.
  const PartCompliance* part() const { return part_; }
  /// Axial compliance of the whole tool, machine included, to an axial force at the tip. A force higher up stretches
  /// less of the bar; for a hundred newtons the difference is hundredths of a micrometre.
  double axial_compliance_mm_per_N() const { return axial_compliance_mm_per_N_; }
  int steps() const { return envelope_.steps_per_pitch; }
  const std::vector<double>& node_height_mm() const { return node_height_mm_; }
  /// `passing` counts tooth passings since the start of the tool and identifies the tooth; it only matters for
  /// non-uniform teeth. `motion`: in one mean pitch.
  void evaluate(std::span<const removal::ChipSample> chips, std::size_t passing, const removal::ToothMotion& motion,
                ToothPass& out) const;
  /// The same for chips in blocks, with the instants at which each edge element enters and leaves the material; without
  /// feedback. fine_mm: takes the deflection of steps * kFine rotation steps, a row of removal::DeflectionTable, with
  /// the part's where part() is given; `passing` then counts the stamps of the run.
  void evaluate(const removal::EnvelopeBlocks& blocks, std::span<const removal::ChipBlock> chips, std::size_t passing,
                const removal::ToothMotion& motion, ToothPass& out, std::span<float> fine_mm) const;
  /// The edge elements of the chips, including those with negative thickness.
  void edge_elements(std::span<const removal::DeflectedChipSample> chips, std::size_t passing,
                     const removal::ToothMotion& motion, std::vector<EdgeElement>& out) const;
  EdgeDirections direction(std::uint32_t point, const removal::EnvelopeGrid::Ring& ring) const;
  /// Position of a point of the envelope, from the tip, in the tool frame.
  Vec3 place_mm(std::uint32_t point) const;
  const machine::Material& material() const { return material_; }
  double edge_ramp_mm() const { return edge_ramp_mm_; }
  /// Compliance of the node's x and y to a force at a ring, mm/N.
  Vec2 compliance_mm_per_N(std::size_t ring, std::size_t node) const {
    return axis_compliance_.array() + compliance_[ring * node_height_mm_.size() + node];
  }
  /// Adds the chips of one tooth passing, the turn's `pass`-th (0 ... flutes - 1), to the turn.
  void add_to_turn(std::span<const removal::ChipSample> chips, std::size_t pass, std::size_t passing,
                   const removal::ToothMotion& motion, TurnForces& turn) const;

 private:
  /// Calls f(chip number, rotation step, thickness) for the elements of chips.
  template <class Chips, class Function>
  void for_each_element(const Chips& chips, std::size_t passing, const removal::ToothMotion& motion, Function f) const;
  /// Additional depth of tooth j in an older surface compared with uniform teeth, along the normal. A surface cut by
  /// the same tool is as deep as its longest tooth left it.
  double deeper_mm(int j, bool own_surface, const removal::EnvelopeGrid::Ring& ring) const;
  /// Chip of tooth j where uniform teeth would take `chip`.
  double tooth_chip_mm(int j, const removal::ChipSample& chip, const EdgeDirections& d,
                       const removal::EnvelopeGrid::Ring& ring, const removal::ToothMotion& motion) const;
  /// The same for a block of points, without clipping at zero: negative values are distances to the material.
  removal::ChipBlock tooth_block(int j, const removal::EnvelopeBlocks& blocks, const removal::ChipBlock& even,
                                 const removal::ToothMotion& motion) const;
  /// Motion bound of one mean pitch at a point, along the normal (removal/engagement.h).
  struct MotionChip {
    double even_mm, bulge_mm;  ///< bulge_mm: the part due to curvature
  };
  MotionChip motion_chip(const EdgeDirections& d, const removal::EnvelopeGrid::Ring& ring, const Vec3& motion_mm) const;
  /// Adds the force and deflection of one edge element at rotation step m.
  void add(const removal::ChipSample& chip, double thickness_mm, const EdgeDirections& d, std::uint32_t ring,
           std::size_t m, std::vector<double>& deflection, ToothPass& out) const;

  void add_end(const ChipEnd& end, double* sums, std::size_t row, std::span<float> fine_mm,
               std::span<double> fine_N) const;
  /// Adds the part's deflection to a row. fine_N: forces as PartCompliance gathers them, [size][steps * kFine].
  void add_part(std::size_t passing, std::span<const double> fine_N, std::span<float> fine_mm) const;

  const removal::EnvelopeGrid& envelope_;
  machine::Material material_;
  double edge_ramp_mm_;
  Vec2 axis_compliance_;  ///< compliance of the machine's x and y axes, mm/N, the same at every height
  double axial_compliance_mm_per_N_;
  Teeth teeth_;
  std::vector<int> tooth_step_;  ///< rotation steps from tooth 0 to each tooth
  std::vector<double> node_height_mm_;
  std::vector<double> compliance_;  ///< [rings][nodes], mm/N
  const PartCompliance* part_;
  std::vector<HeightWeight> part_weight_;  ///< height weights of each ring
};

/// Heights for a cutter that is engaged up to `top_mm`: evenly spaced, where 12 nodes suffice at most 2 mm or a tenth
/// of the fluted length L apart. Below a force F a beam is straight, above it its curvature is F (z - z_F) / (E I):
/// linear interpolation between nodes a tenth of L apart beside a force has an error of less than a twentieth of a
/// percent of F L^3 / (3 E I).
std::vector<double> node_heights(double top_mm, double fluted_length_mm = 0);

// Where the chips of a tooth passing are around the tool: what a vibration of the tool meets.

/// Integrals over the envelope in the cut, of height dz and angle dphi: of 1, of cos 2 phi and sin 2 phi, and of the
/// sine of the profile's normal angle. phi counter-clockwise from x in the tool's frame (tool_frame.h). With them the
/// mean directional matrix of any engagement is known (dynamics/vibrating_cut.h).
struct ChipArc {
  float area_mm_rad = 0;  ///< area of the arc: for a single one its depth times its angle
  float cosine_mm_rad = 0, sine_mm_rad = 0;
  float wall_mm_rad = 0;  ///< as much as the first on an upright wall, less on a floor

  ChipArc operator+(const ChipArc& b) const {
    return {area_mm_rad + b.area_mm_rad, cosine_mm_rad + b.cosine_mm_rad, sine_mm_rad + b.sine_mm_rad,
            wall_mm_rad + b.wall_mm_rad};
  }
  friend ChipArc operator*(double f, const ChipArc& a) {
    const auto k = static_cast<float>(f);
    return {k * a.area_mm_rad, k * a.cosine_mm_rad, k * a.sine_mm_rad, k * a.wall_mm_rad};
  }
};

/// Chips thinner than this are no cut: a tool that vibrates swings out of them.
constexpr float kThinnestChip_mm = 5e-4f;

ChipArc chip_arc(const removal::EnvelopeGrid& envelope, std::span<const removal::ChipSample> chips);
ChipArc chip_arc(const removal::EnvelopeGrid& envelope, const removal::EnvelopeBlocks& blocks,
                 std::span<const removal::ChipBlock> chips);

}  // namespace camber::deflection
