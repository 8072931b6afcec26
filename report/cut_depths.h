#pragma once
// How deep a program's tools cut in a blank: whether it can be roughing that blank, or only finishes what others left.
#include <string>

#include "machine/tool_proposal.h"

namespace camber::report {

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

}  // namespace camber::report
