#pragma once
// A blank for a new job, from what its program cuts and where its rapids run.
#include <map>
#include <optional>
#include <string>

#include "machine/tool_proposal.h"
#include "machine/workpiece.h"
#include "nc/move.h"
#include "nc/program.h"

namespace camber::report {

using ToolsByNumber = std::map<int, machine::ToolProposal>;

struct StockProposal {
  machine::Box box;         ///< rounded to 0.1 mm
  std::string top;          ///< what its top face was chosen by
  bool trimmed = false;     ///< sides were taken back from rapids beside the part
  bool in_the_way = false;  ///< rapids run through it, and no smaller box of use is clear of them
  std::string told{};       ///< the comment that gives it, with its line; empty: none, and the box is a guess
  std::string
      finishes{};  ///< why the program only finishes what others have roughed (cut_depths.h); empty: it does not
  double allowance_mm = 0;  ///< that they will have left; 0 where `finishes` is empty
  std::string placed{};     ///< how a blank of which only the size is told was placed; empty: its place is told too
};

/// The box that the program describes (BLK FORM), or a comment (machine/program_comments.h), if it meets the cutting
/// moves. Else: a box around everything that the cutting moves sweep, 2 mm wider and 1 mm deeper.
///
/// Its top is Z0 where the program cuts below Z0 only, else 1 mm above the highest pass (feed moves as high as rapids
/// travel are taken for moves in air); lower where a rapid runs lower over material that nothing has cut by then.
/// Where a rapid goes down beside the part, that side is taken back: of all boxes within through which no rapid runs,
/// the one of which the program removes most. Rapids are compared with a height map of 240 by 240 cells at most; tools
/// without a known diameter count as lines. Nothing where no move cuts.
std::optional<StockProposal> propose_stock(const nc::Program& text, const nc::Interpretation& moves,
                                           const ToolsByNumber& tools);

}  // namespace camber::report
