#pragma once
// Loop order: chooses the loop that comes next, so that the tool stays near what it has cut.
#include <optional>
#include <vector>

#include "copymill/pass.h"

namespace camber::copymill {

/// Loops of a region at one distance after the other. A loop may be cut when all loops of the distance before that lie
/// beside it are; of those that may, the nearest to the tool comes next. So the tool stays at a boss or in a corner
/// until it has come to the wall there, and never has more than one distance beside it.
class LoopOrder {
 public:
  /// The loops of the next distance, `apart_mm` from those of the one before. `may_turn`: open ones may be followed
  /// from either end.
  void add(std::vector<Pass> loops, double apart_mm, bool may_turn);
  /// The next one, a closed one beginning as near to the tool as its points allow; nothing when all are taken. A tool
  /// that is nowhere yet gets the first.
  std::optional<Pass> next(const std::optional<Vec3>& tip);

 private:
  struct Loop {
    Pass pass;
    std::vector<std::size_t> after;  ///< loops that have to be cut before
    bool may_turn = false;
    bool taken = false;
  };
  bool may_be_next(const Loop& loop) const;

  std::vector<Loop> loops_;
  std::size_t first_of_last_ = 0;  ///< distance
};

}  // namespace camber::copymill
