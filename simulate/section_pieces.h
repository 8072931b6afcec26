#pragma once
// How a path is divided for several processes, and where the pieces cut.
//
// Pieces lie at places that depend on the path alone; a section is a number of consecutive pieces.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/sparse_list.h"
#include "machine/job_file.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::simulate {

/// Stamps from ... from + count - 1 of a run.
struct PathPiece {
  std::size_t run = 0, from = 0, count = 0;
};
/// Stamps of a path from one on: all, or those of some pieces.
struct PathStretch {
  std::span<const removal::ToolRun> runs;  ///< of the whole path
  std::span<const removal::Stamp> stamps;
  std::size_t first = 0;  ///< number of the first of them in the path
  /// What may be read of `stamps`, ascending; not given: all.
  std::optional<std::span<const ListRange>> kept{};

  PathStretch(const removal::StampPath& path, std::size_t first_stamp = 0)
      : runs(path.runs), stamps(path.stamps), first(first_stamp) {}
  PathStretch(std::span<const removal::ToolRun> runs_, std::span<const removal::Stamp> stamps_,
              std::span<const ListRange> kept_)
      : runs(runs_), stamps(stamps_), kept(kept_) {}
  const removal::ToolRun& run_of(const PathPiece& piece) const { return runs[piece.run]; }
  /// Number of a piece's first stamp in the path.
  std::size_t begin_of(const PathPiece& piece) const { return run_of(piece).from + piece.from; }
  std::span<const removal::Stamp> stamps_of(const PathPiece& piece) const {
    return stamps.subspan(begin_of(piece) - first, piece.count);
  }
  std::span<const removal::Stamp> stamps_of(const removal::ToolRun& run) const {
    return stamps.subspan(run.from - first, run.count);
  }
  /// What may be read of these stamps of the path, counted from its first.
  std::vector<ListRange> kept_in(std::size_t from, std::size_t count) const;
};

inline constexpr std::size_t kPieceStamps = 1000;  ///< at most, in milling; runs of holes are not cut
/// From the runs alone.
std::vector<PathPiece> path_pieces(const PathStretch& path);

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

/// Where a cutter of an upright run cuts, reads and marks whose tips lie in a box.
removal::Region reach_of_tips(const machine::Job& job, const removal::ToolRun& run, const removal::Region& tips);
/// Where a piece cuts, reads and marks: a cutter about each tip, and all above it. Everywhere where an axis is tilted.
removal::Region reach_of(const machine::Job& job, const PathStretch& path, const PathPiece& piece);
/// Of all pieces in a range. Empty where there is none.
removal::Region reach_of(const machine::Job& job, const PathStretch& path, const std::vector<PathPiece>& pieces,
                         const PieceRange& range);

/// What a section does not cut is joined this far around it, so that no reading of a neighbour misses it. Empty where
/// `reach` is.
removal::Region joined_region(const machine::Job& job, const removal::Region& reach);

}  // namespace camber::simulate
