#include "deflection/beam.h"

#include <algorithm>
#include <cmath>

#include "machine/cutter_parameters.h"

namespace camber::deflection {
namespace {

double flute_length(const machine::Tool& tool) {
  const double typical = tool.typical_flute_mm > 0 ? tool.typical_flute_mm : tool.overhang_mm;
  return std::min(tool.flute_length_mm.value_or(typical), tool.overhang_mm);
}

/// Returns the diameter that counts in bending at a height; for the fluted part the effective one.
double bending_diameter_mm(const machine::Tool& tool, double z) {
  const double flutes = flute_length(tool);
  if (z < flutes) {
    double d = tool.diameter_mm;
    const bool tapered = tool.type == machine::ToolType::tapered_ball || tool.type == machine::ToolType::general;
    // A tapered wall begins with its diameter at the tip; the rounded tip itself does not count.
    if (tapered) {
      const auto p = machine::parameters_of(tool);
      d = p.diameter_mm * (1 - std::tan(p.bottom_angle_rad) * std::tan(p.taper_rad)) + 2 * z * std::tan(p.taper_rad);
    }
    return d * tool.effective_diameter_ratio;
  }
  if (z < flutes + tool.neck_length_mm) return tool.neck_diameter_mm;
  return tool.shank_diameter_mm > 0 ? tool.shank_diameter_mm : tool.diameter_mm;
}

}  // namespace

Beam::Beam(std::vector<Section> sections, const Root& root) : sections_(std::move(sections)), root_(root) {}

double Beam::axial_compliance_mm_per_N(double z_force) const {
  double w = root_.axial_mm_per_N;
  for (const auto& s : sections_) w += std::max(0.0, s.to_mm - std::max(s.from_mm, z_force)) / s.axial_stiffness_N;
  return w;
}

double Beam::compliance_mm_per_N(double a, double b) const {
  const double higher = std::max(a, b);
  const double face = sections_.empty() ? 0 : sections_.back().to_mm;
  double w = root_.lateral_mm_per_N + root_.rotational_rad_per_Nmm * std::max(0.0, face - a) * std::max(0.0, face - b);
  for (const auto& s : sections_) {
    const double lo = std::max(s.from_mm, higher), hi = s.to_mm;
    if (hi <= lo) continue;
    // Antiderivative of (z - a)(z - b), taken about the lower end for accuracy.
    const double p = lo - a, q = lo - b, l = hi - lo;
    w += (p * q * l + (p + q) * l * l / 2 + l * l * l / 3) / s.bending_stiffness_N_mm2 + l / s.shear_stiffness_N;
  }
  return w;
}

double Beam::first_frequency_hz(const machine::Tool& tool, double density) const {
  // Rayleigh: omega^2 = F y(tip) / integral of (rho A y^2) for the shape y under a unit force at the tip.
  constexpr int kSlices = 200;
  const double length = sections_.back().to_mm, dz = length / kSlices;
  const double tip = compliance_mm_per_N(0, 0);
  double modal_mass_kg = 0;
  for (int i = 0; i < kSlices; ++i) {
    const double z = (i + 0.5) * dz;
    const double d = bending_diameter_mm(tool, z);
    const double y = compliance_mm_per_N(z, 0) / tip;
    modal_mass_kg += density * 1e-9 * kPi / 4 * d * d * dz * y * y;
  }
  return std::sqrt(1000.0 / tip / modal_mass_kg) / (2 * kPi);
}

Beam beam_of(const machine::Tool& tool) {
  constexpr double kPoisson = 0.3;
  constexpr int kTaperSlices = 50;
  std::vector<Beam::Section> sections;
  const auto add = [&](double from, double to) {
    if (to - from <= 1e-9) return;
    const double e = tool.youngs_modulus_MPa, d = bending_diameter_mm(tool, (from + to) / 2);
    Beam::Section s{from, to, e * kPi / 64 * std::pow(d, 4)};
    const double kappa = 6 * (1 + kPoisson) / (7 + 6 * kPoisson), shear_modulus = e / (2 * (1 + kPoisson));
    if (tool.shear) s.shear_stiffness_N = kappa * shear_modulus * kPi / 4 * d * d;
    if (!tool.axial_stiffness_N_per_mm) s.axial_stiffness_N = e * kPi / 4 * d * d;
    sections.push_back(s);
  };
  const double flutes = flute_length(tool), neck = std::min(flutes + tool.neck_length_mm, tool.overhang_mm);
  const int slices = tool.taper_rad > 0 ? kTaperSlices : 1;
  for (int i = 0; i < slices; ++i) add(flutes * i / slices, flutes * (i + 1) / slices);
  add(flutes, neck);
  add(neck, tool.overhang_mm);
  const double given = tool.axial_stiffness_N_per_mm ? 1 / *tool.axial_stiffness_N_per_mm : 0.0;
  return Beam(std::move(sections), {.lateral_mm_per_N = 1 / tool.root_stiffness_N_per_mm,
                                    .axial_mm_per_N = given + 1 / tool.root_axial_stiffness_N_per_mm,
                                    .rotational_rad_per_Nmm = 1 / tool.root_rotational_stiffness_Nmm_per_rad});
}

}  // namespace camber::deflection
