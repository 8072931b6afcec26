#pragma once
// A stretch of a path, the pieces in which a path is computed, and what is known of a path without its stamps.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/sparse_list.h"
#include "machine/job_file.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::motion {

/// A path without its stamps: what lies where, and what must be known of all of them.
/// Collected from the stamps one by one, in order.
struct PathOutline {
  struct Run {
    removal::Region tips;
    double longest_feed_mm = 0;  ///< of the tip, from one stamp to the next
  };
  static constexpr std::size_t kBlock = 256;  ///< stamps

  std::vector<removal::ToolRun> runs;   ///< with their counts
  std::vector<Run> of_runs;             ///< the same
  std::vector<removal::Region> blocks;  ///< of the tips of kBlock stamps each
  std::size_t stamps = 0;
  bool upright = true;

  void add(const removal::ToolRun& run, const removal::Stamp& stamp);
};

/// Stamps from ... from + count - 1 of a run.
struct StretchPiece {
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
  const removal::ToolRun& run_of(const StretchPiece& piece) const { return runs[piece.run]; }
  /// Number of a piece's first stamp in the path.
  std::size_t begin_of(const StretchPiece& piece) const { return run_of(piece).from + piece.from; }
  std::span<const removal::Stamp> stamps_of(const StretchPiece& piece) const {
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
std::vector<StretchPiece> path_pieces(const PathStretch& path);

/// A path that was gone through, and of which some stamps were kept.
struct SparsePath {
  PathOutline outline;
  SparseList<removal::Stamp> stamps;

  PathStretch stretch() const { return {outline.runs, stamps.all(), stamps.kept()}; }
};

}  // namespace camber::motion
