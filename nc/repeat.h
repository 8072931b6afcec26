#pragma once
// Second cuts: finds runs of cutting moves that a program can repeat, and writes the program that repeats some.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::nc {

/// Why a run cannot stand in the program twice.
enum class RunGap : std::uint8_t {
  none,
  not_in_text,    ///< moves of a loop, an expression, a subprogram or a drilling cycle, or blocks that may be skipped
  cutter_radius,  ///< under G41 or G42
  incremental,    ///< G91
  other_codes,    ///< M, S or T words between its moves
  no_rapid_before,
  no_rapid_behind,
  no_height,  ///< no rapid beside the run passes above all of its moves
  others,     ///< it holds moves that are not to be cut again
  modal       ///< cut again, it is another motion: a modal code within it lasts beyond it
};

/// Text for messages: "are ...".
std::string to_string(RunGap why);

/// Cutting moves (and dwells) between two rapids.
struct CutRun {
  std::uint32_t first_move = 0, last_move = 0;    ///< indices into Interpretation::moves, both included
  std::uint32_t first_block = 0, last_block = 0;  ///< indices into Program::blocks, both included
  /// Ends of the rapids that lead from the end of the run to its start: up to the greatest height of the rapids beside
  /// the run, across to the place from which the program itself goes down, and down by its own rapids.
  std::vector<Vec3> way_back{};
  double way_back_mm = 0;  ///< length of the way back
  bool closed = false;     ///< ends where it begins: is cut again without a way back
  RunGap why_not = RunGap::none;
};

/// The runs that hold at least one of the `wanted` moves (one entry per move), in the program's order. Only those whose
/// cutting moves are all wanted can be repeated.
std::vector<CutRun> cut_runs(const Program& program, const Interpretation& moves, const std::vector<bool>& wanted);

/// A program in which some runs are cut more than once.
struct RepeatedText {
  std::string text;
  /// Block of the given program for each line; for a line of an earlier cut the block that it repeats;
  /// Emission::kNoBlock: the way between.
  std::vector<std::uint32_t> block_of_line;
  std::vector<bool> added;  ///< one per line: not of the given program
};

/// A cut before a run: lines that begin and end where the run does, but for an allowance.
struct EarlierCut {
  CutRun run;
  std::vector<std::string> lines{};             ///< lines without line ends and block numbers (N words)
  std::vector<std::uint32_t> block_of_lines{};  ///< one per line
};

/// Puts the lines of each cut, and the rapids back to the start (of a closed run: a feed move onto it), before the
/// first block of its run; the given lines stay byte for byte. `cuts`: in the order of the program's blocks; several of
/// one run follow each other.
RepeatedText repeat_runs(const Program& program, const Interpretation& moves, std::span<const EarlierCut> cuts);

}  // namespace camber::nc
