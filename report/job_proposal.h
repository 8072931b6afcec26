#pragma once
// The beginning of a job file, made from what an NC program and tool tables tell.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "machine/tool_proposal.h"
#include "machine/workpiece.h"
#include "nc/move.h"
#include "nc/program_text.h"
#include "nc/summary.h"

namespace camber::report {

// How deep a program's tools cut in a blank: whether it can be roughing that blank, or only finishes what others left.

/// Material that a cutter meets at one position.
struct MetMaterial {
  double depth_mm = 0;        ///< highest material above the cutter's lower end, which is round or a cone
  double above_tip_mm = 0;    ///< top of what it cuts, above the tip
  double width_fraction = 0;  ///< fraction of the way across the cutter that this step cuts
};

/// Sums over the way that tools cut, how much of it no tool can cut.
///
/// Impossible is: material over a ball end mill's widest place by more than half its diameter; other mills deeper
/// than 1.5 diameters over half their width, or deeper than their flutes (4 diameters where nobody gives their length)
/// at any width. Narrow deep cuts of end mills are high-speed roughing and walls, and are possible. Drills and
/// chamfering tools do not count, nor tools without a known diameter.
class CutDepths {
 public:
  void add(const machine::ToolProposal& tool, const MetMaterial& met, double step_mm);

  /// A third of the way or more is impossible.
  bool finishing_alone() const { return impossible_mm_ > kOfTheWay * cutting_mm_; }
  double impossible_fraction() const { return cutting_mm_ > 0 ? impossible_mm_ / cutting_mm_ : 0; }
  /// "a ball end mill of 6 mm would cut 14.2 mm deep": the deepest of the impossible cuts.
  std::string deepest() const;
  /// A twentieth of the smallest diameter of these tools, 0.2 to 0.5 mm.
  double usual_allowance_mm() const;

 private:
  static constexpr double kOfTheWay = 1.0 / 3;
  double cutting_mm_ = 0, impossible_mm_ = 0;
  double deepest_mm_ = 0, of_diameter_mm_ = 0, smallest_mm_ = 0;
  bool ball_ = false;
};

// A blank for a new job, from what its program cuts and where its rapids run.

using ToolsByNumber = std::map<int, machine::ToolProposal>;

struct StockProposal {
  machine::Box box;         ///< rounded to 0.1 mm
  std::string top;          ///< what its top face was chosen by
  bool trimmed = false;     ///< sides were taken back from rapids beside the part
  bool in_the_way = false;  ///< rapids run through it, and no smaller box of use is clear of them
  std::string told{};       ///< the comment that gives it, with its line; empty: none, and the box is a guess
  std::string
      finishes{};  ///< why the program only finishes what others have roughed (cut_depths.cpp); empty: it does not
  double allowance_mm = 0;  ///< that they will have left; 0 where `finishes` is empty
  std::string placed{};     ///< how a blank of which only the size is told was placed; empty: its place is told too
};

/// The box that the program describes (BLK FORM), or a comment (machine/program_comments.h), if it meets the cutting
/// moves. Else: a box around everything that the cutting moves sweep, 2 mm wider and 1 mm deeper.
///
/// Its top is Z0 where the program cuts below Z0 only, else 1 mm above the highest pass (feed moves as high as rapids
/// travel are taken for moves in air); lower where a rapid runs lower over material that nothing has cut by then.
/// Where a rapid, or a feed of a cutter of 24 mm or more, goes straight down beside the part, that side is taken back:
/// of all boxes within through which no rapid runs, the one of which the program removes most. Rapids are compared with
/// a height map of 240 by 240 cells at most; tools without a known diameter count as lines. Nothing where no move cuts.
std::optional<StockProposal> propose_stock(const nc::Program& text, const nc::Interpretation& moves,
                                           const ToolsByNumber& tools);

// Values for what no source says of a tool, so that a new job runs as it stands.

struct GuessedTool {
  machine::ToolProposal tool;  ///< type, diameter, flutes, overhang and what the type needs are there
  double helix_deg = 0;
  std::vector<std::string> assumed;  ///< keys that nobody gave
  bool overhang_from_source = false;
};

inline constexpr double kUsualDiameter_mm = 10;  ///< of a cutter where nothing says it

/// Fills what `known` leaves open. `cutter_mm`: see JobProposal::cutters_mm.
///
/// Type: drill where the program only drills with it, else flat. Diameter: of the next standard size above 4/3 of the
/// distance between parallel passes, the usual one where there are none. Overhang: for end mills and drills the overall
/// length of DIN 6527 L and DIN 6537 K less the shank that DIN 6535 has clamped; for face mills the height of ISO 6462;
/// at least 5 mm more than the flutes and than the depth of the cut below the blank's top, of which six diameters count
/// at most. Cutters of less than 6 mm have a shank of 6 mm and flutes as DIN 6527 L has them, longer where the cut is
/// deeper. depth_mm: of the tool's lowest cut below the blank's top.
GuessedTool guess_tool(machine::ToolProposal known, const nc::ToolUse& use, const nc::Interpretation& moves,
                       double depth_mm, std::optional<double> cutter_mm = {});

struct JobProposal {
  std::string program;  ///< as the job is to name it
  std::string machine;  ///< the same, or "preset:NAME"; empty: the preset of a class that can run the program
  const nc::Summary& summary;
  std::vector<machine::ToolProposal> tools;  ///< by number; those that the program does not cut with are left out
  const nc::Program& text;
  const nc::Interpretation& moves;
  std::string material{};      ///< a name that machine::find_material knows; empty: the commonest
  std::optional<bool> inch{};  ///< unit of a program that does not say it
  /// By tool: the diameters with which cycles were read that ask for them, of cutters that nothing tells.
  std::map<int, double> cutters_mm{};
};

/// job.toml text with comments; a job that runs as it stands. What a file says is a value with its source. What no file
/// says is a typical value, marked "typical" or CHECK and named in the `assumed` of its table, with which every result
/// begins (machine/assumptions.h): machine, material, what is open of the tools (tool_guess), the blank
/// (stock_proposal) where no comment gives it.
std::string job_text(const JobProposal& proposal);

}  // namespace camber::report
