#pragma once
// How a path is divided for several processes, and where the pieces cut.
//
// Pieces lie at places that depend on the path alone; a section is a number of consecutive pieces.
#include <cstddef>
#include <vector>

#include "machine/job_file.h"
#include "motion/path_stretch.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::distribute {

/// Half open.
struct PieceRange {
  std::size_t begin = 0, end = 0;
  bool empty() const { return begin == end; }
};
/// The pieces of a section, 0 ... sections - 1: about as many stamps each. May be empty.
PieceRange section_pieces(const std::vector<motion::StretchPiece>& pieces, std::size_t section, std::size_t sections);

/// Consecutive pieces of one run.
struct RunPieces {
  std::size_t run = 0;
  PieceRange pieces;
};
std::vector<RunPieces> runs_of(const std::vector<motion::StretchPiece>& pieces, const PieceRange& range);

/// Where a cutter of an upright run cuts, reads and marks whose tips lie in a box.
removal::Region reach_of_tips(const machine::Job& job, const removal::ToolRun& run, const removal::Region& tips);
/// Where a piece cuts, reads and marks: a cutter about each tip, and all above it. Everywhere where an axis is tilted.
removal::Region reach_of(const machine::Job& job, const motion::PathStretch& path, const motion::StretchPiece& piece);
/// The box around all pieces in a range. Empty where there is none.
removal::Region reach_of(const machine::Job& job, const motion::PathStretch& path,
                         const std::vector<motion::StretchPiece>& pieces, const PieceRange& range);

/// Stock that a section does not cut itself is joined this far around it, so that no reading of a neighbour misses it.
/// Empty where `reach` is.
removal::Region joined_region(const machine::Job& job, const removal::Region& reach);

}  // namespace camber::distribute
