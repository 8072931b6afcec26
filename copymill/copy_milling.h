#pragma once
// Virtual copy milling: makes paths from the part itself while the tool cuts, tick by tick. This is the door of
// copymill/.
//
// Overview
//
// A virtual tracer of the tool's shape follows the part's model, and the stock that stands at that moment decides where
// there is something to cut. For each operation of the job:
//
// 1. tip_field        the lowest height of the tip over (x, y): the part's offset surface, with the allowance. Every
//                     path stays at or above it. axis_region and level_region say where the axis may be, outline traces
//                     borders.
// 2. levels, passes   operation lays passes: loops at equal distances from walls (level_region, levels), rows, rows
//                     with a scallop height, or holes; cut_levels goes from level to level. standing has the material
//                     that the planner sees, clear_height an upper bound of all that can stand.
// 3. approach         gets the tool to a pass and into the material: from the side, along the pass, straight down.
//                     slotting replaces full cuts by trochoids (trochoid) where the load asks for it.
// 4. runner           runs passes as lines and arcs (path_piece) in ticks of the control (feed_motion), cuts each tooth
//                     passing in the stock, and writes the program (program_writer).
// 5. load_follower    reads the load of each passing (simulate/load_probe) and sets feed and depths by load_rule, which
//                     also remembers where the material was harder than expected.
// 6. part_check       says how deep the path goes into the part and what is left on it.
//
// Units: mm, s, N, rad; positions are tips in the frame of the part. docs/copy.md has the
// reasons, the rule of the load and the figures.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "copymill/load_follower.h"
#include "copymill/part_check.h"
#include "machine/copy_operations.h"
#include "machine/job_file.h"
#include "nc/write/program_writer.h"
#include "removal/stock.h"
#include "simulate/force_regions.h"

namespace camber::copymill {

/// One period of the control.
struct Tick {
  double t_s = 0;
  Vec3 tip_mm = Vec3::Zero();
  double feed_mm_per_s = 0;  ///< actual feed
  double load_N = 0;         ///< lateral force of the last tooth passing; 0 in air
  double processor_ms = 0;   ///< processor time of the calling thread in this tick
};

struct CopyOptions {
  /// Largest distance of the program's lines and arcs from the path.
  double tolerance_mm = 0.002;
  /// Called with every tick, in order; may be empty.
  std::function<void(const Tick&)> stream{};
  /// False: loads of operations without force_N are not read, and their stock is cut all at once at the end. Use it
  /// where only the path is needed.
  bool loads = true;
  bool coolant = false;  ///< the program switches coolant on while a tool cuts
  /// Called before each operation with its number, from 0, and the present stock; may be empty.
  std::function<void(std::size_t, const removal::Stock&)> before{};
  /// Regions that are harder than the job says: the cut feels them, the model does not expect them.
  simulate::ForceRegions regions{};
  /// Time at which the tool is stopped, wherever it is, and lifted. Not given: it goes on to the end.
  std::optional<double> stop_after_s{};
};

/// Summary of one operation.
struct OperationSummary {
  int tool = 0;
  machine::CopyMode mode = machine::CopyMode::contour_line;
  double time_s = 0, cutting_s = 0;
  double removed_mm3 = 0;
  std::size_t levels = 0, passes = 0;
  std::size_t ramps = 0, plunges = 0, retracts = 0;
  std::size_t trochoid_circles = 0;
  /// True: the operation found no material that it may cut.
  bool nothing_left = false;
  LoadFigures load;
  std::vector<Change> changes;  ///< changes of feed and depths, in order of time
};

struct CopyResult {
  std::string text;                              ///< the NC program
  nc::WrittenProgram program;                    ///< the same in pieces: head, operations, end
  std::unique_ptr<removal::Stock> blank, stock;  ///< stock before the first cut and after the last one
  std::vector<OperationSummary> operations;
  double time_s = 0;
  std::size_t ticks = 0, blocks = 0;
  double tick_mean_ms = 0, tick_max_ms = 0;  ///< computing time
  double removed_mm3 = 0;
  bool stopped = false;            ///< ended by CopyOptions::stop_after_s
  LeftMaterial left;               ///< material left on the part where the operations' tools could touch it
  double path_depth_um = 0;        ///< greatest depth of the milling path in the part, by the exact offset surface
  Vec3 deepest_mm = Vec3::Zero();  ///< position of the tip at that depth
};

/// Makes the paths of the operations, in their order, and cuts the job's stock along them. Requires operations that
/// read_copy_operations() accepted for this job. Throws InputError: [part-missing], [stl-open], [part-outside-stock],
/// [tool-too-large], [stock-missing] ...
CopyResult copy(const machine::Job& job, const std::vector<machine::CopyOperation>& operations,
                const CopyOptions& options, Diagnostics& diagnostics);

}  // namespace camber::copymill
