#include "deflection/tooth_pass.h"

#include <algorithm>
#include <cmath>

#include "deflection/edge_force.h"

namespace camber::deflection {

std::vector<double> node_heights(double top_mm) {
  const int n = std::clamp(static_cast<int>(std::ceil(top_mm / 2.0)) + 1, 2, 12);
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(top_mm * i / (n - 1));
  return out;
}

ToothPassModel::ToothPassModel(const removal::EnvelopeGrid& envelope, const machine::Material& material,
                               const Beam& beam, std::vector<double> nodes, double edge_ramp_mm)
    : envelope_(envelope), material_(material), edge_ramp_mm_(edge_ramp_mm), node_height_mm_(std::move(nodes)) {
  for (const auto& ring : envelope.rings) {
    const double z = ring.profile.height_mm;
    own_compliance_.push_back(beam.compliance_mm_per_N(z, z));
    for (const double node : node_height_mm_) compliance_.push_back(beam.compliance_mm_per_N(node, z));
  }
}

ToothPassModel::Direction ToothPassModel::direction(std::uint32_t p, const removal::EnvelopeGrid::Ring& ring) const {
  const double s = envelope_.sin_phi[p], c = envelope_.cos_phi[p];
  const double sk = ring.sine, ck = ring.cosine;
  // Clockwise seen from above (M3).
  return {{s, -c, 0}, {sk * c, sk * s, -ck}, {ck * c, ck * s, sk}};
}

void ToothPassModel::evaluate(std::span<const removal::Chip> chips, ToothPass& out) const {
  const auto steps = static_cast<std::size_t>(envelope_.steps_per_pitch);
  const std::size_t nodes = node_height_mm_.size();
  out.force_N.assign(steps, Vec3::Zero());
  out.feedback.assign(steps, Eigen::Matrix2d::Zero());
  out.feedback_before.assign(steps, Eigen::Matrix2d::Zero());
  out.deflection_mm.assign(nodes * steps * 2, 0.0f);
  std::vector<double> deflection(nodes * steps * 2, 0.0);
  for (const removal::Chip& chip : chips) {
    const std::uint32_t r = chip.point / static_cast<std::uint32_t>(envelope_.steps);
    const std::size_t m = chip.point % static_cast<std::uint32_t>(envelope_.steps) % steps;
    const auto& ring = envelope_.rings[r];
    const Direction d = direction(chip.point, ring);
    const EdgeForce e = edge_force(material_, chip.thickness_mm, ring.width_mm, edge_ramp_mm_);
    const Vec3 force = -(e.tangential_N * d.tangential + e.radial_N * d.normal + e.axial_N * d.meridian);
    out.force_N[m] += force;
    for (std::size_t n = 0; n < nodes; ++n) {
      const double w = compliance_[r * nodes + n];
      deflection[2 * (n * steps + m)] += w * force.x();
      deflection[2 * (n * steps + m) + 1] += w * force.y();
    }
    Vec3 slope = material_.ktc_MPa * d.tangential + material_.krc_MPa * d.normal + material_.kac_MPa * d.meridian;
    if (chip.thickness_mm < edge_ramp_mm_)
      slope += (material_.kte_N_per_mm * d.tangential + material_.kre_N_per_mm * d.normal +
                material_.kae_N_per_mm * d.meridian) /
               edge_ramp_mm_;
    const Eigen::Matrix2d feedback =
        -own_compliance_[r] * ring.width_mm * slope.head<2>() * d.normal.head<2>().transpose();
    out.feedback[m] += feedback;
    if (chip.after_tooth) out.feedback_before[m] += feedback;
  }
  std::transform(deflection.begin(), deflection.end(), out.deflection_mm.begin(),
                 [](double v) { return static_cast<float>(v); });
}

}  // namespace camber::deflection
