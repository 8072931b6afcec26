#pragma once
// A program with its runs of short lines as few lines and arcs.
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nc/emit.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "repath/compress/fit.h"

namespace camber::repath {

/// A control that runs arcs faster than lines, whatever is programmed.
struct FeedsByKind {
  double line_mm_per_s = 0, arc_mm_per_s = 0;  ///< greater than zero, the second greater than the first
  double block_s = 0.005;                      ///< additional time per block; zero or more
};

/// Seconds of all cuts at these feeds: lines_mm / line + arcs_mm / arc + cuts * block_s. Rapids are not counted.
double cutting_time_s(const nc::Interpretation& moves, const FeedsByKind& feeds);

struct CompressOptions {
  double tolerance_mm = 0.01;
  std::optional<FeedsByKind> feeds{};  ///< minimize the time at these feeds; otherwise the number of blocks
  bool helices = false;                ///< arcs whose third axis moves evenly with the angle, where the path does
  bool switch_planes = false;  ///< runs in another plane get its G17 G18 G19 and the old one behind; else lines only
  FitOptions fit{};            ///< tolerance and increment are set from the program
  std::function<void(double)> progress{};  ///< fraction of the moves
};

/// A stretch of blocks that are plain straight cuts at one feed, in one plane or in space.
struct BlockRun {
  std::uint32_t first_move = 0, last_move = 0;  ///< indexes into Interpretation::moves, both included
  int normal = 2;                               ///< the axis that stands still: 0 X, 1 Y, 2 Z
  bool current_plane = true;                    ///< the plane is the one that the program has chosen
  bool in_space = false;                        ///< it need not keep to a plane; `normal` is that of the chosen one
};

/// What a run may hold: lines in one plane; lines anywhere; lines and arcs anywhere.
enum class RunKind { in_plane, in_space, with_arcs };

/// A block is part of a run when it makes one straight move at a feed per minute and holds nothing but N, G1, X, Y, Z
/// and words that repeat what is in force (F, S, M3, M8, G90 ...; in the first block of a run they may also change it),
/// moves in the plane, and stands directly behind the one before it. Comments, other words, another feed, drilling
/// cycles, G41 and G42, exact stop, block skip and the blocks behind it whose place depends on the switch, turned or
/// scaled frames and moves that the text does not say one by one end a run. In a program with macros or subprograms
/// blocks with a number are left alone: they may be jumped to. With arcs G2, G3, I, J, K and R may stand in a block
/// too.
std::vector<BlockRun> find_runs(const nc::Program& program, const nc::Interpretation& moves, RunKind kind);

/// What kept a program as it was, in one sentence without a stop: how many runs there are, and what ends them.
std::string why_unchanged(const nc::Program& program, const nc::Interpretation& moves, RunKind kind);

/// Runs in space; with `apart` those in a plane other than the chosen one, if long enough for an arc, on their own.
std::vector<BlockRun> runs_to_compress(const nc::Program& program, const nc::Interpretation& moves, bool apart);

/// Points of runs as the text says them, in the plane: start and ends of their moves. Repeated points are left out;
/// `block` tells which block ends at each (of the first point: the first block).
struct RunPath {
  std::vector<Vec2> points;
  std::vector<double> heights;  ///< of runs in space, along `normal`
  std::vector<std::uint32_t> block;
};
/// Runs that follow each other without a stop, in one plane, as where the feed or the spindle speed changes: one path,
/// over whose joints nothing runs.
struct RunChain {
  struct Part {
    BlockRun run;
    std::uint32_t first_point = 0, last_point = 0;
  };
  RunPath path;
  std::vector<std::uint32_t> ends;  ///< points at which one part follows another; see Polyline
  std::vector<Part> parts;
  /// The cuts before and behind the chain, where the path goes on without a stop, are part of the path but of no part:
  /// a line as it is, of an arc a piece of its tangent.
  bool arc_before = false, arc_behind = false;
};
/// One after the other; the path of one is in memory at a time.
void for_each_chain(const nc::Interpretation& moves, std::span<const BlockRun> runs,
                    const std::function<void(const RunChain&)>& take);

struct RewrittenRun {
  std::uint32_t first_block = 0, last_block = 0;
  std::size_t lines = 0, arcs = 0;
  double deviation_mm = 0;
  std::uint32_t first_block_after = 0, last_block_after = 0;  ///< of the new text
};

/// Where the runs' blocks are in the new text.
void place_after(std::vector<RewrittenRun>& runs, const std::vector<nc::BlockReplacement>& replacements);

struct Compression {
  std::string text;
  std::vector<RewrittenRun> runs;    ///< those that became fewer blocks
  double max_deviation_mm = 0;       ///< over all of them
  double max_kink_rad = 0;           ///< at joints beside an arc that are smooth in the input
  std::uint32_t max_kink_block = 0;  ///< of the new text: the one that begins there
  double rms_kink_rad = 0;           ///< over these joints
  double max_edge_rad = 0;           ///< of the kinks beside an arc that the program itself has and that are no corners
  std::uint32_t max_edge_block = 0;  ///< of the new text, likewise
};

/// Linear in the number of blocks. Does not throw on a program that was read and interpreted without errors.
Compression compress(const nc::Program& program, const nc::Interpretation& moves, const CompressOptions& options);

}  // namespace camber::repath
