#include "dynamics/tool_modes.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "deflection/beam.h"

namespace camber::dynamics {
namespace {

/// A short piece of one diameter. Units of the element: N, mm, t (tonne), s.
struct BeamElement {
  double length_mm, bending_N_mm2, shear_N, mass_t_per_mm, rotary_t_mm;
};

BeamElement element_of(const BeamSection& s, double length, double diameter) {
  const double area = kPi / 4 * diameter * diameter, inertia = kPi / 64 * std::pow(diameter, 4);
  const double density = s.density_kg_per_m3 * 1e-12;  // t/mm3
  const double kappa = 6 * (1 + s.poisson) / (7 + 6 * s.poisson);
  const double shear_modulus = s.youngs_modulus_MPa / (2 * (1 + s.poisson));
  return {length, s.youngs_modulus_MPa * inertia, kappa * shear_modulus * area, density * area, density * inertia};
}

std::vector<BeamElement> elements_of(const std::vector<BeamSection>& sections) {
  double length = 0;
  for (const BeamSection& s : sections) length += s.length_mm;
  std::vector<BeamElement> elements;
  for (const BeamSection& s : sections) {
    const int n = std::max(1, static_cast<int>(std::ceil(kBeamElements * s.length_mm / length)));
    for (int i = 0; i < n; ++i) {
      const double t = (i + 0.5) / n;
      elements.push_back(
          element_of(s, s.length_mm / n, s.lower_diameter_mm + t * (s.upper_diameter_mm - s.lower_diameter_mm)));
    }
  }
  return elements;
}

Eigen::Matrix4d mirrored(Eigen::Matrix4d m) {
  m.triangularView<Eigen::StrictlyLower>() = m.transpose();
  return m;
}

/// Stiffness by the displacements (w, slope) of the lower and the upper end.
Eigen::Matrix4d element_stiffness(const BeamElement& e) {
  const double l = e.length_mm, p = 12 * e.bending_N_mm2 / (e.shear_N * l * l);
  Eigen::Matrix4d k;
  k << 12, 6 * l, -12, 6 * l,                       //
      0, (4 + p) * l * l, -6 * l, (2 - p) * l * l,  //
      0, 0, 12, -6 * l,                             //
      0, 0, 0, (4 + p) * l * l;
  return mirrored(k) * e.bending_N_mm2 / ((1 + p) * l * l * l);
}

Eigen::Matrix4d element_mass(const BeamElement& e) {
  const double l = e.length_mm, p = 12 * e.bending_N_mm2 / (e.shear_N * l * l), p2 = p * p;
  const double a = 70 * p2 + 147 * p + 78, b = (35 * p2 + 77 * p + 44) * l / 4, c = 35 * p2 + 63 * p + 27,
               d = (35 * p2 + 63 * p + 26) * l / 4, f = (7 * p2 + 14 * p + 8) * l * l / 4,
               g = (7 * p2 + 14 * p + 6) * l * l / 4;
  Eigen::Matrix4d across, rotary;
  across << a, b, c, -d,  //
      0, f, d, -g,        //
      0, 0, a, -b,        //
      0, 0, 0, f;
  const double h = (15 * p - 3) * l, i = (10 * p2 + 5 * p + 4) * l * l, j = (5 * p2 - 5 * p - 1) * l * l;
  rotary << 36, -h, -36, -h,  //
      0, i, h, j,             //
      0, 0, 36, h,            //
      0, 0, 0, i;
  const double q = (1 + p) * (1 + p);
  return mirrored(across) * e.mass_t_per_mm * l / (210 * q) + mirrored(rotary) * e.rotary_t_mm / (30 * q * l);
}

struct BeamMatrices {
  Eigen::MatrixXd stiffness, mass;
};

/// Nodes from the tip to the root, (w, slope) each; a root displacement that does not yield is left out.
BeamMatrices assemble(const std::vector<BeamElement>& elements, const BeamRoot& root) {
  const Eigen::Index n = 2 * (static_cast<Eigen::Index>(elements.size()) + 1);
  BeamMatrices m{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  for (Eigen::Index i = 0; i + 2 < n; i += 2) {
    const BeamElement& e = elements[static_cast<std::size_t>(i / 2)];
    m.stiffness.block<4, 4>(i, i) += element_stiffness(e);
    m.mass.block<4, 4>(i, i) += element_mass(e);
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n - 2; ++i) kept.push_back(i);
  const auto hold = [&](Eigen::Index i, double spring) {
    if (!std::isfinite(spring)) return;
    m.stiffness(i, i) += spring;
    kept.push_back(i);
  };
  hold(n - 2, root.stiffness_N_per_mm);
  hold(n - 1, root.tilt_stiffness_Nmm_per_rad);
  return {m.stiffness(kept, kept), m.mass(kept, kept)};
}

/// The shape at the nodes, 1 at the tip.
BeamMode mode_of(double squared_frequency, const Eigen::VectorXd& vector, const std::vector<BeamElement>& elements,
                 bool root_moves) {
  BeamMode mode;
  mode.frequency_hz = std::sqrt(squared_frequency) / (2 * kPi);
  mode.tip_stiffness_N_per_mm = squared_frequency / (vector(0) * vector(0));
  double z = 0;
  for (std::size_t i = 0; i <= elements.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    mode.height_mm.push_back(z);
    mode.shape.push_back(i < elements.size() || root_moves ? vector(row) / vector(0) : 0.0);
    if (i < elements.size()) z += elements[i].length_mm;
  }
  return mode;
}

}  // namespace

double BeamMode::stiffness_N_per_mm(double height) const {
  const auto above = std::ranges::upper_bound(height_mm, height);
  if (above == height_mm.begin()) return tip_stiffness_N_per_mm;
  const auto i = std::min(static_cast<std::size_t>(above - height_mm.begin()), height_mm.size() - 1);
  const double t = (std::min(height, height_mm[i]) - height_mm[i - 1]) / (height_mm[i] - height_mm[i - 1]);
  const double s = shape[i - 1] + t * (shape[i] - shape[i - 1]);
  return tip_stiffness_N_per_mm / (s * s);
}

std::vector<BeamMode> beam_modes(const std::vector<BeamSection>& sections, const BeamRoot& root, int count) {
  const auto elements = elements_of(sections);
  const BeamMatrices m = assemble(elements, root);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(m.stiffness, m.mass);
  std::vector<BeamMode> modes;
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(count, m.mass.rows()); ++i)
    modes.push_back(mode_of(solver.eigenvalues()(i), solver.eigenvectors().col(i), elements,
                            std::isfinite(root.stiffness_N_per_mm)));
  return modes;
}

double usual_density_kg_per_m3(double youngs_modulus_MPa) { return youngs_modulus_MPa > 400e3 ? 14500 : 7850; }
double usual_poisson(double youngs_modulus_MPa) { return youngs_modulus_MPa > 400e3 ? 0.22 : 0.3; }

std::vector<BeamSection> beam_of_tool(const machine::Tool& tool, double density_kg_per_m3) {
  const double e = tool.youngs_modulus_MPa;
  std::vector<BeamSection> sections;
  const deflection::Beam bending = deflection::beam_of(tool);
  for (const auto& s : bending.sections()) {
    const double d = std::pow(s.bending_stiffness_N_mm2 * 64 / (kPi * e), 0.25);
    sections.push_back({s.to_mm - s.from_mm, d, d, e, density_kg_per_m3, usual_poisson(e)});
  }
  constexpr double kSteel_MPa = 210e3;
  for (const auto& p : tool.holder)
    sections.push_back({p.length_mm, p.lower_diameter_mm, p.upper_diameter_mm, kSteel_MPa,
                        usual_density_kg_per_m3(kSteel_MPa), usual_poisson(kSteel_MPa)});
  return sections;
}

std::vector<BeamMode> beam_modes_of(const machine::Tool& tool, int count) {
  const double density = tool.density_kg_per_m3.value_or(usual_density_kg_per_m3(tool.youngs_modulus_MPa));
  return beam_modes(beam_of_tool(tool, density),
                    {.stiffness_N_per_mm = tool.root_stiffness_N_per_mm,
                     .tilt_stiffness_Nmm_per_rad = tool.root_rotational_stiffness_Nmm_per_rad},
                    count);
}

std::vector<Mode> modes_of(const machine::Tool& tool) {
  if (!tool.modes.empty()) return tool.modes;
  const auto beam = beam_modes_of(tool);
  double softest = beam.front().tip_stiffness_N_per_mm;
  for (const BeamMode& m : beam) softest = std::min(softest, m.tip_stiffness_N_per_mm);
  std::vector<Mode> modes;
  for (const BeamMode& m : beam) {
    if (m.tip_stiffness_N_per_mm * kModeCounts > softest) continue;
    for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1)})
      modes.push_back({direction, m.frequency_hz, kUsualDamping, m.tip_stiffness_N_per_mm});
  }
  return modes;
}

Cut teeth_of(const machine::Tool& tool) {
  Cut cut;
  cut.pitch_rad = tool.pitch_rad.empty() ? equal_pitches(tool.flutes) : tool.pitch_rad;
  cut.radius_mm = tool.diameter_mm / 2;
  cut.lag_rad_per_mm = std::tan(tool.helix_rad) / cut.radius_mm;
  return cut;
}

}  // namespace camber::dynamics
