#pragma once
// A cutter with its shank and holder, and the modes of its tip.
#include <optional>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "machine/number_range.h"

namespace camber::machine {

/// Receptance where it is excited and felt: direction direction^T / (k (1 - r^2 + 2 i zeta r)), r = f / frequency_hz.
/// Directions do not turn with the spindle.
struct Mode {
  Vec2 direction = Vec2::UnitX();  ///< unit vector
  double frequency_hz = 0;
  double damping_ratio = 0;       ///< zeta; 1 is critical damping
  double stiffness_N_per_mm = 0;  ///< modal, at the tip of a tool
};

enum class ToolType { ball, flat, bull, drill, tapered_ball, chamfer, general };

/// One segment of a holder: a cylinder or a cone about the axis.
struct HolderPart {
  double lower_diameter_mm = 0, upper_diameter_mm = 0, length_mm = 0;
};

struct Tool {
  int number = 0;
  ToolType type = ToolType::ball;
  double diameter_mm = 0;
  double corner_radius_mm = 0;                            ///< bull, general
  double tip_diameter_mm = 0;                             ///< chamfer: of the flat at the tip; 0: a point
  double point_angle_rad = 0;                             ///< chamfer, drill: between opposite sides of the cone
  double taper_rad = 0;                                   ///< tapered_ball, general: between the wall and the axis
  double bottom_angle_rad = 0;                            ///< general: the bottom rises by this towards the outside
  double corner_centre_r_mm = 0, corner_centre_z_mm = 0;  ///< general: centre of the corner's arc
  int flutes = 2;
  double helix_rad = 0;
  std::vector<double>
      pitch_rad;         ///< pitch angles from each tooth to the next, in the order in which they cut; empty: equal
  double runout_mm = 0;  ///< offset of the cutter axis from the spindle axis
  double runout_angle_rad = 0;            ///< from tooth 1 to the run-out, against the rotation
  double overhang_mm = 0;                 ///< holder face to tip
  std::optional<double> flute_length_mm;  ///< not given: the whole overhang is fluted
  double typical_flute_mm = 0;            ///< without flute_length_mm: of the part that bends as fluted; 0: all of it
  double neck_diameter_mm = 0;            ///< 0: no neck
  double neck_length_mm = 0;              ///< from the flutes up
  double shank_diameter_mm = 0;           ///< 0: as the cutter
  std::vector<HolderPart> holder;         ///< from the holder's face up
  bool shear = false;                     ///< include shear deflection (Timoshenko)
  double effective_diameter_ratio = 0.8;  ///< bending diameter of the fluted part / diameter
  double youngs_modulus_MPa = 600000;
  double root_stiffness_N_per_mm = kNoLimit;                ///< lateral, holder and spindle
  double root_axial_stiffness_N_per_mm = kNoLimit;          ///< along the axis, holder and spindle
  double root_rotational_stiffness_Nmm_per_rad = kNoLimit;  ///< about the axes across the tool, at the holder face
  std::optional<double> axial_stiffness_N_per_mm{};  ///< stiffness of the tool along its axis; empty: by its geometry
  std::vector<std::string> typical{};         ///< keys that nobody gave, with the typical values that stand for them
  std::optional<double> density_kg_per_m3{};  ///< not given: by the modulus (dynamics/tool_modes.h)
  std::vector<Mode> modes{};                  ///< measured at the tip; empty: those of its beam
};

}  // namespace camber::machine
