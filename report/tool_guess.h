#pragma once
// Values for what no source says of a tool, so that a new job runs as it stands.
#include <string>
#include <vector>

#include "machine/tool_proposal.h"
#include "nc/move.h"
#include "nc/summary.h"

namespace camber::report {

struct GuessedTool {
  machine::ToolProposal tool;  ///< type, diameter, flutes, overhang and what the type needs are there
  double helix_deg = 0;
  std::vector<std::string> assumed;  ///< keys that nobody gave
  bool overhang_from_source = false;
};

/// Fills what `known` leaves open.
///
/// Type: drill where the program only drills with it, else flat. Diameter: of the next standard size above 4/3 of the
/// distance between parallel passes, 10 mm where there are none. Overhang: for end mills and drills the overall length
/// of DIN 6527 L and DIN 6537 K less the shank that DIN 6535 has clamped; for face mills the height of ISO 6462; at
/// least 5 mm more than the flutes and than the depth of the cut below the blank's top, of which six diameters count at
/// most. Cutters of less than 6 mm have a shank of 6 mm and flutes as DIN 6527 L has them, longer where the cut is
/// deeper. depth_mm: of the tool's lowest cut below the blank's top.
GuessedTool guess_tool(machine::ToolProposal known, const nc::ToolUse& use, const nc::Interpretation& moves,
                       double depth_mm);

}  // namespace camber::report
