#pragma once
// Tool proposals for a draft job file, from comments, tool tables and tool libraries.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "machine/tool.h"

namespace camber::machine {

/// A cutter as a source describes it. Not given: the source does not say. Lengths are in mm, whatever the source's
/// unit.
struct ToolProposal {
  std::optional<int> number;  ///< in the T word; libraries may list cutters without one
  std::string what;           ///< the source's own words; in a library the cutter's name
  std::string from;           ///< where they stand, "p.nc:3", "tool.tbl:7"
  std::string kind;           ///< kind in a library, also where camber has no cutter for it (library_words.h)
  std::optional<ToolType> type;
  std::optional<double> diameter_mm, corner_radius_mm, flute_length_mm, shank_diameter_mm, overhang_mm;
  std::optional<int> flutes;
  std::optional<double> youngs_modulus_GPa;
  std::optional<double> point_angle_deg;  ///< chamfer, drill: between opposite sides of the cone
  std::string doubt;                      ///< what should be checked; empty: nothing
  std::optional<double> tip_diameter_mm;  ///< chamfer: of the flat at the tip
  std::optional<double> taper_deg;        ///< tapered ball: between the wall and the axis
  std::optional<double> neck_diameter_mm;
  std::optional<double> shoulder_length_mm;  ///< tip to the end of the neck
  std::optional<double> overall_length_mm;
  std::vector<HolderPart> holder{};  ///< from the holder's face up
};

/// Tools that a program's comments name, one a number, the first mention first; sizes are in the program's unit unless
/// the comment names another, and fractions are inches.
///
/// Comments with a number: "(T3 D=0.125 CR=0.0625 - ZMIN=-0.54 - BALL END MILL)" (Fusion, HSMWorks), "(T1| 3/4 FLAT
/// ENDMILL|H0)", "( 1/2 FLAT ENDMILL TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - .5 )" (Mastercam), "(T02 ID=002  DIA-0.5000
/// TOOL END MILL)" (SolidWorks CAM), "(@FC|TOOL|number=1|type=Endmill|diameter=6|...)" (FreeCAD), "(1 = End Mill {6
/// mm})" (Vectric), "( T1 : 6.0 )" (CamBam), and a comment beside T and M6. Comments without one, or whose number is
/// none of the program's, belong to the tool change that follows within eight lines, else to the tool that is in: "(
/// 1/2\" DIA. 2 FLUTE E.M. )", "(TOOL/MILL,6.35,0.00,19.05,0.00)" (CutViewer, Carbide Create), "(Compensated Tool Path.
/// Diameter: 3.18)" (FreeCAD), "(TOOL NAME : MILL_D10R1)" (NX). In a program without T words they describe tool 0.
///
/// Drills by their gauge ("#30 DRILL", "LET. B DRILL") have its diameter; taps and reamers stand as drills, with a
/// doubt; a bare size of 3 or more in a program in inches is taken as millimetres, with a doubt (a mill of 6 inches is
/// rarer than one of 6 mm).
std::vector<ToolProposal> tools_in_comments(const SourceText& program, bool inch);

/// LinuxCNC's tool table: "T1 P17 Z0.511 D0.125 ;remark" a line. D is in the machine's unit. Throws InputError
/// [tool-table] for a line that is none, [file-missing].
std::vector<ToolProposal> read_tool_table(const std::string& path, bool inch);

/// A Fusion tool library, as JSON or as .tools, a zip file with that JSON; each tool names its unit. Holders without a
/// cutter are listed with kind "holder". Throws InputError [tool-library], [file-missing].
std::vector<ToolProposal> read_fusion_library(const std::string& path);

/// Fusion's export as CSV: a row for each preset, tools told apart by "Tool Index (tool_index)". Columns are found by
/// the names in parentheses, which do not follow the language. Throws InputError [tool-library], [file-missing].
std::vector<ToolProposal> read_fusion_csv(const std::string& path);

/// A tool library of HSMWorks, Inventor CAM or older Fusion: .hsmlib, XML in UTF-16 or UTF-8, root tool-library or
/// tool-table; each tool names its unit (millimeters, inches). There is no published description of it; names and
/// meanings are those that independent readers of such files agree on: nc number (not the tool's id), body diameter,
/// corner-radius, flute-length, body-length (what sticks out of the holder), shaft-diameter, number-of-flutes, material
/// name; taper-angle from the axis, but between the sides for drills. Throws InputError [tool-library], [file-missing].
std::vector<ToolProposal> read_hsm_library(const std::string& path);

/// A tool bit of FreeCAD, .fctb: no number. Quantities are texts with a unit, "5.0000 mm", "1.063 \"", "6,0 mm". Throws
/// InputError [tool-library], [file-missing].
ToolProposal read_freecad_bit(const std::string& path);

/// A library of FreeCAD, .fctl: numbers and the bits that they name, in the library's folder, or in the folder Bit
/// beside it or beside the library itself. A bit that is missing is a warning [file-missing] at its line. Throws
/// InputError [tool-library], [file-missing].
std::vector<ToolProposal> read_freecad_library(const std::string& path, Diagnostics& diagnostics);

/// A tool database of Vectric, .vtdb (SQLite). Throws InputError [tool-library], [file-missing].
std::vector<ToolProposal> read_vectric_library(const std::string& path);

/// By the name's ending: .json, .tools, .csv (Fusion), .hsmlib, .fctl, .fctb, .vtdb, all others a tool table. Of a
/// folder all libraries in it and in its subfolders, by name; bits of FreeCAD that one of its libraries lists once.
/// Files with other endings are passed over there, and .json and .csv that are no tool library. Throws InputError
/// [tool-library], [tool-table], [file-missing].
std::vector<ToolProposal> read_tools(const std::string& path, bool inch, Diagnostics& diagnostics);

/// Adds the tools of a library to those that are known. A known tool is completed by one of the same number that does
/// not contradict it in type or diameter; where several cutters of the library bear the number, the first counts and
/// the tool says so in `doubt`. Tools without a number are left out.
void add_tools(std::vector<ToolProposal>& known, const std::vector<ToolProposal>& library);

/// Type, size, corner radius and flutes as far as the words tell, "1/2 BULL ENDMILL 0.125 RAD".
ToolProposal tool_of_words(std::string_view words, bool inch);

/// Lines of a [tool.N] table for what is above the cutting edges: flutes, neck, shank, holder. Flutes that reach into
/// the holder end at its face.
std::string body_toml(const ToolProposal& tool);

/// Fills what `tool` does not know from `other`.
void complete(ToolProposal& tool, const ToolProposal& other);

}  // namespace camber::machine
