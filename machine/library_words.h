#pragma once
// What tool libraries share: kinds of cutters, and their meaning for camber.
#include <optional>
#include <string_view>

#include "machine/tool_proposal.h"

namespace camber::machine {

/// The kind of a cutter by the type that Fusion and HSMWorks give it, "flat" for "flat end mill" and "face mill"; the
/// library's own word where it has no other name here.
std::string kind_of_fusion(std::string_view type);

/// Sets `type` by `kind`, with a doubt where camber's cutter is only like it or there is none: "flat", "ball", "bull",
/// "tapered ball", "drill"; "chamfer", "vbit" and "engraving" are chamfer tools; "tap" and "reamer" stand as drills.
void set_type_by_kind(ToolProposal& tool);

/// Sizes of a cutter in Fusion's JSON, its CSV and HSMWorks' XML, in mm and degrees. Zero or less: the size does not
/// apply.
struct FusionSizes {
  double diameter = 0, corner_radius = 0, flute_length = 0, body_length = 0, overall_length = 0, shank_diameter = 0;
  double shoulder_diameter = 0, shoulder_length = 0, tip_diameter = 0, flutes = 0;
  double taper_deg = 0;  ///< between the cone or wall and the axis
  double point_deg = 0;  ///< point angle of a drill, between the sides
};

/// Kind, type and sizes of a cutter from a library of these.
void set_fusion_cutter(ToolProposal& tool, std::string_view type, const FusionSizes& sizes);

/// Whether the kind has a cone at its tip whose angle a library gives.
bool is_conical(std::string_view kind);

/// A chamfer tool whose cone, from the flat at the tip up the cutting edge, does not reach its diameter.
void check_cone(ToolProposal& tool);

/// Modulus of elasticity of "carbide" and "hss", whatever their case; nothing for others.
std::optional<double> modulus_of_library_GPa(std::string_view word);

}  // namespace camber::machine
