#pragma once
// The modes of a job's tools, those of a stepped beam on springs, and the teeth.
#include <limits>
#include <vector>

#include "dynamics/vibrating_cut.h"
#include "machine/tool.h"

namespace camber::dynamics {

/// A piece of the beam, round, a cylinder or a cone. From the tip towards the root.
struct BeamSection {
  double length_mm = 0;
  double lower_diameter_mm = 0, upper_diameter_mm = 0;
  double youngs_modulus_MPa = 0, density_kg_per_m3 = 0, poisson = 0.3;
};

/// Support of the end of the last section. Infinite: it does not yield.
struct BeamRoot {
  double stiffness_N_per_mm = std::numeric_limits<double>::infinity();
  double tilt_stiffness_Nmm_per_rad = std::numeric_limits<double>::infinity();
};

struct BeamMode {
  double frequency_hz = 0;
  double tip_stiffness_N_per_mm = 0;  ///< modal: omega^2 / (mass-normalised shape at the tip)^2
  std::vector<double> height_mm;      ///< from the tip, ascending
  std::vector<double> shape;          ///< lateral displacement at these heights; 1 at the tip

  /// Modal stiffness of a force and a displacement at a height, N/mm: the tip's over the square of the shape there.
  /// Infinite at a node.
  double stiffness_N_per_mm(double height) const;
};

/// The lowest `count` modes in bending, ascending by frequency.
///
/// Timoshenko beam with rotary inertia: two-node elements with the exact static stiffness and the consistent mass of
/// Friedman and Kosmatka, An improved two-node Timoshenko beam finite element, Computers & Structures 47 (1993)
/// 473-481; shear coefficient of round bars 6 (1 + nu) / (7 + 6 nu) (Cowper 1966). About kBeamElements elements of
/// equal length, at least one a section; cones are steps of these. f1 to f3 are right to 0.1 %.
std::vector<BeamMode> beam_modes(const std::vector<BeamSection>& sections, const BeamRoot& root, int count);
inline constexpr int kBeamElements = 64;

/// Sections of the tool as deflection::beam_of bends it. The fluted part weighs as much as a bar of the effective
/// diameter. The holder, where the job describes one, is a steel bar of its outline above the tool.
std::vector<BeamSection> beam_of_tool(const machine::Tool& tool, double density_kg_per_m3);

/// Density and Poisson's ratio by the modulus: above 400 GPa carbide, 14500 and 0.22; else steel, 7850 and 0.3.
double usual_density_kg_per_m3(double youngs_modulus_MPa);
double usual_poisson(double youngs_modulus_MPa);

/// Damping of a tool in holder and spindle where none is measured; usual values are 0.01 to 0.05.
constexpr double kUsualDamping = 0.03;
constexpr int kBeamModes = 3;         ///< number of the beam's lowest modes that are examined
constexpr double kModeCounts = 0.05;  ///< those count that are this part as flexible as the most flexible one

/// Modes at the tip: those that are given, or those of its beam that count, with the usual damping, alike in x and y.
std::vector<Mode> modes_of(const machine::Tool& tool);
/// Modes of the tool's beam, whether or not the job gives measured modes.
std::vector<BeamMode> beam_modes_of(const machine::Tool& tool, int count = kBeamModes);

/// Pitches, lag and radius of a tool; no slices.
Cut teeth_of(const machine::Tool& tool);

}  // namespace camber::dynamics
