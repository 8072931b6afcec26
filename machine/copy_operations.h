#pragma once
// The operations of copy milling, [[copy]] of a job: paths that are made from the part itself.
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"

namespace camber::machine {

enum class CopyMode {
  scanning_line,  ///< rows
  contour_line,   ///< loops beside the part's walls, level by level
  drilling
};

/// Which side of the cutter the material is on (M3, right-hand cutter).
enum class MillingSense {
  climb,         ///< down milling
  conventional,  ///< up milling
  both           ///< rows to and fro; loops that end at the region's border too, but along walls climb milling
};

enum class HoleCycle {
  centre,  ///< once to the depth
  peck,    ///< in steps of the axial depth, with a full retract
  ream     ///< in and out at the feed
};

/// Method for a pass that would have the cutter's full width in the cut.
enum class Slotting {
  by_load,     ///< trochoids where a full cut at the lowest feed and depth would be over CopyOperation::force_N
  full_width,  ///< a full cut
  trochoidal   ///< trochoids, whose engagement is that of the radial depth
};

/// Where the tool's axis may be while it cuts. Not given: over the stock.
struct CopyRegion {
  using Box = std::array<Vec3, 2>;              ///< lower and upper corner
  std::optional<std::array<Vec2, 2>> box_mm{};  ///< lower and upper corner
  std::vector<Vec2> polygon_mm{};               ///< empty: not given
  std::vector<Box> boxes_mm{};                  ///< several, each with the levels of the tip there; empty: not given
  std::optional<std::array<double, 2>> z_mm{};  ///< lowest and highest level of the tip, with scallop_mm of
                                                ///< the surface; of all boxes
};

struct CopyOperation {
  int tool = 0;
  CopyMode mode = CopyMode::contour_line;
  double spindle_rpm = 0;
  double feed_mm_per_s = 0;
  double radial_depth_mm = 0;  ///< between loops or rows; not used by drilling and by finishing with a scallop
  double axial_depth_mm = 0;   ///< between levels; drilling: of a peck; not used by finishing with a scallop
  double allowance_mm = 0;     ///< left on the part, along its normal
  double scallop_mm = 0;       ///< > 0: finishing rows on the part's surface with scallops of this height
  double angle_rad = 0;        ///< direction of rows, from +X
  MillingSense sense = MillingSense::climb;
  double ramp_rad = 3 * kPi / 180;  ///< steepest way into material
  bool plunge = false;              ///< the cutter may go straight down into material
  Slotting slotting = Slotting::by_load;
  std::optional<double> force_N{};  ///< load that feed and depths follow; not given: they stay as they are
  CopyRegion region;
  HoleCycle cycle = HoleCycle::peck;
  std::vector<Vec2> holes_mm{};  ///< drilling: places; empty: the middle of the region's box
  Diagnostic place{};            ///< an error without a message where the table stands
};

/// The [[copy]] tables of a job, whose other tables are in `job`; the rest of the file is not looked at. Throws
/// InputError where the file cannot be read; other problems go to `diagnostics`.
std::vector<CopyOperation> read_copy_operations(const std::string& path, const Job& job, Diagnostics& diagnostics);

/// The operation as a [[copy]] table that read_copy_operations() reads back.
std::string to_toml(const CopyOperation& operation);

/// The mode's word in files: scanning-line, contour-line, drilling.
std::string_view word_of(CopyMode mode);

}  // namespace camber::machine
