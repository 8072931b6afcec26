#pragma once
// Move map: which move of the given program a move of the emitted one stands for.
#include <cstdint>
#include <span>
#include <vector>

#include "nc/move.h"

namespace camber::nc {

class MoveMap {
 public:
  /// A place on a move: the fraction of its length.
  struct MovePlace {
    std::uint32_t move = 0;
    double fraction = 0;
  };

  /// The given program to itself.
  MoveMap() = default;
  /// `block_of_line`: of the emission. Both programs run through the same blocks in the same order; a block that was
  /// split makes several moves out of one.
  MoveMap(const Interpretation& given, const Interpretation& emitted, std::span<const std::uint32_t> block_of_line);

  MovePlace given(std::uint32_t emitted_move, double fraction) const;

 private:
  struct Part {
    std::uint32_t move = 0;
    double from = 0, to = 1;  ///< fractions of the given move
  };
  std::vector<Part> parts_;  ///< one per emitted move; empty: the same program
};

}  // namespace camber::nc
