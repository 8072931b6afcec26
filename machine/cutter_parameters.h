#pragma once
// The seven parameters of a general milling cutter, and where its corner begins and ends.
#include <string>

#include "base/geometry.h"
#include "machine/tool.h"

namespace camber::machine {

/// Profile of line, arc, line in the meridian plane (r from the axis, z above the tip):
///   bottom   z = r tan(alpha), from the tip;
///   corner   the arc of radius R about (Rr, Rz);
///   wall     r = u + z tan(beta), u = D/2 (1 - tan(alpha) tan(beta)), up to z = H; above it an upright cylinder.
/// D/2 is the radius at which bottom and wall would meet without the corner.
/// Source: Engin & Altintas, Mechanics and dynamics of general milling cutters I, Int. J. Mach. Tools Manuf. 41 (2001)
/// 2195-2212, fig. 1 and eqs. 1-4. The cylinder above H is ours.
struct CutterParameters {
  double diameter_mm = 0;                                 ///< D
  double corner_radius_mm = 0;                            ///< R; 0: bottom and wall meet in an edge
  double corner_centre_r_mm = 0, corner_centre_z_mm = 0;  ///< Rr, Rz
  double bottom_angle_rad = 0;                            ///< alpha, from the plane across the axis, 0 ... < pi/2
  double taper_rad = 0;                                   ///< beta, from the axis, 0 ... < pi/2
  double height_mm = 0;                                   ///< H; only matters where the wall has a taper
};

/// The seven parameters of a tool: of its type, diameter and angles. Where the flutes' length is not given, H of a
/// tapered wall is the overhang; H of a chamfer cutter and a drill is where the cone reaches the diameter.
CutterParameters parameters_of(const Tool& tool);

/// Ends of the corner's arc: on the bottom (M) and on the wall (N), as (r, z); one point where there is no arc.
struct CornerEnds {
  Vec2 bottom = Vec2::Zero(), wall = Vec2::Zero();
  double bottom_normal_rad = 0, wall_normal_rad = 0;  ///< angles of the arc's outward normal from -z towards +r
};

/// Returns a sentence on what is wrong with a profile; empty if it is valid: bottom, corner and wall meet and every
/// angle on the way up is steeper than the one before (no undercut, no inward corner).
std::string profile_fault(const CutterParameters& parameters);

/// Requires a sound profile.
CornerEnds corner_ends(const CutterParameters& parameters);

}  // namespace camber::machine
