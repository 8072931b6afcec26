#include "deflection/beam.h"

#include <algorithm>
#include <cmath>

namespace camber::deflection {

Beam::Beam(std::vector<Section> sections, double root)
    : sections_(std::move(sections)), root_compliance_mm_per_N_(root) {}

double Beam::compliance_mm_per_N(double a, double b) const {
  const double higher = std::max(a, b);
  double w = root_compliance_mm_per_N_;
  for (const auto& s : sections_) {
    const double lo = std::max(s.from_mm, higher), hi = s.to_mm;
    if (hi <= lo) continue;
    // Antiderivative of (z - a)(z - b), taken about the lower end for accuracy.
    const double p = lo - a, q = lo - b, l = hi - lo;
    w += (p * q * l + (p + q) * l * l / 2 + l * l * l / 3) / s.bending_stiffness_N_mm2;
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
    const bool fluted = !tool.flute_length_mm || z < *tool.flute_length_mm;
    const double shank = tool.shank_diameter_mm > 0 ? tool.shank_diameter_mm : tool.diameter_mm;
    const double d = fluted ? tool.diameter_mm * tool.effective_diameter_ratio : shank;
    const double y = compliance_mm_per_N(z, 0) / tip;
    modal_mass_kg += density * 1e-9 * kPi / 4 * d * d * dz * y * y;
  }
  return std::sqrt(1000.0 / tip / modal_mass_kg) / (2 * kPi);
}

Beam beam_of(const machine::Tool& tool) {
  const auto stiffness = [&](double d) { return tool.youngs_modulus_MPa * kPi / 64 * std::pow(d, 4); };
  const double flute = std::min(tool.flute_length_mm.value_or(tool.overhang_mm), tool.overhang_mm);
  std::vector<Beam::Section> sections{{0, flute, stiffness(tool.diameter_mm * tool.effective_diameter_ratio)}};
  const double shank = tool.shank_diameter_mm > 0 ? tool.shank_diameter_mm : tool.diameter_mm;
  if (flute < tool.overhang_mm) sections.push_back({flute, tool.overhang_mm, stiffness(shank)});
  return Beam(std::move(sections), 1 / tool.root_stiffness_N_per_mm);
}

}  // namespace camber::deflection
