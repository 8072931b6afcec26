#pragma once
// Compliance of the tool: a stepped cantilever on a lateral spring, and along its axis a stepped bar on an axial
// spring.
#include <limits>
#include <vector>

#include "machine/tool.h"

namespace camber::deflection {

/// Heights are measured from the tip; the holder face is at the end of the last section.
class Beam {
 public:
  struct Section {
    double from_mm = 0, to_mm = 0;
    double bending_stiffness_N_mm2 = 0;                                  ///< E I
    double shear_stiffness_N = std::numeric_limits<double>::infinity();  ///< kappa G A; infinite: no shear
    double axial_stiffness_N = std::numeric_limits<double>::infinity();  ///< E A
  };

  /// Compliances of the root, at the holder face.
  struct Root {
    double lateral_mm_per_N = 0, axial_mm_per_N = 0, rotational_rad_per_Nmm = 0;
  };

  Beam(std::vector<Section> sections, const Root& root);

  /// Deflection at height z_out under a unit lateral force at height z_force, mm/N:
  /// w = 1/k_root + (L - z_out)(L - z_force) / k_rotational + sum over the sections of the integral of
  /// (z - z_out)(z - z_force) / (E I) dz from the higher of the two heights to the holder face L, and of
  /// 1 / (kappa G A) dz where shear counts. Euler-Bernoulli, with shear Timoshenko (Castigliano; both parts exact);
  /// symmetric in its arguments (Maxwell). Heights beyond the holder face are treated as the face.
  double compliance_mm_per_N(double z_out_mm, double z_force_mm) const;

  /// Axial displacement of the tip under a unit axial force at height z_force, mm/N: 1/k_root + sum over the
  /// sections above of length / (E A).
  double axial_compliance_mm_per_N(double z_force_mm) const;

  /// First natural frequency of the beam alone, Hz (Rayleigh's quotient with the shape under a tip load), for the
  /// warning that a static deflection is no longer valid. `density_kg_per_m3`: density of the shank.
  double first_frequency_hz(const machine::Tool& tool, double density_kg_per_m3) const;

  /// From the tip up.
  const std::vector<Section>& sections() const { return sections_; }

 private:
  std::vector<Section> sections_;
  Root root_;
};

/// Builds the beam of a tool: the fluted part with its effective diameter (a tapered cutter in slices, each with the
/// diameter at its height), the neck, and the shank up to the overhang. Along the axis it is a bar of these diameters,
/// or the tool's axial stiffness where that is given. With tool.shear, kappa = 6 (1 + nu) / (7 + 6 nu) of a round bar,
/// nu = 0.3. Source of kappa: Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33 (1966)
/// 335-340.
Beam beam_of(const machine::Tool& tool);

}  // namespace camber::deflection
