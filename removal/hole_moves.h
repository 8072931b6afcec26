#pragma once
// Moves that make holes: the feed moves of drilling, tapping and boring cycles, and a drill's straight G1.
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "machine/job.h"
#include "nc/move.h"

namespace camber::removal {

enum class HoleMove : std::uint8_t {
  none,        ///< of no hole, or of none of the job's operations
  drilled,     ///< straight down: carved, with chips and forces
  tapped,      ///< G74, G84: carved; a tap's chip is none of ours
  way_out,     ///< fed straight up out of the hole just made: nothing is left to cut
  not_carved,  ///< G87 (bored upwards, from below) and cycles along another axis than the tool's
};
constexpr bool makes_hole(HoleMove m) { return m == HoleMove::drilled || m == HoleMove::tapped; }

/// One a move of the program. A cycle's feed moves count for every cutter; of moves outside cycles, straight ones
/// up and down count where the job says that the tool is a drill (cycles written out by a CAM program).
std::vector<HoleMove> hole_moves(const nc::Interpretation& program, const machine::Operations& operations,
                                 const std::map<int, machine::Tool>& tools);

/// How many holes such moves make: pecks of one place and block are one hole.
struct HoleCount {
  std::size_t drilled = 0, tapped = 0;
};
HoleCount count_holes(const nc::Interpretation& program, const std::vector<HoleMove>& holes);

}  // namespace camber::removal
