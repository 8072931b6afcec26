#pragma once
// How a path is divided for several processes, and where the pieces cut.
//
// Pieces lie at places that depend on the path alone; a section is a number of consecutive pieces.
#include <cstddef>
#include <vector>

#include "machine/job.h"
#include "removal/stock_part.h"
#include "removal/tool_path.h"

namespace camber::simulate {

/// Stamps from ... from + count - 1 of a run.
struct PathPiece {
  std::size_t run = 0, from = 0, count = 0;
};
inline constexpr std::size_t kPieceStamps = 1000;  ///< at most, in milling; runs of holes are not cut
std::vector<PathPiece> path_pieces(const removal::StampPath& path);

/// Half open.
struct PieceRange {
  std::size_t begin = 0, end = 0;
  bool empty() const { return begin == end; }
};
/// The pieces of a section, 0 ... sections - 1: about as many stamps each. May be empty.
PieceRange section_pieces(const std::vector<PathPiece>& pieces, std::size_t section, std::size_t sections);

/// Consecutive pieces of one run.
struct RunPieces {
  std::size_t run = 0;
  PieceRange pieces;
};
std::vector<RunPieces> runs_of(const std::vector<PathPiece>& pieces, const PieceRange& range);

/// Where a piece cuts, reads and marks: a cutter about each tip, and all above it. Everywhere where an axis is tilted.
removal::Region reach_of(const machine::Job& job, const removal::StampPath& path, const PathPiece& piece);
/// Of all pieces in a range. Empty where there is none.
removal::Region reach_of(const machine::Job& job, const removal::StampPath& path, const std::vector<PathPiece>& pieces,
                         const PieceRange& range);

/// What a section does not cut is joined this far around it, so that no reading of a neighbour misses it. Empty where
/// `reach` is.
removal::Region joined_region(const machine::Job& job, const removal::Region& reach);

}  // namespace camber::simulate
