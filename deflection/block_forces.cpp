// ToothPassModel on chips in blocks: the same sums as one chip at a time, four rotation steps side by side.
#include <algorithm>
#include <array>
#include <cmath>

#include "deflection/edge_force.h"
#include "deflection/tooth_pass.h"
#include "removal/envelope_blocks.h"
#include "removal/vector_clones.h"

namespace camber::deflection {

using removal::EnvelopeBlocks;

namespace {

constexpr int kSteps = EnvelopeBlocks::kSteps;

/// Of four chips of one ring, N, as edge_force has them.
struct EdgeForces {
  std::array<double, kSteps> tangential, radial, axial;
};

/// Where the four chips stand and what their forces are added to.
struct Sums {
  const float *cosine_phi, *sine_phi;
  double sine, cosine;  ///< of the ring's normal angle
  double radius_mm;
  const double* compliance;  ///< [nodes] of the ring, mm/N
  double axis_x, axis_y;     ///< compliance of the machine's axes, mm/N
  int nodes, row;            ///< of deflection: steps, filled up
  double *fx, *fy, *fz, *torque, *deflection;
};

CAMBER_VECTOR_CLONES
void add_four(const EdgeForces& e, const Sums& s) {
  std::array<double, kSteps> x, y;
  for (std::size_t l = 0; l < kSteps; ++l) {
    const double c = s.cosine_phi[l], sn = s.sine_phi[l];
    const double outward = e.radial[l] * s.sine + e.axial[l] * s.cosine;
    x[l] = -(e.tangential[l] * sn + outward * c);
    y[l] = -(outward * sn - e.tangential[l] * c);
    s.fx[l] += x[l];
    s.fy[l] += y[l];
    s.fz[l] += e.radial[l] * s.cosine - e.axial[l] * s.sine;
    s.torque[l] += e.tangential[l] * s.radius_mm;
  }
  for (int n = 0; n < s.nodes; ++n) {
    const double wx = s.compliance[n] + s.axis_x, wy = s.compliance[n] + s.axis_y;
    double *dx = s.deflection + 2 * n * s.row, *dy = dx + s.row;
    for (std::size_t l = 0; l < kSteps; ++l) dx[l] += wx * x[l];
    for (std::size_t l = 0; l < kSteps; ++l) dy[l] += wy * y[l];
  }
}

/// Linear law without a ramp.
inline void linear_forces(const machine::Material& m, const float* h, const std::uint8_t* cut_255, double width,
                          EdgeForces& e) {
  for (std::size_t l = 0; l < kSteps; ++l) {
    const double thickness = h[l], cuts = h[l] > 0 ? cut_255[l] / 255.0 * width : 0.0;
    e.tangential[l] = (m.ktc_MPa * thickness + m.kte_N_per_mm) * cuts;
    e.radial[l] = (m.krc_MPa * thickness + m.kre_N_per_mm) * cuts;
    e.axial[l] = (m.kac_MPa * thickness + m.kae_N_per_mm) * cuts;
  }
}

}  // namespace

void ToothPassModel::evaluate(const EnvelopeBlocks& blocks, std::span<const removal::ChipBlock> chips,
                              std::size_t passing, const Vec3& feed, ToothPass& out) const {
  if (with_feedback_ || !teeth_.even()) return evaluate(removal::chips_of(blocks, chips), passing, feed, out);
  const auto steps = static_cast<std::size_t>(envelope_.steps_per_pitch);
  const std::size_t nodes = node_height_mm_.size(), row = (steps + kSteps - 1) / kSteps * kSteps;
  const int last = static_cast<int>(envelope_.rings.size()) - 1;
  thread_local std::vector<double> sums;
  sums.assign((4 + 2 * nodes) * row, 0.0);
  Sums s{};
  s.nodes = static_cast<int>(nodes), s.row = static_cast<int>(row);
  s.axis_x = axis_compliance_.x(), s.axis_y = axis_compliance_.y();
  out.chip_max_mm = out.chip_area_mm2 = 0;
  const bool linear = material_.law == machine::ForceLaw::linear && edge_ramp_mm_ == 0;
  float thickest = 0;
  for (const removal::ChipBlock& chip : chips) {
    const EnvelopeBlocks::Block& block = blocks.block(chip.block);
    for (int half = 0; half < EnvelopeBlocks::kRings; ++half) {
      const float* h = chip.thickness_mm.data() + half * kSteps;
      const std::uint8_t* cut_255 = chip.cut_255.data() + half * kSteps;
      int cut_of_all = 0;
      for (int l = 0; l < kSteps; ++l) {
        cut_of_all += h[l] > 0 ? cut_255[l] : 0;
        thickest = std::max(thickest, h[l]);
      }
      if (cut_of_all == 0) continue;
      const int r = std::min(block.ring + half, last);
      const auto& ring = envelope_.rings[static_cast<std::size_t>(r)];
      EdgeForces e;
      if (linear) {
        linear_forces(material_, h, cut_255, ring.width_mm, e);
      } else {
        for (std::size_t l = 0; l < kSteps; ++l) {
          const EdgeForce f = edge_force(material_, h[l], cut_255[l] / 255.0 * ring.width_mm, edge_ramp_mm_);
          e.tangential[l] = f.tangential_N, e.radial[l] = f.radial_N, e.axial[l] = f.axial_N;
        }
      }
      out.chip_area_mm2 += cut_of_all / 255.0 * ring.width_mm * 2 * kPi * ring.profile.radius_mm / envelope_.steps;
      s.cosine_phi = blocks.cos_phi(chip.block) + half * kSteps;
      s.sine_phi = blocks.sin_phi(chip.block) + half * kSteps;
      s.sine = ring.sine, s.cosine = ring.cosine;
      s.radius_mm = ring.profile.radius_mm;
      s.compliance = compliance_.data() + static_cast<std::size_t>(r) * nodes;
      double* at = sums.data() + block.step;
      s.fx = at, s.fy = at + row, s.fz = at + 2 * row, s.torque = at + 3 * row, s.deflection = at + 4 * row;
      add_four(e, s);
    }
  }
  out.chip_max_mm = thickest;
  out.force_N.resize(steps);
  out.torque_Nmm.assign(sums.begin() + static_cast<std::ptrdiff_t>(3 * row),
                        sums.begin() + static_cast<std::ptrdiff_t>(3 * row + steps));
  out.work_Nmm = 0;
  for (std::size_t m = 0; m < steps; ++m) {
    out.force_N[m] = {sums[m], sums[row + m], sums[2 * row + m]};
    out.work_Nmm += out.torque_Nmm[m] * 2 * kPi / envelope_.steps;
  }
  out.feedback.clear();
  out.feedback_before.clear();
  out.deflection_mm.resize(nodes * steps * 2);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t m = 0; m < steps; ++m)
      for (std::size_t a = 0; a < 2; ++a)
        out.deflection_mm[2 * (n * steps + m) + a] = static_cast<float>(sums[(4 + 2 * n + a) * row + m]);
}

}  // namespace camber::deflection
