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

namespace {
/// Of the envelope, that one sample stands for.
double chip_area_mm2(const removal::EnvelopeGrid::Ring& ring, int steps) {
  return ring.width_mm * 2 * kPi * ring.profile.radius_mm / steps;
}
}  // namespace

void ToothPassModel::evaluate(std::span<const removal::Chip> chips, ToothPass& out) const {
  const auto steps = static_cast<std::size_t>(envelope_.steps_per_pitch);
  const std::size_t nodes = node_height_mm_.size();
  out.force_N.assign(steps, Vec3::Zero());
  out.torque_Nmm.assign(steps, 0.0);
  out.work_Nmm = out.chip_max_mm = out.chip_area_mm2 = 0;
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
    out.torque_Nmm[m] += e.tangential_N * ring.profile.radius_mm;
    out.work_Nmm += e.tangential_N * ring.profile.radius_mm * 2 * kPi / envelope_.steps;
    out.chip_max_mm = std::max(out.chip_max_mm, static_cast<double>(chip.thickness_mm));
    out.chip_area_mm2 += chip_area_mm2(ring, envelope_.steps);
    for (std::size_t n = 0; n < nodes; ++n) {
      const double w = compliance_[r * nodes + n];
      deflection[2 * (n * steps + m)] += w * force.x();
      deflection[2 * (n * steps + m) + 1] += w * force.y();
    }
    const EdgeForce k = edge_force_slope(material_, chip.thickness_mm, edge_ramp_mm_);
    const Vec3 slope = k.tangential_N * d.tangential + k.radial_N * d.normal + k.axial_N * d.meridian;
    const Eigen::Matrix2d feedback =
        -own_compliance_[r] * ring.width_mm * slope.head<2>() * d.normal.head<2>().transpose();
    out.feedback[m] += feedback;
    if (chip.after_tooth) out.feedback_before[m] += feedback;
  }
  std::transform(deflection.begin(), deflection.end(), out.deflection_mm.begin(),
                 [](double v) { return static_cast<float>(v); });
}

void ToothPassModel::add_to_turn(std::span<const removal::Chip> chips, std::size_t pass, TurnForces& turn) const {
  const auto steps = static_cast<std::size_t>(envelope_.steps);
  const std::size_t pitch = static_cast<std::size_t>(envelope_.steps_per_pitch), teeth = steps / pitch;
  if (turn.teeth.empty()) turn.teeth.assign(teeth, std::vector<TurnForces::Tooth>(steps));
  for (const removal::Chip& chip : chips) {
    const auto& ring = envelope_.rings[chip.point / steps];
    const std::size_t column = chip.point % steps;
    const Direction d = direction(chip.point, ring);
    const EdgeForce e = edge_force(material_, chip.thickness_mm, ring.width_mm, edge_ramp_mm_);
    // Turned clockwise by `at` steps, tooth t stands at column t * pitch - at.
    for (std::size_t t = 0; t < teeth; ++t) {
      const std::size_t at = (t * pitch + steps - column) % steps;
      if (at / pitch != pass) continue;
      TurnForces::Tooth& tooth = turn.teeth[t][at];
      tooth.force_N -= e.tangential_N * d.tangential + e.radial_N * d.normal + e.axial_N * d.meridian;
      tooth.torque_Nmm += e.tangential_N * ring.profile.radius_mm;
      tooth.chip_max_mm = std::max(tooth.chip_max_mm, static_cast<double>(chip.thickness_mm));
    }
  }
}

}  // namespace camber::deflection
