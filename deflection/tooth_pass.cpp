#include "deflection/tooth_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "deflection/edge_force.h"

namespace camber::deflection {

std::vector<double> node_heights(double top_mm, double fluted_length_mm) {
  const double apart = std::max(2.0, fluted_length_mm / 10);
  const int n = std::clamp(static_cast<int>(std::ceil(top_mm / apart)) + 1, 2, 12);
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(top_mm * i / (n - 1));
  return out;
}

namespace {

/// Returns the axial compliance of tool, holder and axis together. The bar alone stretches by hundredths of a
/// micrometre in finishing: it counts only where a spring stands behind it or its stiffness is given; otherwise the
/// tool is rigid.
double axial_compliance_mm_per_N(const Beam& beam, double axis) {
  const double springs = beam.axial_compliance_mm_per_N(std::numeric_limits<double>::infinity()) + axis;
  return springs > 0 ? beam.axial_compliance_mm_per_N(0) + axis : 0;
}

}  // namespace

ToothPassModel::ToothPassModel(const removal::EnvelopeGrid& envelope, const machine::Material& material,
                               const Beam& beam, std::vector<double> nodes, double edge_ramp_mm, Teeth teeth,
                               const Vec3& axis_compliance, const PartCompliance* part)
    : envelope_(envelope),
      material_(material),
      edge_ramp_mm_(edge_ramp_mm),
      axis_compliance_(axis_compliance.head<2>()),
      axial_compliance_mm_per_N_(deflection::axial_compliance_mm_per_N(beam, axis_compliance.z())),
      teeth_(std::move(teeth)),
      node_height_mm_(std::move(nodes)),
      part_(part) {
  for (int j = 0; j < teeth_.count(); ++j) tooth_step_.push_back(teeth_.offset_steps(j, envelope.steps));
  for (const auto& ring : envelope.rings) {
    const double z = ring.profile.height_mm;
    for (const double node : node_height_mm_) compliance_.push_back(beam.compliance_mm_per_N(node, z));
    if (part_) part_weight_.push_back(height_weight(*part_, z));
  }
}

EdgeDirections ToothPassModel::direction(std::uint32_t p, const removal::EnvelopeGrid::Ring& ring) const {
  return edge_directions(ring.sine, ring.cosine, envelope_.sin_phi[p], envelope_.cos_phi[p]);
}

namespace {
/// Area of the envelope that one sample stands for.
double chip_area_mm2(const removal::EnvelopeGrid::Ring& ring, int steps) {
  return ring.width_mm * 2 * kPi * ring.profile.radius_mm / steps;
}
}  // namespace

Vec3 ToothPassModel::place_mm(std::uint32_t point) const {
  return {static_cast<double>(envelope_.x[point]), static_cast<double>(envelope_.y[point]),
          static_cast<double>(envelope_.z[point])};
}

ToothPassModel::MotionChip ToothPassModel::motion_chip(const EdgeDirections& d, const removal::EnvelopeGrid::Ring& ring,
                                                       const Vec3& motion) const {
  const double around = motion.dot(d.tangential), up = motion.dot(d.meridian);
  const double bulge = 0.5 * (ring.profile.meridian_curvature_per_mm * up * up +
                              ring.profile.parallel_curvature_per_mm * around * around);
  return {motion.dot(d.normal) + bulge, bulge};
}

double ToothPassModel::deeper_mm(int j, bool own_surface, const removal::EnvelopeGrid::Ring& ring) const {
  const double least = own_surface ? teeth_.max_runout_mm(ring.lag_rad) : 0.0;
  return ring.sine * (teeth_.tooth_runout_mm(j, ring.lag_rad) - least);
}

double ToothPassModel::tooth_chip_mm(int j, const removal::ChipSample& chip, const EdgeDirections& d,
                                     const removal::EnvelopeGrid::Ring& ring,
                                     const removal::ToothMotion& of_tool) const {
  const MotionChip motion = motion_chip(d, ring, of_tool.at(place_mm(chip.point)));
  const double even = chip.after_tooth ? static_cast<double>(chip.thickness_mm) : motion.even_mm;
  const double h = teeth_.chip_mm(j, even, ring.sine, ring.lag_rad, motion.bulge_mm);
  return chip.after_tooth ? h : std::max(0.0, std::min(h, chip.thickness_mm + deeper_mm(j, chip.own_surface, ring)));
}

void ToothPassModel::add(const removal::ChipSample& chip, double thickness_mm, const EdgeDirections& d, std::uint32_t r,
                         std::size_t m, std::vector<double>& deflection, ToothPass& out) const {
  const auto steps = static_cast<std::size_t>(envelope_.steps_per_pitch);
  const std::size_t nodes = node_height_mm_.size();
  const auto& ring = envelope_.rings[r];
  const double width_mm = chip.width_fraction() * ring.width_mm;
  const EdgeForce e = edge_force(material_, thickness_mm, width_mm, edge_ramp_mm_);
  const auto [force, torque] = load_on_tool(e, d, ring.profile.radius_mm);
  out.force_N[m] += force;
  out.torque_Nmm[m] += torque;
  out.work_Nmm += torque * 2 * kPi / envelope_.steps;
  out.chip_max_mm = std::max(out.chip_max_mm, thickness_mm);
  out.chip_area_mm2 += chip.width_fraction() * chip_area_mm2(ring, envelope_.steps);
  for (std::size_t n = 0; n < nodes; ++n) {
    const double w = compliance_[r * nodes + n];
    deflection[2 * (n * steps + m)] += (w + axis_compliance_.x()) * force.x();
    deflection[2 * (n * steps + m) + 1] += (w + axis_compliance_.y()) * force.y();
  }
}

namespace {
const removal::ChipSample& chip_of(const removal::ChipSample& chip) { return chip; }
const removal::ChipSample& chip_of(const removal::DeflectedChipSample& bent) { return bent.chip; }
}  // namespace

template <class Chips, class Function>
void ToothPassModel::for_each_element(const Chips& chips, std::size_t passing, const removal::ToothMotion& motion,
                                      Function f) const {
  const int turn = envelope_.steps, pitch = envelope_.steps_per_pitch;
  const int gone = static_cast<int>(passing % static_cast<std::size_t>(teeth_.count())) * pitch;
  for (std::size_t i = 0; i < chips.size(); ++i) {
    const removal::ChipSample& chip = chip_of(chips[i]);
    const int at = static_cast<int>(chip.point % static_cast<std::uint32_t>(turn));
    if (teeth_.even()) {
      f(i, at % pitch, static_cast<double>(chip.thickness_mm));
      continue;
    }
    const auto& ring = envelope_.rings[chip.point / static_cast<std::uint32_t>(turn)];
    const EdgeDirections d = direction(chip.point, ring);
    // For every tooth that passes the point during this tooth passing:
    for (int j = 0; j < teeth_.count(); ++j) {
      const int m = ((at - tooth_step_[static_cast<std::size_t>(j)] + gone) % turn + turn) % turn;
      if (m < pitch) f(i, m, tooth_chip_mm(j, chip, d, ring, motion));
    }
  }
}

void ToothPassModel::edge_elements(std::span<const removal::DeflectedChipSample> chips, std::size_t passing,
                                   const removal::ToothMotion& motion, std::vector<EdgeElement>& out) const {
  out.clear();
  for_each_element(chips, passing, motion, [&](std::size_t i, int m, double h) {
    out.push_back({static_cast<std::uint32_t>(i), m, h});
  });
}

void ToothPassModel::evaluate(std::span<const removal::ChipSample> chips, std::size_t passing,
                              const removal::ToothMotion& motion, ToothPass& out) const {
  const auto steps = static_cast<std::size_t>(envelope_.steps_per_pitch);
  const std::size_t nodes = node_height_mm_.size();
  out.force_N.assign(steps, Vec3::Zero());
  out.torque_Nmm.assign(steps, 0.0);
  out.work_Nmm = out.chip_max_mm = out.chip_area_mm2 = 0;
  out.deflection_mm.assign(nodes * steps * 2, 0.0f);
  std::vector<double> deflection(nodes * steps * 2, 0.0);
  for_each_element(chips, passing, motion, [&](std::size_t i, int m, double h) {
    if (h <= 0) return;
    const std::uint32_t r = chips[i].point / static_cast<std::uint32_t>(envelope_.steps);
    add(chips[i], h, direction(chips[i].point, envelope_.rings[r]), r, static_cast<std::size_t>(m), deflection, out);
  });
  std::transform(deflection.begin(), deflection.end(), out.deflection_mm.begin(),
                 [](double v) { return static_cast<float>(v); });
  if (!axial()) return;
  for (std::size_t m = 0; m < steps; ++m)
    for (const std::size_t at : {m, m + 1 < steps ? m + 1 : 0})
      out.deflection_mm.push_back(static_cast<float>(axial_compliance_mm_per_N_ * out.force_N[at].z()));
}

void ToothPassModel::add_to_turn(std::span<const removal::ChipSample> chips, std::size_t pass, std::size_t passing,
                                 const removal::ToothMotion& motion, TurnForces& turn) const {
  const int steps = envelope_.steps, pitch = envelope_.steps_per_pitch, teeth = teeth_.count();
  const int gone = static_cast<int>(passing % static_cast<std::size_t>(teeth)) * pitch;
  if (turn.teeth.empty())
    turn.teeth.assign(static_cast<std::size_t>(teeth), std::vector<TurnForces::Tooth>(static_cast<std::size_t>(steps)));
  for (const removal::ChipSample& chip : chips) {
    const auto& ring = envelope_.rings[chip.point / static_cast<std::uint32_t>(steps)];
    const int column = static_cast<int>(chip.point % static_cast<std::uint32_t>(steps));
    const EdgeDirections d = direction(chip.point, ring);
    for (int j = 0; j < teeth; ++j) {
      // The tool turns clockwise by `at` steps, so that rotation steps are passed backwards. With uniform teeth tooth 0
      // starts at column 0, the others by their number.
      int at = ((j * pitch - column) % steps + steps) % steps;
      double h = chip.thickness_mm;
      if (teeth_.even()) {
        if (at / pitch != static_cast<int>(pass)) continue;
      } else {
        const int m = ((column - tooth_step_[static_cast<std::size_t>(j)] + gone) % steps + steps) % steps;
        if (m >= pitch) continue;
        at = static_cast<int>(pass) * pitch + pitch - 1 - m;
        h = tooth_chip_mm(j, chip, d, ring, motion);
      }
      TurnForces::Tooth& tooth = turn.teeth[static_cast<std::size_t>(j)][static_cast<std::size_t>(at)];
      const EdgeForce e = edge_force(material_, h, chip.width_fraction() * ring.width_mm, edge_ramp_mm_);
      tooth += load_on_tool(e, d, ring.profile.radius_mm);
      tooth.chip_max_mm = std::max(tooth.chip_max_mm, h);
    }
  }
}

}  // namespace camber::deflection
